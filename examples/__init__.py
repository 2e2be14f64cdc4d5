"""Examples: projects, machines, runs with a hidden effect, and scripts; `matstd examples`."""
