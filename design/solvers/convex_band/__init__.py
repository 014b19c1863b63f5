"""The fastest shaper over a band, where that is a convex problem, with proof of how fast."""
