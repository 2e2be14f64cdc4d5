"""Where the errors of a machine show, and how surely: Monte Carlo over error distributions."""

PARTS = ("population", "first_order", "montecarlo", "shares", "study")
"""From bottom to top: each imports only from those before it."""
