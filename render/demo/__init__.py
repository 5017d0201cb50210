"""The demo shot, authored in code."""

from render.demo.shot import write_demo

__all__ = ["write_demo"]
