"""Robots as graphs of bodies and joints, of which models are built with any body as root."""
