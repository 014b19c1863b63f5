"""From what is known of plant and limits to the fastest shaper that serves."""
