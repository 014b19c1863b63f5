"""One vendor, one file: each takes a problem and returns an outcome. No solver knows a shaper."""
