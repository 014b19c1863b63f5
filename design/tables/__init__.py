"""Tables of designs: many rows, each verified."""
