"""`pullfocus bench service`: a real service under load, as its clients see it."""
