"""Modules of the Toolbox that scripts import from, and where their names are here.

A place is "module:attribute" below `roboticstoolbox`; names without one are public names of `roboticstoolbox`.
"""

from __future__ import annotations

_TURNS = {
    name: f"_ets.elementary_transform:ET.{name}" for name in ("Rx", "Ry", "Rz", "tx", "ty", "tz", "SE3")
}
_PLANAR = {name: f"_ets.elementary_transform:ET2.{name}" for name in ("R", "tx", "ty", "SE2")}
_FIGURES = {"PyPlot": "_plot.figure:PyPlot", "PyPlot2": "_plot.figure:PyPlot2"}
_TYPES = {name: f"_common.array_types:{name}" for name in ("ArrayLike", "NDArray", "PyArrayLike")}

_CONNECTOR = {"Connector": "backends._connector:Connector"}

_OF_MOBILE = (
    "Animations", "Bug2", "CurvaturePolyPlanner", "DistanceTransformPlanner", "DstarPlanner", "DubinsPlanner",
    "EKF", "LatticePlanner", "OccGrid", "PRMPlanner", "ParticleFilter", "PlannerBase", "PoseGraph",
    "QuinticPolyPlanner", "RRTPlanner", "ReedsSheppPlanner", "Vehicle", "drivers", "landmarkmap", "sensors",
    "workspace",
)  # fmt: skip
_OF_BLOCKS = ("arm", "mobile", "quad_model", "spatial", "uav")
PLACES: dict[str, dict[str, str]] = {
    "ets.ET": {"ET": "", **_TURNS},
    "ets.ET2": {"ET2": "", **_PLANAR},
    "ets._ET": {
        "BaseET": "_ets.base_transform:BaseET",
        "_is_nothing": "_common.symbols:is_nothing",
        "_parse_joint_descriptor": "_ets.joint_descriptor:parse_joint",
        "_joint_display_name": "_ets.joint_descriptor:shown_name",
        "_offset_suffix": "_ets.joint_descriptor:shown_offset",
        "_resolve_param": "_ets.joint_descriptor:current_name",
    },
    "ets._ETS": {"BaseETS": "_ets.sequence:BaseETS"},
    "ets.ETS": {"ETS": ""},
    "ets.ETS2": {"ETS2": ""},
    "ets.fknm": {
        name: f"_ets.handles:{name}"
        for name in (
            "Angle_Axis", "ETS_fkine", "ETS_hessian0", "ETS_hessiane", "ETS_init", "ETS_jacob0", "ETS_jacobe", "ET_T",
            "IK_GN_c", "IK_LM_c", "IK_NR_c", "r2q",
        )
    },
    "robot.Link": {"Link": "", "Link2": "", "BaseLink": "_links.link:Link"},
    "robot.Robot": {
        "Robot": "", "Robot2": "", "BaseRobot": "", "_rotation_between_vectors": "_common.poses:rotation_between",
    },
    "robot.BaseRobot": {"BaseRobot": "", "_is_symbolic": "_common.symbols:has_symbols"},
    "robot.DHRobot": {"DHRobot": "", "SerialLink": ""},
    "robot.Dynamics": {"DynamicsMixin": "_dynamics.dynamics:Dynamics", "fdyn": "_dynamics.simulation:fdyn"},
    "robot.RobotKinematics": {"RobotKinematicsMixin": "_kinematics.kinematics:Kinematics"},
    "robot.RobotPlottingMPL": {"RobotPlottingMPLMixin": "_plot.plotting:Plotting"},
    "robot.RobotProto": {},
    "robot.frne": {},
    "robot.symbolic_ik": {},
    "robot.symbolic_ik_rr": {"AnalyticIK": "_ik.analytic:AnalyticIK"},
    "robot.DHFactor": {},
    "tools": _TYPES,
    "tools.types": _TYPES,
    "tools.plot": {
        "xplot": "",
        "plane_view": "_plot.views:plane_view",
        "set_plane_view": "_plot.views:set_plane_view",
        "apply_block": "_plot.views:apply_block",
    },
    "tools.DHFactor": {},
    "tools.urdf": {},
    "tools.urdf.urdf": {},
    "tools.urdf.utils": {},
    "models.catalog": {"catalog": "models:catalog", "list": "models:list"},
    "backends": _CONNECTOR,
    "backends.Connector": _CONNECTOR,
    "backends.PyPlot.PyPlot": {"PyPlot": _FIGURES["PyPlot"]},
    "backends.PyPlot.PyPlot2": {"PyPlot2": _FIGURES["PyPlot2"]},
    "backends.PyPlot.RobotPlot": {"RobotPlot": "_plot.robot_plot:RobotPlot"},
    "backends.PyPlot.RobotPlot2": {"RobotPlot2": "_plot.robot_plot:RobotPlot"},
    "backends.PyPlot.EllipsePlot": {"EllipsePlot": "_plot.ellipsoids:EllipsePlot"},
    "bin": {},
    "bin._bintools": {},
    "demo": {},
    "demo.eigdemo": {},
    "demo.tripleangledemo": {},
    "demo.twistdemo": {},
    "backends.ROS": {},
    "backends.ROS.ROS": {},
    **{f"mobile.{name}": {} for name in _OF_MOBILE},
    **{f"blocks.{name}": {} for name in _OF_BLOCKS},
    "mobile": {},
    "blocks": {},
    "models.DH.Uprighttl": {},
    "models.ETS.Omni": {},
    "_fknm_c": {},
    "_frne_c": {},
}  # fmt: skip

_CLOSED = (
    "tools.urdf", "tools.DHFactor", "robot.DHFactor", "bin._bintools", "demo", "backends.ROS", "mobile", "blocks",
    "_fknm_c", "_frne_c", "models.DH.Uprighttl", "models.ETS.Omni",
)  # fmt: skip
"""Modules, and packages with all of theirs, whose names mean something else than public names of `roboticstoolbox`."""

_URDF = "`ulna.load(path)`, `models.URDF.URDFRobot(path)` or `Robot.URDF(path)` read a description"
_PLOTS = "`env.add(robot)` draws a robot in a figure, `env.remove` takes it out"
_DEMOS = "demonstrations are the toolbox's own; `ulna demo` and the pages of Ulna's gallery show what is here"
_MOBILE = "Ulna is for robot arms; for mobile robots, maps, filters and block diagrams use the toolbox itself"
_ROS = "no backend of ROS is offered; `robot.plot` and `backends.PyPlot`, `backends.swift` draw"
_BINTOOLS = "the console tools are modules of `roboticstoolbox.bin`, such as `roboticstoolbox.bin.rtbtool`"
_ADVICE: dict[str, str] = {
    "mobile": _MOBILE,
    "blocks": _MOBILE,
    "demo": _DEMOS,
    "backends.ROS": _ROS,
    "_fknm_c": "`roboticstoolbox.ets.fknm` has the functions of chains",
    "_frne_c": "`robot.rne(q, qd, qdd)` is compiled",
    "models.DH.Uprighttl": "the toolbox has no robot in it, either",
    "models.ETS.Omni": "Ulna is for robot arms; `models.URDF.FrankieOmni` is an arm on a base that moves",
    "tools.urdf": _URDF,
    "tools.DHFactor": "the parameters of a chain are `ETS.split('dh')`",
    "robot.DHFactor": "the parameters of a chain are `ETS.split('dh')`",
    "robot.frne": "`robot.rne(q, qd, qdd)` is compiled, and `robot.dynchanged()` follows changed links by itself",
    "robot.symbolic_ik": "`robot.analytic_ik()` returns all configurations for a pose",
    "robot.symbolic_ik_rr": "`robot.analytic_ik()` returns all configurations for a pose",
    "robot.RobotProto": "annotate with `roboticstoolbox.Robot`",
    "robot.IK": "the solvers IK_LM, IK_NR, IK_GN and IK_QP are objects with `solve`",
    "ets.fknm": "the kernels of a chain are its methods: `ets.eval`, `ets.jacob0`, `robot.fkine_all`",
    "backends.PyPlot.RobotPlot": _PLOTS,
    "backends.PyPlot.RobotPlot2": _PLOTS,
    "backends.PyPlot.EllipsePlot": "`robot.vellipse(q)` and `robot.fellipse(q)` make ellipses for `env.add`",
    "bin": _BINTOOLS,
}
"""What to use in place of names of a module, or of a package and its modules, that are not offered."""


def is_closed(place: str) -> bool:
    """Whether names of a module mean something else than public names of `roboticstoolbox`.

    Args:
        place: Its name below `roboticstoolbox`.

    Returns:
        Whether they do.
    """
    return any(f"{place}.".startswith(f"{name}.") for name in _CLOSED)


def advice_on(place: str) -> str:
    """What to use in place of names of a module that are not offered; "" where there is nothing to say.

    Args:
        place: Its name below `roboticstoolbox`.

    Returns:
        The advice.
    """
    while place and place not in _ADVICE:
        place = place.rpartition(".")[0]
    return _ADVICE.get(place, "")
