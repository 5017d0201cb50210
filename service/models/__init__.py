"""Models that travel as JSON: camelCase names, lengths with their unit, ``null`` for infinite or missing values.

Every process of the service imports them: the HTTP process to validate requests and describe answers, the workers to reply.
They load neither USD nor GL.
"""
