"""The Toolbox's console: an interactive Python with the names that robot programs use."""

from __future__ import annotations

import code
import sys

_NAMES = """
import math
from math import pi
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import *
from roboticstoolbox import models
from spatialmath import SE2, SE3, SO2, SO3, Twist2, Twist3, UnitQuaternion
from spatialmath.base import *
"""


def main(arguments: list[str] | None = None) -> None:
    """Starts the console: `rtbtool [FILE]` runs a file first.

    Args:
        arguments: Those after the command; by default those of the process.

    Raises:
        SystemExit: An option is asked for, which the console does not have.
    """
    words = sys.argv[1:] if arguments is None else arguments
    options = [word for word in words if word.startswith("-")]
    if options:
        raise SystemExit(
            f"rtbtool under Ulna takes a file to run first, and no options; given: {' '.join(options)}"
        )
    space: dict[str, object] = {"__name__": "__console__"}
    exec(_NAMES, space)
    for file in words:
        with open(file, encoding="utf-8") as stream:
            exec(compile(stream.read(), file, "exec"), space)
    code.interact("Robotics Toolbox on Ulna: rtb, models, np, SE3 ... are imported.", local=space)
