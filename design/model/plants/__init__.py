"""What moves: a kind of plant a file, all of them in `registry`."""
