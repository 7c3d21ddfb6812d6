"""RobotLoader: a robot of example-robot-data with its posture, limits and collision pairs."""

from __future__ import annotations

import os
from typing import Any, ClassVar

import numpy as np
import pinocchio as pin
from pinocchio.robot_wrapper import RobotWrapper

from ulna.errors import InputError, MissingExtra, UnknownName
from ulna.robots.example_robot_data import share_folder


def getModelPath(subpath: str, verbose: bool = False) -> str:
    """The folder that holds a path below the folder of all robots.

    Args:
        subpath: The path.
        verbose: Whether to print the folder.

    Returns:
        The folder.

    Raises:
        MissingExtra: The package example-robot-data is not installed.
        InputError: There is no such file or folder in it.
    """
    share = share_folder()
    if share is None:
        raise MissingExtra("example-robot-data", "robots", f"The path {subpath!r}")
    folder = next((f for f in (share / "robots", share.parent) if (f / subpath.strip("/")).exists()), None)
    if folder is None:
        raise InputError(f"There is no {subpath!r} in {share / 'robots'}.")
    if verbose:
        print(f"using {folder} as modelPath")
    return str(folder)


def readParamsFromSrdf(
    model: Any,
    SRDF_PATH: Any,
    verbose: bool = False,
    has_rotor_parameters: bool = True,
    referencePose: str | None = "half_sitting",
) -> Any:
    """Reads rotor inertias and named configurations of an SRDF file into a model, and sets its armature.

    Args:
        model: The model; its armature becomes rotor inertia times the square of the gear ratio.
        SRDF_PATH: The file.
        verbose: Whether to print what is read.
        has_rotor_parameters: Whether the file has rotor inertias and gear ratios.
        referencePose: Name of the configuration to return; the neutral one for None.

    Returns:
        The configuration, (nq,).

    Raises:
        UnknownName: The file has no configuration of that name.
    """
    path = str(SRDF_PATH)
    if has_rotor_parameters:
        pin.loadRotorParameters(model, path, verbose)
    model.armature = np.asarray(model.rotorInertia) * np.square(model.rotorGearRatio)
    pin.loadReferenceConfigurations(model, path, verbose)
    if referencePose is None:
        return pin.neutral(model)
    if referencePose not in model.referenceConfigurations:
        names = [entry.key() for entry in model.referenceConfigurations]
        raise UnknownName(f"configuration of {path}", referencePose, names)
    return pin.normalize(model, np.array(model.referenceConfigurations[referencePose]))


class RobotLoader:
    """Loads a robot: `PandaLoader().robot`. A subclass states with its class attributes where the files are.

    Args:
        verbose: Whether to print which folder the files are in.

    Raises:
        InputError: There are no such files.
    """

    path: ClassVar[str] = ""
    """Folder of the robot."""
    urdf_filename: ClassVar[str] = ""
    urdf_subpath: ClassVar[str] = "robots"
    srdf_filename: ClassVar[str] = ""
    srdf_subpath: ClassVar[str] = "srdf"
    ref_posture: ClassVar[str | None] = "half_sitting"
    """Name of the configuration of the SRDF that is `robot.q0`."""
    has_rotor_parameters: ClassVar[bool] = False
    free_flyer: ClassVar[bool] = False
    model_path: str | None = None
    """Folder that `path` is in; that of the installed data when not given."""

    def __init__(self, verbose: bool = False) -> None:
        self.verbose = verbose
        if not self.urdf_filename:
            raise InputError(f"{type(self).__name__} names no `urdf_filename`; SDF files are not read.")
        urdf = "/".join((self.path, self.urdf_subpath, self.urdf_filename))
        if self.model_path is None:
            self.model_path = getModelPath(urdf, verbose)
        self.df_path = os.path.join(self.model_path, urdf)
        """The URDF file."""
        root = pin.JointModelFreeFlyer() if self.free_flyer else None
        folders = [os.path.join(self.model_path, "..", "..")]
        self.robot: RobotWrapper = RobotWrapper.BuildFromURDF(self.df_path, folders, root)
        self.srdf_path: str | None = None
        """The SRDF file, or None."""
        if self.srdf_filename:
            self._read_srdf(os.path.join(self.model_path, self.path, self.srdf_subpath, self.srdf_filename))
        self.robot.__dict__["urdf"] = self.df_path
        if self.free_flyer:
            self.addFreeFlyerJointLimits()

    def _read_srdf(self, path: str) -> None:
        self.srdf_path = path
        robot = self.robot
        robot.q0 = readParamsFromSrdf(
            robot.model, path, self.verbose, self.has_rotor_parameters, self.ref_posture
        )
        if robot.collision_model is not None:
            robot.collision_model.addAllCollisionPairs()
            pin.removeCollisionPairs(robot.model, robot.collision_model, path, False)
            robot.collision_data = robot.collision_model.createData()

    def addFreeFlyerJointLimits(self) -> None:
        """Limits position and quaternion of the free flyer to -1 to 1."""
        for limits, bound in (
            (self.robot.model.upperPositionLimit, 1.0),
            (self.robot.model.lowerPositionLimit, -1.0),
        ):
            limits[:7] = bound
