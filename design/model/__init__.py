"""What moves, what drives it, and what they are told."""
