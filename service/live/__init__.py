"""Live sessions, as pure functions from bytes to bytes: what workers do of them."""
