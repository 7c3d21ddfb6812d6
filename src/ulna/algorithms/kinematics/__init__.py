"""Kinematics: poses, Jacobians and their derivatives, manipulability, the space of configurations."""
