"""The gallery: every stock, shutter, lens and aberration on the demo shot, side by side, as a page."""
