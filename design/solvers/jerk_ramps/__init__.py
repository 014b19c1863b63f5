"""The fastest courses of a reference whose slope and jerk are limited."""
