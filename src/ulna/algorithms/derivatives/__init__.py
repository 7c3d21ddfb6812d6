"""Analytical derivatives of dynamics and of the velocities of frames."""
