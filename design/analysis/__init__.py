"""What a shaper leaves, how robust it is, and whether it holds what it claims. No solver here."""
