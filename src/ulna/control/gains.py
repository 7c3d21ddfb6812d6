"""Control laws as kernels that refuse negative gains, which would drive a robot away from its goal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ulna import compiler, kernels
from ulna.robot import Robot, compile


def law_with_gains(law: Callable[..., Any], robot: Robot, gains: Sequence[str], **shapes: Any) -> Any:
    """The kernel of a law.

    Args:
        law: The law, as for `ulna.compile`.
        robot: The robot.
        gains: Names of the arguments that must not be negative.
        **shapes: Shapes of arguments, as for `ulna.compile`.

    Returns:
        The kernel; nan, inf and negative gains raise.
    """
    function = compile(law, robot, **shapes).function
    numbers = [k for k, port in enumerate(function.inputs) if port.name in gains]
    labels = kernels.labels(robot.model, function)
    return compiler.compile(function, checked=True, labels=labels, not_negative=numbers)
