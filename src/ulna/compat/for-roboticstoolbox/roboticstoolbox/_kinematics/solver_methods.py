"""Inverse kinematics of a robot, by the names and signatures of the toolbox.

Each method is that of the chain from `start` to `end`, with the tool; see `roboticstoolbox._ets.solver_methods`.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from roboticstoolbox._common.documentation import ARGUMENTS
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ets.solver_methods import ChainSolvers, SolversOfChain
from ulna.compat.documentation import with_arguments

_OF_CHAIN = "The joint coordinates for a pose of the end"
_OF_ROBOT = "The configuration for a pose of the end in the base"


def _of_robot(method: Callable[..., IKSolution]) -> Callable[..., IKSolution]:
    """The method of robots for one of chains: it also takes `end` and `start`, after the pose, and `tool`, last."""
    signature = inspect.signature(method)
    itself, pose, *settings = signature.parameters.values()
    others = [one for one in settings if one.kind is one.VAR_KEYWORD]
    positional = settings[: len(settings) - len(others)]
    end, start, tool = (pose.replace(name=name, default=None) for name in ("end", "start", "tool"))
    parameters = [itself, pose, end, start, *positional, tool, *others]

    def solve(
        self: Any, Tep: Any, end: Any = None, start: Any = None, *values: Any, tool: Any = None, **named: Any
    ) -> IKSolution:
        if len(values) > len(positional):  # the last one is `tool`
            values, tool = values[:-1], values[-1]
        return method(SolversOfChain(self._chain(end, start, tool)), Tep, *values, **named)

    solve.__name__, solve.__qualname__ = method.__name__, f"RobotSolvers.{method.__name__}"
    solve.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    names = [one.name for one in (*parameters[1:-1], tool) if one.kind is not one.VAR_KEYWORD]
    doc = inspect.cleandoc(method.__doc__ or "").replace(_OF_CHAIN, _OF_ROBOT)
    solve.__doc__ = with_arguments(doc, names, ARGUMENTS)
    return solve


class RobotSolvers:
    """Inverse kinematics of a robot."""

    _chain: Any

    ik_LM = _of_robot(ChainSolvers.ik_LM)
    ik_NR = _of_robot(ChainSolvers.ik_NR)
    ik_GN = _of_robot(ChainSolvers.ik_GN)
    ikine_LM = _of_robot(ChainSolvers.ikine_LM)
    ikine_NR = _of_robot(ChainSolvers.ikine_NR)
    ikine_GN = _of_robot(ChainSolvers.ikine_GN)
    ikine_QP = _of_robot(ChainSolvers.ikine_QP)
