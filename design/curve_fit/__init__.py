"""Impulse times as polynomials over a field of the plant."""
