"""Tables as bytes, one file a format; nothing here opens a file."""
