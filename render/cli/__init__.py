"""The commands of `pullfocus`, one module each: `add_arguments` declares the arguments, `run` does the work."""
