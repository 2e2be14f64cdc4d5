"""What the commands on calibrated standards share: rooms strung together, nothing computed."""
