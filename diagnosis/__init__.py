"""Measurements against the model: fit, compare, diagnose what is missing."""

PARTS = ("fit", "evidence", "residual", "search", "answer", "files")
"""From bottom to top: each imports only from those before it."""
