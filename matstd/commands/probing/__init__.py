"""Commands on programs and the logs that they leave."""
