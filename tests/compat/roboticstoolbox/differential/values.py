"""Arguments of calls: for each name of a parameter expressions of valid, boundary and invalid values."""

from __future__ import annotations

BOOLEANS = ("True", "False")
POSES = ("T", "T.A", "SE3()", "None", "np.eye(3)", "'x'")
VECTORS = (
    "{0}",
    "{0}.tolist()",
    "np.vstack([{0}, 2 * {0}, {0}])",
    "{0}[None]",
    "0 * {0}",
    "{0}[:-1]",
    "np.r_[{0}, 1.0]",
    "None",
)
CONFIGURATIONS = (*VECTORS, "'x'", "{0}[:, None]")
LINKS = ("None", "robot.links[-1]", "robot.links[1].name", "robot.links[0]", "'nonsense'")
GRAVITY = ("[0, 0, -9.81]", "[1, 2, 3]", "np.zeros(3)", "None", "[1, 2]")
ANGLES = ("'rpy/xyz'", "'rpy/zyx'", "'eul'", "'exp'", "'nonsense'", "None")
NUMBERS = ("0", "0.3", "-1.5", "'x'")
INDICES = ("0", "1", "2", "-1", "99", "'x'")
AXES = (
    "'all'",
    "'trans'",
    "'rot'",
    "'both'",
    "'translation'",
    "[True] * 3 + [False] * 3",
    "'nonsense'",
    "[True, False]",
)
TIMES = ("5", "np.linspace(0, 2, 5)", "np.linspace(5, 7, 5)", "[0, 1, 2, 3]", "1", "'x'", "2.5", "None")
SIX = ("np.arange(6.0)", "[1, 0, 0, 0, 0, 1]", "np.zeros(6)", "np.ones(3)", "None")

VALUES: dict[str, tuple[str, ...]] = {
    "q": CONFIGURATIONS, "Q": CONFIGURATIONS,
    "qd": tuple(v.replace("{0}", "{1}") for v in VECTORS), "QD": tuple(v.replace("{0}", "{1}") for v in VECTORS),
    "qdd": tuple(v.replace("{0}", "{2}") for v in VECTORS), "QDD": tuple(v.replace("{0}", "{2}") for v in VECTORS),
    "torque": tuple(v.replace("{0}", "{2}") for v in VECTORS),
    "J": ("J", "J[:, :-1]", "None", "J.tolist()"), "J0": ("J", "J[:, :-1]", "None"), "Je": ("J", "J[:, :-1]", "None"),
    "H": ("robot.hessian0({0})", "np.zeros((2, 2))", "None"),
    "Ji": ("np.linalg.pinv(J)", "None"), "Jd": ("J", "None"), "C": ("np.eye({n})", "None"), "Mx": ("np.eye(6)", "None"),
    "end": LINKS, "start": LINKS, "tool": POSES, "base": POSES, "T": POSES, "T0": POSES, "T1": POSES, "Te": POSES, "Td": POSES,
    "Tep": ("robot.fkine({0})", "robot.fkine({0}).A", "T", "np.eye(3)", "None", "robot.fkine(np.vstack([{0}, 0.9 * {0}]))"),
    "wTe": POSES, "wTep": POSES, "gain": ("1.0", "2", "np.arange(6.0)", "[1, 2]"), "threshold": ("0.1", "10", "0"),
    "include_base": BOOLEANS, "representation": ANGLES, "axes": AXES, "unit": ("'rad'", "'deg'", "'foo'"),
    "axis": ("'x'", "'y'", "'z'", "'w'"), "i": INDICES, "j": (*INDICES, "[0, 1]", "[1, 2]"), "index": INDICES, "gravity": GRAVITY,
    "w": SIX, "wrench": SIX, "fext": SIX, "xd": SIX, "frame": ("'base'", "'ee'", "'foo'"),
    "tau_m": ("np.full({n}, 99.0)", "np.array([np.full({n}, -99.0), np.full({n}, 150.0)])", "np.ones({n} + 1)", "np.zeros({n})"),
    "half": ("None", "'trans'", "'rot'", "'foo'"), "m": ("1.5", "0", "-1"), "p": ("None", "[0.1, 0, 0.2]", "[1, 2]", "0.0"),
    "coulomb": BOOLEANS, "viscous": BOOLEANS, "format": ("'dot'", "'mermaid'", "'mermaid_fenced'", "'foo'"),
    "ets": ("'full'", "'brief'", "'foo'"), "etsbox": BOOLEANS, "jtype": BOOLEANS, "static": BOOLEANS,
    "name": ("'abc'", "''"), "opt": ("'trans'", "'rot'", "'foo'"), "n": ("1", "2", "3", "0"), "value": NUMBERS,
    "ilimit": ("30", "50"), "slimit": ("100", "50"), "tol": ("1e-3", "1e-9"), "mask": ("None", "[1, 1, 1, 0, 0, 0]", "[1, 1]"),
    "joint_limits": BOOLEANS, "seed": ("1", "None"), "k": ("1.0", "0.1"), "kq": ("0.0", "1.0"), "km": ("0.0", "1.0"),
    "ps": ("0.0", "0.05"), "pi": ("0.3",), "kj": ("1.0", "0.1"), "ks": ("1.0", "2.0"), "pinv": BOOLEANS,
    "q0": ("{0}", "None", "{0}[:-1]", "np.vstack([{0}, {0}])", "'x'"), "t": TIMES, "V": ("None", "0.4", "0.01", "9.0", "-0.3"),
    "s": ("np.linspace(0, 1, 4)", "[0, 0.5]", "'x'"), "indent": ("0", "4"), "border": ("'thin'", "'thick'", "'ascii'"),
    "what": ("None", "'gravity'"), "old": BOOLEANS, "base_wrench": BOOLEANS, "symbolic": ("False",), "func": ("None",),
    "ps_": ("0.05",), "di": ("0.3", "9.0"), "dtype": ("float",), "config": ("'lu'", "'lx'", "''"),
    "allowables": ("('lr', 'ud', 'nf')",), "jindex": ("0", "3", "-1", "'x'", "None"), "flip": BOOLEANS,
    "qlim": ("[-1, 1]", "np.array([0, 2])", "None", "[1, 2, 3]", "'x'"), "eta": ("0.3", "None"),
    "param": ("0.3", "None", "2", "'x y'", "'q1'", "'-q1'", "'2.5'"), "parent": ("None", "'base'", "Link(name='p')", "3"),
    "joint_name": ("'j'", "None"), "r": ("[1, 2, 3]", "[1, 2]"), "I": ("[1, 2, 3]", "np.eye(3)", "np.arange(6.0)", "[1, 2]", "np.arange(9.0).reshape(3, 3)"),
    "Jm": ("0.1",), "B": ("0.1", "[1, 2]"), "Tc": ("0.1", "[0.1, -0.2]", "[1, 2, 3]"), "G": ("2.0", "-3.0"), "qdlim": ("2.0",), "tlim": ("3.0",),
    "d": NUMBERS, "a": NUMBERS, "alpha": NUMBERS, "theta": NUMBERS, "offset": NUMBERS, "sigma": ("0", "1"), "mdh": ("False", "True", "1"),
    "arg": ("chain()", "[ET.Rx(), ET.tz(1)]", "ET.Rx()", "None", "3", "[1]"), "manufacturer": ("'me'",), "comment": ("'c'",),
    "keywords": ("('a', 'b')",), "configs": ("{'qq': [0, 0, 0]}",), "check_jindex": BOOLEANS, "gripper_links": ("None",),
    "meshdir": ("None",), "success": BOOLEANS, "iterations": ("3",), "searches": ("2",), "residual": ("1e-3",), "reason": ("'r'",),
    "A": ("np.arange(6.0).reshape(2, 3)", "np.eye(2)", "np.ones((3, 3))", "np.array([[1, 2], [2, 4.000001]])"), "atol": ("1e-13", "1e-3"), "rtol": ("0", "1e-3"),
    "chain": ("'Rx(0.3) Tz(2)'", "'Tz(1) Rx(0.2)'", "'Ry(q1) Tx(2 * 3)'", "''", "'Rw(1)'", "'R(0.3)Tx(1)'"),
    "qvar": ("'q'", "'a'"), "variables": ("None", "{'a': 2}"), "return_tokens": BOOLEANS, "verbose": ("False",),
    "qd0": ("None", "0.2"), "qdf": ("0", "0.4"), "qd1": ("None",), "dx": ("1e-8", "1e-6"), "N": ("0",),
    "f": ("lambda x: np.array([x[0] ** 2, x[0] * x[1]])",), "x": ("np.array([1.0, 2.0])",),
    "links": ("dh()", "[rtb.RevoluteDH(a=1)]", "[]", "[Link()]"), "new_data": ("[]",), "stop": ("None",),
    "be": ("None", "'foo'"), "control_mode": ("'p'", "'v'", "'a'", "'x'"), "scale": ("0.1",), "dq": ("{1}",),
    "robot_alpha": ("1.0",), "collision_alpha": ("0.0",), "gripper": ("None",), "local": BOOLEANS,
}  # fmt: skip
"""{0}, {1}, {2} stand for a configuration, a velocity and an acceleration, {n} for the number of joints."""

OF_MEMBER: dict[str, dict[str, tuple[str, ...]]] = {
    "manipulability": {"method": ("'yoshikawa'", "'asada'", "'minsingular'", "'invcondition'", "'nonsense'")},
    "split": {"method": ("'last'", "'first'", "'dh'", "'mdh'", "'nonsense'")},
    "p_servo": {"method": ("'rpy'", "'angle-axis'", "'nonsense'")},
    "quintic_func": {"method": ("'lstsq'", "'hermite'", "'nonsense'"), "T": ("2.0", "0", "np.inf", "-1.0")},
    "trapezoidal_func": {"T": ("2.0", "0.5", "-1.0")},
    "islimit": {"q": ("{0}", "0.3", "9.0", "None")}, "friction": {"qd": ("{1}", "0.3", "-0.3", "0.0")},
    "toradians": {"q": ("{0}", "{0}.tolist()", "np.vstack([{0}, {0}])")}, "todegrees": {"q": ("{0}", "{0}.tolist()", "np.vstack([{0}, {0}])")},
    "append": {"value": ("ET.Rx(0.1)", "ET.tz()", "3")}, "extend": {"values": ("[ET.Rx(0.1)]", "ETS(ET.tz(1))", "3")},
    "insert": {"value": ("ET.Rx(0.1)", "ETS(ET.tz(1))", "3"), "arg": ("ET2.tx(1)",)}, "remove": {"value": ("robot[0]", "ET.ty(7)")},
    "count": {"value": ("robot[0]", "ET.ty(7)")},
    "mtraj": {"tfunc": ("rtb.quintic", "rtb.trapezoidal", "3"), "q0": ("[0, 1]", "[1]"), "qf": ("[1, 3]", "[1, 2, 3]")},
    "mstraj": {"viapoints": ("np.array([[0, 0], [1, 2], [3, 1.0]])",), "dt": ("0.1",), "tacc": ("0.2", "[0.2, 0.4]", "0", "[1, 2, 3]"), "qdmax": ("1.0", "[1, 2]", "[1, 2, 3]"),
               "tsegment": ("[1, 2]", "[1]"), "q0": ("[0, 1]", "[1]"), "qd0": ("[0.1, 0.2]", "[1]"), "qdf": ("[0.1, 0.2]", "[1]")},
    "jtraj": {"q0": ("{0}", "{0}[:-1]"), "qf": ("2 * {0}", "{0}[:-1]"), "qd0": ("None", "{0}", "[1]"), "qd1": ("None", "{0}", "[1]"), "t": TIMES[:6]},
    "quintic": {"q0": ("0", "1.5", "[1, 2]"), "qf": ("1", "-2", "[1, 2]")}, "trapezoidal": {"q0": ("0", "1.5", "[1, 2]"), "qf": ("1", "-2", "0")},
    "A": {"q": ("0.3", "0", "None", "'x'"), "j": ("0", "1", "[0, 1]", "[1, 2]", "99")},
    "rtb_get_param": {"param": ("'unicode'", "'nonsense'")}, "jsingu": {"J": ("np.arange(12.0).reshape(3, 4)", "np.eye(3)")},
    "hessian_numerical": {"J": ("lambda x: np.array([[x[0], x[1]], [x[0] * x[1], 1]])",)},
    "solve": {"ets": ("PANDA", "3"), "Tep": ("PANDA.fkine({0})", "PANDA.fkine({0}).A", "np.eye(3)")},
    "step": {"ets": ("PANDA",), "Tep": ("PANDA.fkine(0.9 * {0}).A",), "q": ("{0}.copy()",)},
    "trchain": {"q": ("None", "[0.3]", "[]")}, "trchain2": {"q": ("None", "[0.3]", "[]")}, "PoERevolute": {"axis": ("[0, 0, 1]", "[0, 2, 0]"), "point": ("[0, 0, 0]", "[1, 2, 3]")},
    "PoEPrismatic": {"axis": ("[0, 0, 1]", "[0, 2, 0]")}, "PoERobot": {"links": ("[rtb.PoERevolute([0, 0, 1], [0, 0, 0])]",), "T0": ("T",)}, "DHLink": {"alpha": NUMBERS[:3]},
    "payload": {"p": ("None", "[0.1, 0, 0.2]", "[1, 2]")}, "perturb": {"p": ("0.0",)}, "dfs_links": {"start": ("robot.links[0]",)}, "nofriction": {},
    "Gripper": {"links": ("[Link(ETS(ET.ty()), name='f')]", "[]", "3"), "name": ("'h'",)}, "IKSolution": {"q": ("np.arange(3.0)", "None", "np.ones((8, 2))")},
    "Robot": {"arg": ("chain()", "arm()", "[Link(ET.Rx(), name='a')]", "[]", "3", "None"), "configs": ("{'qq': [0, 0, 0]}",)},
    "Robot2": {"arg": ("flat()", "[]")}, "ERobot": {"arg": ("chain()", "[Link(ET.Rx()), Link(ET.Ry())]")}, "DHRobot": {},
    "Link": {"ets": ("ETS(ET.Rx())", "ET.tz(1)", "ET.Rz() * ET.tx(1)", "ET.Rz() * ET.Rx()", "3")}, "Link2": {"ets": ("ET2.R()",)},
    "ETS2": {"arg": ("flat()", "ET2.R()", "None", "3")}, "SE3": {"T": ("T", "T.A", "3")}, "SE2": {"T": ("S", "S.A", "3")},
    "config_validate": {}, "addconfiguration": {"q": ("{0}", "{0}[:-1]")}, "addconfiguration_attr": {"q": ("{0}", "{0}[:-1]")}, "get_path": {},
    "error": {"Te": ("T.A",), "Tep": ("SE3(1, 2, 3).A",)}, "rotation": {},
    "inertia_x": {}, "ik_LM": {"method": ("'chan'", "'wampler'", "'sugihara'")}, "ikine_LM": {"method": ("'chan'", "'wampler'", "'sugihara'")},
    "IK_LM": {"method": ("'chan'", "'wampler'", "'sugihara'", "'foo'")}, "isrevolute": {"j": ("0", "1", "99")}, "isprismatic": {"j": ("0", "1", "99")},
}  # fmt: skip
"""Values of parameters of certain functions, instead of those of `VALUES`."""

MORE_KEYWORDS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("Rx", "Ry", "Rz", "R"), ("jindex", "flip", "qlim")),
    **dict.fromkeys(("tx", "ty", "tz"), ("jindex", "flip", "qlim")),
    **dict.fromkeys(
        ("Link", "Link2", "DHLink", "RevoluteDH", "PrismaticDH", "RevoluteMDH", "PrismaticMDH"),
        (
            "name",
            "parent",
            "joint_name",
            "m",
            "r",
            "I",
            "Jm",
            "B",
            "Tc",
            "G",
            "qlim",
            "qdlim",
            "tlim",
            "flip",
        ),
    ),
    "DHRobot": ("name", "manufacturer", "base", "tool", "gravity", "comment", "keywords", "configs"),
    "graph": ("etsbox", "ets", "jtype", "static"),
}
"""Keywords that functions take as `**kwargs`."""
