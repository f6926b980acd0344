"""One query on a known map: trials and their times, shortest paths, what is wrong with a path."""
