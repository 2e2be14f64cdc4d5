"""Commands on the standard: designed, calibrated, and what it is worth."""
