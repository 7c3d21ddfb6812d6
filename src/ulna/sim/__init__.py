"""Simulation: what a robot does in time."""

from ulna.sim.body import Body as Body
from ulna.sim.dynamic import dynamic_step as dynamic_step
from ulna.sim.dynamic import simulate as simulate
from ulna.sim.kinematic import kinematic_step as kinematic_step
from ulna.sim.plant import Plant as Plant
from ulna.sim.recording import Recording as Recording
from ulna.sim.simulation import Simulation as Simulation
