"""Kinematics of robots, contacts and distances."""
