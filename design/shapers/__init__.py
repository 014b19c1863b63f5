"""Shapers: one file a family, each entry listed in `design.shapers.registry`."""
