"""One command a file, with `add_arguments(parser)` and `run(args) -> int`, by what it is about."""
