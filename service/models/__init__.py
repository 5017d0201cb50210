"""What travels as JSON: camelCase names, lengths with their unit, ``null`` for what is infinite or does not exist."""
