"""Bench of chaos: a render while parts of the system are killed, its disk fills and its clock jumps."""
