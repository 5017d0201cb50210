"""The start bench: from the shell's return key to the first pixel of `pullfocus record`."""
