"""What moves, what drives it, and their commands."""
