"""Commands on measurements: read, compared with the model, diagnosed."""
