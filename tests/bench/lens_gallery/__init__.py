"""The lens gallery: every lens and aberration on the demo shot, side by side, as a page."""
