"""The border: users' files in, users' files out, in the units that stand in their names."""
