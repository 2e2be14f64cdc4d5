"""Commands by which a model goes back to the control, and what they share."""
