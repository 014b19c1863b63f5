"""The fastest courses of a reference whose slope is limited."""
