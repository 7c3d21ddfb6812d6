"""Robots of the installed example-robot-data: a class that loads each, by its name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from pinocchio.robot_wrapper import RobotWrapper

from example_robot_data.robot_loader import RobotLoader, getModelPath, readParamsFromSrdf
from ulna.errors import InputError, UnknownName
from ulna.robots.example_robot_data import DESCRIPTIONS

_CLASS_NAMES = """
    a1 A1, alex_nub_hands AlexNubHands, alex_psyonic_hands AlexPsyonicHands, alex_sake_hands AlexSakeHands,
    alexander Alexander, allegro_left_hand AllegroLeftHand, allegro_right_hand AllegroRightHand, anymal ANYmal,
    anymal_c ANYmalC, anymal_kinova ANYmalKinova, asr_twodof AsrTwoDof, b1 B1, b1_z1 B1Z1, baxter Baxter, bolt
    Bolt, borinot Borinot, centauro Centauro, double_pendulum DoublePendulum, double_pendulum_continuous
    DoublePendulumContinuous, double_pendulum_simple DoublePendulumSimple, finger_edu FingerEdu, g1 G1,
    g1_with_hands G1WithHands, go1 Go1, go2 Go2, hector Hector, hextilt Hextilt, human Human, hyq HyQ, icub ICub,
    icub_reduced ICubReduced, iris Iris, kinova Kinova, laikago Laikago, panda Panda, pr2 PR2, quadruped
    Quadruped, romeo Romeo, simple_humanoid SimpleHumanoid, simple_humanoid_classical SimpleHumanoidClassical,
    so100 SO100, so101 SO101, solo12 Solo12, solo8 Solo8, talos Talos, talos_arm TalosArm, talos_box TalosBox,
    talos_full TalosFull, talos_full_box TalosFullBox, tiago Tiago, tiago_dual TiagoDual, tiago_no_hand
    TiagoNoHand, tiago_pro TiagoPro, ur10 UR10, ur10_limited UR10Limited, ur3 UR3, ur3_gripper UR3Gripper,
    ur3_limited UR3Limited, ur5 UR5, ur5_gripper UR5Gripper, ur5_limited UR5Limited, xarm7 xArm7, z1 Z1
"""
_SPECIAL: dict[str, dict[str, Any]] = {
    "alex_nub_hands": {"srdf_filename": ""},
    "centauro": {"ref_posture": "homing_balanced"},
    "human": {"free_flyer": True},
    "pr2": {"ref_posture": "tuck_left_arm"},
    "romeo": {"srdf_filename": ""},
    "so100": {"free_flyer": True},
    "so101": {"free_flyer": True},
    "ur5_limited": {"srdf_filename": "ur5.srdf"},
}
"""Where a loader differs from the description that `ulna.load` uses."""


def _attributes(name: str) -> dict[str, Any]:
    entry = DESCRIPTIONS[name]
    folder, *between, urdf = entry.urdf.split("/")
    return {
        "__doc__": f"Loads {name}.",
        "path": folder,
        "urdf_subpath": "/".join(between),
        "urdf_filename": urdf,
        "srdf_filename": (entry.srdf or "").rpartition("/")[2],
        "ref_posture": entry.posture,
        "free_flyer": entry.floating,
        "has_rotor_parameters": name.startswith("talos"),
    } | _SPECIAL.get(name, {})


def _loader(name: str, prefix: str) -> type[RobotLoader]:
    return type(f"{prefix}Loader", (RobotLoader,), _attributes(name) | {"__module__": __name__})


_WORDS = _CLASS_NAMES.replace(",", " ").split()
_NAMED = dict(zip(_WORDS[::2], _WORDS[1::2], strict=True))
ROBOTS: dict[str, type[RobotLoader]] = {name: _loader(name, prefix) for name, prefix in _NAMED.items()}
"""The class that loads each robot."""


class PandaLoaderCollision(ROBOTS["panda"]):  # type: ignore[misc]
    """Panda whose collision geometries are cylinders with rounded ends.

    Args:
        verbose: Whether to print which folder the files are in.
    """

    urdf_filename = "panda_collision.urdf"

    def __init__(self, verbose: bool = False) -> None:
        super().__init__(verbose)
        self.srdf_path = None
        self.robot.q0 = pin.neutral(self.robot.model)
        self._round_cylinders()

    def _round_cylinders(self) -> None:
        """Replaces cylinders by capsules of the same radius and half length, and drops the spheres at their ends."""
        from ulna.geometry import Capsule, Cylinder, Sphere

        model, count = self.robot.collision_model, dict[str, int]()
        assert model is not None
        for geometry in list(model.geometryObjects):
            base, shape = geometry.name.rpartition("_")[0], geometry.shape
            if isinstance(shape, Cylinder):
                number = count[base] = count.get(base, -1) + 1
                capsule = Capsule(shape.radius, shape.length / 2.0)
                parents = (int(geometry.parentJoint), int(geometry.parentFrame))
                new = pin.GeometryObject(f"{base}_capsule_{number}", *parents, geometry.placement, capsule)
                new.meshColor = np.array([249, 136, 126, 125]) / 255
                model.addGeometryObject(new)
                model.removeGeometryObject(geometry.name)
            elif isinstance(shape, Sphere) and "link" in geometry.name:
                model.removeGeometryObject(geometry.name)
        self.robot.collision_data = model.createData()


class TalosLegsLoader(ROBOTS["talos"]):  # type: ignore[misc]
    """Talos with its free flyer and legs alone: the joints with the lowest indices.

    Args:
        verbose: Whether to print which folder the files are in.
    """

    _FIRST_LEFT_OUT = 14

    def __init__(self, verbose: bool = False) -> None:
        super().__init__(verbose)
        robot, count = self.robot, self._FIRST_LEFT_OUT
        robot.model = _first_joints(robot.model, count)
        robot.data = robot.model.createData()
        looks = pin.GeometryModel()
        assert robot.visual_model is not None
        for geometry in robot.visual_model.geometryObjects:
            if geometry.parentJoint < count:
                looks.addGeometryObject(geometry)
        robot.visual_model, robot.visual_data = looks, looks.createData()
        robot.model.effortLimit[:6] = np.inf
        robot.q0 = readParamsFromSrdf(robot.model, self.srdf_path, verbose, True, self.ref_posture)
        self.addFreeFlyerJointLimits()


def _first_joints(whole: Any, count: int) -> Any:
    """A model of the joints of another with indices below `count`, with their bodies, limits and frames."""
    part = pin.Model()
    for i in range(count):
        joint = whole.joints[i]
        if i > 0:
            made = getattr(pin, joint.shortname())()
            part.addJoint(whole.parents[i], made, whole.jointPlacements[i], whole.names[i])
        part.appendBodyToJoint(i, whole.inertias[i], pin.SE3.Identity())
    for name in ("upperPositionLimit", "lowerPositionLimit"):
        getattr(part, name)[:] = getattr(whole, name)[: part.nq]
    for name in ("velocityLimit", "effortLimit"):
        getattr(part, name)[:] = getattr(whole, name)[: part.nv]
    for frame in whole.frames:
        if frame.parentJoint < count:
            part.addFrame(frame)
    return part


ROBOTS |= {"panda_collision": PandaLoaderCollision, "talos_legs": TalosLegsLoader}
ROBOTS |= {
    name: _loader(name, "".join(part.capitalize() for part in name.split("_")))
    for name in DESCRIPTIONS
    if name not in ROBOTS
}
__all__ = [
    "ROBOTS",
    "RobotLoader",
    "getModelPath",
    "load",
    "loadUR",
    "load_full",
    "loader",
    "readParamsFromSrdf",
]
globals().update({cls.__name__: cls for cls in ROBOTS.values()})


def loader(name: str, display: bool = False, rootNodeName: str = "", verbose: bool = False) -> RobotLoader:
    """Loads a robot, and shows it if wanted.

    Args:
        name: Its name, such as "ur5", "panda", "talos", "solo12".
        display: Whether to open the viewer and show it.
        rootNodeName: The node of the viewer it is shown at.
        verbose: Whether to print which folder the files are in.

    Returns:
        Its loader, with `robot`, `df_path` and `srdf_path`.

    Raises:
        UnknownName: There is no robot of that name; offers the nearest one.
        MissingExtra: The package example-robot-data is not installed.
        InputError: It needs what is not read.
    """
    if name == "cassie":
        raise InputError(
            "cassie is described by an SDF file, which is not read. ulna.load reads URDF and MJCF files."
        )
    if name not in ROBOTS:
        raise UnknownName("robot of example-robot-data", name, ROBOTS)
    loaded = ROBOTS[name](verbose)
    if display:
        loaded.robot.initViewer(loadModel=False)
        loaded.robot.loadViewerModel(rootNodeName or "pinocchio")
        loaded.robot.display(loaded.robot.q0)
    return loaded


def load(name: str, display: bool = False, rootNodeName: str = "", verbose: bool = False) -> RobotWrapper:
    """A robot of example-robot-data; those that move about have a free flyer at their root.

    `robot.q0` is the posture it usually starts from, `model.referenceConfigurations` has all that are named.

    Args:
        name: Its name, such as "ur5", "panda", "talos", "solo12".
        display: Whether to open the viewer and show it.
        rootNodeName: The node of the viewer it is shown at.
        verbose: Whether to print which folder the files are in.

    Returns:
        The robot with its model, geometries and start posture `q0`.
    """
    return loader(name, display, rootNodeName, verbose).robot


def load_full(
    name: str, display: bool = False, rootNodeName: str = "", verbose: bool = False
) -> tuple[RobotWrapper, Any, str, str | None]:
    """A robot of example-robot-data with the posture it starts from, and its files; see `load`.

    Args:
        name: Its name, such as "ur5", "panda", "talos", "solo12".
        display: Whether to open the viewer and show it.
        rootNodeName: The node of the viewer it is shown at.
        verbose: Whether to print which folder the files are in.

    Returns:
        The robot, its posture (nq,), the URDF file, and the SRDF file or None.
    """
    loaded = loader(name, display, rootNodeName, verbose)
    return loaded.robot, loaded.robot.q0, loaded.df_path, loaded.srdf_path


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
