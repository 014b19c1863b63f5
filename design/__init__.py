"""Shaper design: plants, actuators, shapers and their proof. No file, socket, clock or web."""
