"""Lookup tables: many designs over axes or a list."""
