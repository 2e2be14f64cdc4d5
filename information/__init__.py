"""What measurements can know of a machine, and which measurements to choose."""

PARTS = ("identifiability", "criteria", "selection")
"""From bottom to top: each imports only from those before it."""
