"""What `matstd compensate` and its kin read from the command line, and do."""
