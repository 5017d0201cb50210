"""`pullfocus bench page`: the page in a real browser, on a real service with the demo shot."""
