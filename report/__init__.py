"""The only home of drawings, pages and prose."""

PARTS = ("words", "maps", "plots", "scenes", "pages")
"""From bottom to top: each imports only from those before it."""
