"""Motion planning: paths among obstacles, proved to touch nothing between their points either."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ulna.system.deferred_names import deferred_names

if TYPE_CHECKING:
    from ulna.planning.certificate import Certificate as Certificate
    from ulna.planning.certificate import certify as certify
    from ulna.planning.goals import Region as Region
    from ulna.planning.path_constraints import PathConstraint as PathConstraint
    from ulna.planning.planner import Planner as Planner
    from ulna.planning.planner import plan as plan
    from ulna.planning.result import Plan as Plan
    from ulna.planning.scenes import scene as scene
    from ulna.planning.search_tree import SearchTree as SearchTree

_FILES = {
    "Certificate": "certificate",
    "PathConstraint": "path_constraints",
    "Plan": "result",
    "Planner": "planner",
    "Region": "goals",
    "SearchTree": "search_tree",
    "certify": "certificate",
    "plan": "planner",
    "scene": "scenes",
}
"""The file of each public name; a first plan takes less time without those that it does not need."""

__all__ = list(_FILES)

__getattr__ = deferred_names(__name__, _FILES)


def __dir__() -> list[str]:
    return sorted({*__all__, *globals()})
