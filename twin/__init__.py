"""The digital twin: machines, poses, touches and the physics that disturbs them."""
