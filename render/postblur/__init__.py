"""Single-image engines: depth of field added to a finished picture."""
