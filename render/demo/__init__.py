"""The demo shot, authored in code. Imports nothing here: `render.demo.shapes` also serves scenes that need no USD."""
