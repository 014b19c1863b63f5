"""A shaper's residual, how robust it is, and whether it holds what it claims. No solver here."""
