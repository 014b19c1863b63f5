"""What drives the plant: a kind of actuator a file, all of them in `registry`."""
