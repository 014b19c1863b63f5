"""Speed, as ratios to a peer measured in the same run where there is one: `make bench`."""
