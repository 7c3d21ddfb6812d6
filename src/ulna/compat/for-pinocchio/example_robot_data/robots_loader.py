"""Robots of the installed example-robot-data by name."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from pinocchio.robot_wrapper import RobotWrapper

from ulna.errors import InputError, MissingExtra
from ulna.robots.example_robot_data import DESCRIPTIONS, files, share_folder

ROBOTS: tuple[str, ...] = tuple(DESCRIPTIONS)
"""The names that `load` knows."""


def load(name: str, display: bool = False, rootNodeName: str = "", verbose: bool = False) -> RobotWrapper:
    """A robot of example-robot-data; those that move about have a free flyer at their root.

    `robot.q0` is the posture it usually starts from, `model.referenceConfigurations` has all that are named.

    Args:
        name: Its name, such as "ur5", "panda", "talos", "solo12".
        display: Whether to open the viewer and show it.
        rootNodeName: The node of the viewer it is shown at.
        verbose: Not needed.

    Returns:
        The robot with its model, geometries and start posture `q0`.

    Raises:
        UnknownName: There is no robot of that name; offers the nearest one.
        MissingExtra: The package example-robot-data is not installed.
    """
    urdf, srdf = files(name)
    description = DESCRIPTIONS[name]
    robot = RobotWrapper.BuildFromURDF(
        str(urdf), None, pin.JointModelFreeFlyer() if description.floating else None
    )
    if srdf is not None:
        pin.loadReferenceConfigurations(robot.model, str(srdf), False)
        postures = robot.model.referenceConfigurations
        if description.posture and description.posture in postures:
            robot.q0 = np.array(postures[description.posture])
    if display:
        robot.initViewer(loadModel=False)
        robot.loadViewerModel(rootNodeName or "pinocchio")
        robot.display(robot.q0)
    return robot


def loadUR(robot: int = 5, limited: bool = False, gripper: bool = False) -> RobotWrapper:
    """An arm of Universal Robots; see `load`.

    Args:
        robot: Its size: 3, 5 or 10.
        limited: Whether joints turn by half a turn at most, where there is such a variant.
        gripper: Whether it carries a gripper, where there is such a variant.

    Returns:
        The robot.

    Raises:
        InputError: Both `limited` and `gripper`.
    """
    if limited and gripper:
        raise InputError("There is no UR that is both limited and with a gripper; choose one.")
    return load(f"ur{robot}" + ("_limited" if limited else "_gripper" if gripper else ""))


def getModelPath(subpath: str, verbose: bool = False) -> str:
    """The folder that holds a path below the folder of all robots.

    Args:
        subpath: The path.
        verbose: Accepted and ignored.

    Returns:
        The folder.

    Raises:
        MissingExtra: The package example-robot-data is not installed.
        InputError: There is no such file or folder in it.
    """
    share = share_folder()
    if share is None:
        raise MissingExtra("example-robot-data", "robots", f"The path {subpath!r}")
    folder = next((f for f in (share / "robots", share.parent) if (f / subpath.lstrip("/")).exists()), None)
    if folder is None:
        raise InputError(f"There is no {subpath!r} in {share / 'robots'}.")
    return str(folder)
