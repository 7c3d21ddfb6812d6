"""Inverse kinematics: from poses of a frame to configurations."""

from ulna.ik.damped import damped_step as damped_step
