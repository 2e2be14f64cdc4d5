"""The only home of drawings, pages and prose."""

PARTS = ("style", "words", "maps", "plots", "scenes", "pages")
"""From bottom to top: each imports only from those before it."""
