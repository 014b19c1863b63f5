"""The use cases, one a file: request in, response out. Routes and commands hold no logic."""
