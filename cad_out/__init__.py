"""CAD of a standard: a solid, STEP and STL files, and their measured conformity."""

PARTS = ("build", "verify")
"""From bottom to top: each imports only from those before it."""
