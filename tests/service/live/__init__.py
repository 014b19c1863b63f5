"""Live sessions as pure functions."""
