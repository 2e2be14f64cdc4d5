"""Stages of `matstd design` and `sensitivity`: rooms strung together, nothing computed."""
