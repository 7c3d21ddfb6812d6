"""The console of the Toolbox: an interactive Python with the names that robot programs use."""

from __future__ import annotations

import argparse
import code
import sys
from collections.abc import Sequence

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


def main(arguments: Sequence[str] | None = None) -> None:
    """Starts the console: `rtbtool [OPTIONS] [SCRIPT]` runs a script first.

    Args:
        arguments: Those after the command; by default those of the process.

    Raises:
        SystemExit: Help is asked for, or an option that the console does not have.
    """
    options = _options().parse_args(arguments)
    space: dict[str, object] = {"__name__": "__console__"}
    exec(_NAMES, space)
    if options.backend is not None:
        import matplotlib

        matplotlib.use(options.backend)
    if options.swift:
        from roboticstoolbox import BaseRobot

        BaseRobot.set_default_backend("swift")
    if options.script is not None:
        with open(options.script, encoding="utf-8") as stream:
            exec(compile(stream.read(), options.script, "exec"), space)
    sys.ps1 = options.prompt
    banner = "" if options.no_banner else "Robotics Toolbox on Ulna: rtb, models, np, SE3 ... are imported."
    code.interact(banner, local=space, exitmsg="")


def _options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("rtbtool", description="Robotics Toolbox shell, on Ulna")
    parser.add_argument("script", nargs="?", help="script to run first")
    parser.add_argument("-B", "--backend", help="backend of matplotlib")
    parser.add_argument("-P", "--prompt", default="(rtb) >>> ", help="input prompt (default: %(default)r)")
    parser.add_argument("--no-banner", action="store_true", help="no line about what is imported")
    parser.add_argument("-s", "--swift", action="store_true", help="robots are plotted in Swift's viewer")
    return parser


if __name__ == "__main__":
    main()
