"""The material standard: freeform patches, datum spheres, datum plane and the body they sit on."""

PARTS = ("brief", "body", "layout", "reach", "worth", "compare", "place")
"""From bottom to top: each imports only from those before it."""
