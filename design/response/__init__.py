"""What a command does, by two routes that share no code."""
