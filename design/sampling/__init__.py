"""Shapers and commands on the samples of a controller."""
