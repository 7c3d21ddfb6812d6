"""Helpers beside robots: trajectories, servoing, numerical derivatives."""
