"""The commands of `pullfocus`, one module each: `add_parser` declares the arguments, `run` does the work."""
