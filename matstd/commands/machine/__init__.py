"""Commands on machines, errors and files to start from."""
