"""Robots as graphs of bodies and joints: `ModelGraph`, and models of it with any body as root."""

from __future__ import annotations

from pinocchio._containers.arguments import check_methods
from pinocchio._containers.arrays import StdVec
from pinocchio._containers.documentation import describe_all
from pinocchio._graph.builders import *
from pinocchio._graph.building import *
from pinocchio._graph.changing import *
from pinocchio._graph.edges import *
from pinocchio._graph.joints import *
from pinocchio._graph.model_graph import *
from pinocchio._graph.shapes import *

StdVec_Geometry = StdVec_JointVariant = StdVec_VectorXs = StdVec

check_methods(list(globals().values()))
describe_all([*globals().values()])
del annotations, check_methods, describe_all, StdVec
