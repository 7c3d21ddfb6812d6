"""Dynamics of robots, in joint space and in task space, their parameters and their simulation."""
