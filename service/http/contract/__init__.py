"""The contract of the API: what version 1 has promised to its clients, and changes of the OpenAPI document that break it."""
