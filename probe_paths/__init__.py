"""From a standard to iTNC 530 probing programs, and from a program's text back to measurements."""

PARTS = ("plan", "language", "control", "emit", "campaign")
"""From bottom to top: each imports only from those before it."""
