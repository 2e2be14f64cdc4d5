"""The library of effects, one kind a file."""
