"""Assignments of right and wrong values to every attribute that Pinocchio's classes have.

Each is the text of an expression, as in `generated_calls.py`: `wrote(object, "attribute", lambda now: value)`, where `now` is
what the attribute holds, and `answers.py` says what is read back, and which other attributes changed.
"""

from __future__ import annotations

from collections.abc import Iterator

from generated_calls import LEFT_OUT, example

FROM_PRESENT = (
    "now",
    "now * 1.5",
    "np.array(now, dtype=np.float32)",
    "np.array(now).round().astype(int)",
    "np.array(now).astype(complex) + 1j",
    "np.full(np.shape(now), np.nan)",
    "np.full(np.shape(now), None)",
    "np.full(np.shape(now), 'a')",
    "np.reshape(now, (-1, 1))",
    "np.asfortranarray(np.array(now) + 1.0)",
    "np.append(now, 1.0)",
    "np.zeros((2, *np.shape(now)))",
    "list(now)",
    "list(now)[1:]",
    "tuple(now)",
    "type(now)(now)",
    "now.copy()",
)
"""Values that are made of the present one; where that fails in Pinocchio, there is no assignment to compare."""
ALWAYS = (
    *("None", "True", "2", "-1", "2**70", "3.5", "float('nan')", "1j", "'a'", "b'a'", "[]", "{}", "[1.0]", "object()"),
    *("np.float64(0.5)", "np.float32(0.5)", "np.int64(2)", "np.int8(2)", "np.True_", "np.array(0.5)", "np.array([2])"),
    *("np.zeros(0)", "np.zeros(2)", "np.arange(3.0)", "[0.1, 0.2, 0.3]", "np.arange(6.0)", "np.eye(3)", "np.eye(4)", "np.eye(6)"),
    *("pin.SE3(np.eye(3), np.arange(3.0))", "pin.Motion(np.arange(6.0))", "pin.Force(np.arange(6.0))", "pin.Symmetric3(np.eye(3))"),
    *("pin.Inertia(2.0, np.zeros(3), np.eye(3))", "pin.Quaternion(1.0, 0.0, 0.0, 0.0)", "pin.WORLD", "pin.FrameType.BODY"),
    *("pin.BaumgarteCorrectorParameters(2.0, 3.0)", "pin.ContactType.CONTACT_6D", "pin.SE3", "pin.rnea"),
)  # fmt: skip
"""Values that are assigned to every attribute."""
OWN = {"m": "own_m", "m.joints[2]": "own_m.joints[2]", "go": "g.geometryObjects[0]"}
"""Examples that are changed in place of those that all calls share."""


OTHERS = {
    name: f"pin.{name}()" for name in ("ADMMSolverSettings", "PGSSolverSettings", "GeometryPhongMaterial")
}
"""Examples of classes of which no calls are generated."""
READ_ONLY = ("now", "2", "None")
"""Values that are assigned to attributes that are read only in Pinocchio."""


def writes(properties: dict[str, dict[str, bool]]) -> Iterator[tuple[str, str]]:
    """Pairs of a path and an expression that assigns to an attribute of an example.

    Args:
        properties: For each class the names of its properties, and whether they can be assigned to.
    """
    for owner, names in properties.items():
        this = OTHERS.get(owner) or example(owner, "self")
        this = OWN.get(this or "", this)
        for name, writable in names.items() if this else ():
            if LEFT_OUT.fullmatch(f"{owner}.{name}"):
                continue
            for value in (*FROM_PRESENT, *ALWAYS) if writable else READ_ONLY:
                yield f"{owner}.{name}", f"wrote({this}, {name!r}, lambda now: {value})"


def _written(names: str, values: str) -> str:
    """The pattern of assignments of some values to attributes of some names."""
    return rf"wrote\(.*, '({names})', lambda now: ({values})\)"


_NUMBERS = (
    r"mass|angle|[wxyz]|K[pd]|pitch|compliance|elasticity|meshShininess|\w+_energy|parent\w*|previousFrame|depth_joint\d|"
    r"(joint|geom)\d_id|nv|first|second|\w+_tol|\w*(rho|tau|prox)_?\w*|dual_momentum|ratio_primal_dual|"
    r"linear_update_rule_factor|anderson_capacity|lanczos_size|max_\w+|over_relaxation|radius_[xyz]"
)
_FLAGS = "overrideMaterial|disableCollision|solve_ncp|measure_timings|stat_record|warmstart\\w+"
_OF_NUMPY = (
    r"np\.True_|np\.(float32|int64|int8|array)\(\S*\)|np\.array\(now\)\.round\(\)\.astype\(int\)|"
    r"np\.array\(now, dtype=np\.float32\)|np\.full\(np\.shape\(now\), np\.nan\)"
)
_OTHER_SIZES = (
    r"np\.append\(now, 1\.0\)|np\.array\(\[2\]\)|np\.(zeros|arange|eye)\(.*\)|np\.reshape\(now, \(-1, 1\)\)|"
    r"list\(now\)\[1:\]|\[\]|\[1\.0\]|\[0\.1, 0\.2, 0\.3\]|(tuple|list)\(now\)"
)
_COMPUTED = (
    r"A\d?_(local|world)|\w*(supports|subtrees|joints|indexes_vector|pattern_vector)|\w+_fromRow|lastChild|nvSubtree|"
    r"(start|end)_idx_v_fromRow|mimic_\w+|o?Ya?crb|o?Yaba|U|osim|(constraint|contact)_chol|"
    r"(collision|distance|contactPatch)(Requests|Results)|\w+_functors|\w+_drift|contact_acceleration\w*|"
    r"extended_motion_propagators_joint\d|lambdas_joint1|dlambda_d\w+"
)
DOCUMENTED = (
    (
        r"accepted",
        _written(r"\w+", r"(list|tuple)\(now\)|\[0\.1, 0\.2, 0\.3\]"),
        "lists and tuples are taken",
    ),
    (r"accepted", _written(rf"{_NUMBERS}|{_FLAGS}", _OF_NUMPY), "numbers of NumPy are taken"),
    (r"refused", _written(r"\w+", _OTHER_SIZES), "sizes are those of the model, or of the object"),
    (r"refused|error class", _written(_COMPUTED, r".*"), "they are computed when they are read"),
    (
        r"accepted|error class",
        _written(_COMPUTED, r"now|now\.copy\(\)|(list|tuple)\(now\)|np\.array\(now, dtype=np\.float32\)"),
        "what they hold may be assigned",
    ),
    (
        r"value",
        _written(r"joints|nvSubtree|oYaba", r"now|now\.copy\(\)|type\(now\)\(now\)|(list|tuple)\(now\)"),
        "they hold other values, as calls say",
    ),
    (r"refused", _written(r"nv|(depth_joint|joint)\d\w*", r"-1"), "counts and indices are not below zero"),
    (r"refused|error class", _written(r"pitch|axis\d?", r".*nan.*"), "axes and pitches are finite"),
    (r"refused", _written(r"axis\d?", r"np\.zeros\(3\)"), "an axis has a direction"),
    (r"value", _written(r"axis\d?", r".*"), "axes are scaled to unit length"),
    (
        r"refused|accepted|error class",
        _written(r"axis", r"now \* 1\.5|np\.asfortranarray\(.*\)|np\.arange\(3\.0\)|\[0\.1, 0\.2, 0\.3\]"),
        "a prismatic joint slides one metre a unit of q",
    ),
    (
        r"refused",
        _written(r"reference_frame", r"pin\.WORLD"),
        "no constraint is along the axes of the world's frame",
    ),
    (r"refused", _written(r"geometry", r"None"), "a geometry has a shape"),
    (r"accepted", _written(r"gravity", r"np\..*|pin\.Force.*"), "three or six numbers are taken"),
    (r"accepted", _written(r"inertia", r"np\.full.*nan\)|pin\.Symmetric3.*"), "a Symmetric3 is taken"),
    (r"value", _written(r"lower(Velocity|Effort)Limit", r".*"), "lower limits are positive there"),
    (r"value", _written(r"oMg|oMc[12]|frames|M", r".*"), "what depends on it changes with it"),
    (r"value", _written(r"admm_\w+_rule", r".*"), "an enumeration of one name"),
    (
        r"accepted",
        _written(r"d\w+_d\w+|\w*contact\w*|(lambda|impulse)_c\w*|osim", r".*None.*"),
        "an array without entries is one of numbers",
    ),
    (
        r"accepted",
        _written(r"\w+Regressor", r"np\.reshape\(now, \(-1, 1\)\)"),
        "columns are taken for vectors",
    ),
    (r"accepted", _written(r"referenceConfigurations", r"\{\}"), "a dictionary is taken"),
    (r"accepted", _written(r"\w+", r"\[\]|list\(now\)\[1:\]"), "an empty list is taken for what is empty"),
    (r"value", _written(r"f|h|Fcrb", r".*"), "those of the universe"),
    (r"crash", _written(r"\w+", r".*"), "the value cannot be made here"),
)
"""What differs on purpose: the kind of difference, the expressions, and why."""
