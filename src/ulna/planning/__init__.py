"""Motion planning: paths among obstacles, proved to touch nothing between their points either."""

from ulna.planning.certificate import Certificate as Certificate
from ulna.planning.certificate import certify as certify
from ulna.planning.goals import Region as Region
from ulna.planning.path_constraints import PathConstraint as PathConstraint
from ulna.planning.planner import Planner as Planner
from ulna.planning.planner import plan as plan
from ulna.planning.result import Plan as Plan
from ulna.planning.scenes import scene as scene
from ulna.planning.search_tree import SearchTree as SearchTree

__all__ = [
    "Certificate",
    "PathConstraint",
    "Plan",
    "Planner",
    "Region",
    "SearchTree",
    "certify",
    "plan",
    "scene",
]
