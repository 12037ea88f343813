"""One limit state of the literature a file, whose name is its name."""
