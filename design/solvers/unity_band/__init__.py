"""Minimum time by steps up and down in turn, within a tolerance over a band of frequencies."""
