"""Table jobs: their store, what runs them, and their files."""
