"""Everything with a socket, a clock or a file: HTTP, command line, workers."""
