"""Values into figures: every function returns a matplotlib Figure, or its bytes."""
