"""Whole moves, and the commands that shapers make of others."""
