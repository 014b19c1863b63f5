"""Residuals, times and gains over fields of plant and actuator."""
