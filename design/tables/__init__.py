"""Tables of designs: what they hold, and how to read between their rows."""
