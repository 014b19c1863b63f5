"""Worker processes: who waits for one, what each costs, and how the pool of them heals."""
