"""MaterialX: documents and networks of its nodes, as GLSL that peeling runs for each fragment."""
