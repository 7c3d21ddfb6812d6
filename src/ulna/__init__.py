"""Ulna compiles your robot: kinematics of articulated robots, traced from the textbook into machine code."""

__version__ = "0.1.0"
