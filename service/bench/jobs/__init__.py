"""Bench of renders: many of them in the queue, many workers, and the events that tell of them."""
