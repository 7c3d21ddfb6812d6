"""Simulation: what a robot does in time."""

from ulna.sim.kinematic import Recording as Recording
from ulna.sim.kinematic import kinematic_step as kinematic_step
