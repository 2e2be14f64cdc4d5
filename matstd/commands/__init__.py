"""One command a file, with `OPTIONS` and `run(args) -> int`, by what it is about."""
