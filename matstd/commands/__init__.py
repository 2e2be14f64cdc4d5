"""One command a file, each with `add_arguments(parser)` and `run(args) -> int`."""
