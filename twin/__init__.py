"""The digital twin: machines, poses, touches and the physics that disturbs them."""

PARTS = ("machine", "record", "model", "effects", "library", "files", "foreign")
"""From bottom to top: each imports only from those before it."""
