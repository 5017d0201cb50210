"""What single-image engines do to a finished picture."""
