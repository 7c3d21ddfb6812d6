"""Whole jobs on a Dask cluster, seeded by part, kept on the disk: reachability maps, data sets, your own jobs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ulna.system.deferred_names import deferred_names

if TYPE_CHECKING:
    from ulna.scale.data_sets import data_set as data_set
    from ulna.scale.engine import run as run
    from ulna.scale.identifying import identify as identify
    from ulna.scale.job import Job as Job
    from ulna.scale.job import Samples as Samples
    from ulna.scale.many_plans import plans as plans
    from ulna.scale.plan_set import PlanSet as PlanSet
    from ulna.scale.progress import Progress as Progress
    from ulna.scale.reach_map import ReachMap as ReachMap
    from ulna.scale.reachability import reach as reach
    from ulna.scale.sweep_result import Sweep as Sweep
    from ulna.scale.sweeps import sweep as sweep

_FILES = {
    "Job": "job",
    "PlanSet": "plan_set",
    "Progress": "progress",
    "ReachMap": "reach_map",
    "Samples": "job",
    "Sweep": "sweep_result",
    "data_set": "data_sets",
    "identify": "identifying",
    "plans": "many_plans",
    "reach": "reachability",
    "run": "engine",
    "sweep": "sweeps",
}
"""The files of names that are imported when first used: the command line parses without them."""

__all__ = list(_FILES)

__getattr__ = deferred_names(__name__, _FILES)


def __dir__() -> list[str]:
    return __all__
