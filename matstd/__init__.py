"""The command line: it wires the rooms together and computes nothing."""
