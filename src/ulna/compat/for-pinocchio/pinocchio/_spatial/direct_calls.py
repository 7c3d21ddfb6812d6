"""Calls of small objects that run no Python: their methods, operators and properties, by the types of the arguments.

The methods themselves are called for all other types, and give the same answers.
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from pinocchio._spatial.bound_functions import BoundFunctions, Row, called_directly, copies_of
from pinocchio._spatial.inertia import BODIES, FORCES_OF_BODIES, Inertia
from pinocchio._spatial.motion_force import Force, Motion
from pinocchio._spatial.rotations import Quaternion
from pinocchio._spatial.se3 import MATRICES, PLACEMENTS, SE3
from pinocchio._spatial.small_kernels import (
    SMALL,
    equality,
    excess_of_all,
    pose_excess,
    six_excess,
    smallness,
    truth_within,
)
from pinocchio._spatial.symmetric3 import Symmetric3
from ulna.compiler.runtime.array_property import array_property
from ulna.typing import Array

_SHAPES: dict[type, tuple[int, ...]] = {
    SE3: (4, 4),
    Motion: (6,),
    Force: (6,),
    Inertia: (13,),
    Quaternion: (4,),
    Symmetric3: (6,),
}
_NOTHING: dict[type, tuple[str, Any]] = {
    SE3: ("isIdentity", lambda m: m - np.eye(4)),
    Motion: ("isZero", lambda v: v),
    Force: ("isZero", lambda v: v),
    Inertia: ("isZero", lambda p: p),
    Symmetric3: ("isZero", lambda d: d),
}
"""What says whether they are nearly nothing, and the numbers that are to be small then."""
_EXCESS: dict[type, Any] = {
    SE3: pose_excess,
    Motion: six_excess,
    Force: six_excess,
    Inertia: excess_of_all,
    Symmetric3: excess_of_all,
}
_NUMBERS = (float, np.float64, int)
"""Types of factors and divisors."""


def _direct(kind: type, names: str, *rows: Row) -> None:
    """Has methods or properties of a class, several names of the same, called directly."""
    for name in names.split():
        member: Any = inspect.getattr_static(kind, name)
        if isinstance(member, property):
            made: Any = property(called_directly(member.fget, *rows), member.fset, doc=member.__doc__)
        elif isinstance(member, staticmethod):
            made = staticmethod(called_directly(member.__func__, *rows))
        elif isinstance(member, classmethod):
            made = staticmethod(called_directly(_function_of(getattr(kind, name)), *rows))
        else:
            made = called_directly(member, *rows, is_method=True)
        setattr(kind, name, made)


def _changes(kind: type, names: str, *rows: Row) -> None:
    """Has methods that change and return their instance called directly: their rows make new instances."""
    size = 8 * math.prod(_SHAPES[kind])
    for name in names.split():
        setattr(
            kind,
            name,
            called_directly(inspect.getattr_static(kind, name), *rows, is_method=True, in_place=size),
        )


def _assigned(kind: type, name: str, part: Callable[[Array], Array], reads: bool = True) -> None:
    """Has a property of a class, a part of the array that it holds, assigned, and read, without Python."""
    made: Any = array_property(inspect.getattr_static(kind, name), kind, _SHAPES[kind], part, reads)
    made.__set_name__(kind, name)
    setattr(kind, name, made)


def _function_of(method: Any) -> Any:
    """A function that does what a method of a class does."""

    @functools.wraps(method)
    def called() -> Any:
        return method()

    return called


def _shared(kind: type) -> None:
    """Copies and comparisons."""
    shape, excess = _SHAPES[kind], _EXCESS.get(kind)
    functions: dict[str, tuple[Any, ...]] = {
        "copy": (lambda x: 1.0 * x, shape),
        "equality": (equality, shape, shape),
        "other": (lambda x, y: 1.0 * y, shape, shape),
    }
    if excess is not None:
        functions |= {
            "agreement": (lambda a, b: truth_within(excess(a, b, 1e-12)), shape, shape),
            "agreement within": (lambda a, b, prec: truth_within(excess(a, b, prec)), shape, shape, ()),
        }
    if kind in _NOTHING:
        _, numbers = _NOTHING[kind]
        functions |= {
            "nothing": (lambda x: smallness(numbers(x), 1e-12), shape),
            "nothing within": (lambda x, prec: smallness(numbers(x), prec), shape, ()),
        }
    own = BoundFunctions(functions, holder=kind)
    if kind in _NOTHING:
        within = own.row("nothing within", kind, float, holder=bool)
        _direct(kind, _NOTHING[kind][0], own.row("nothing", kind, holder=bool), within)
    _direct(kind, "__eq__", own.row("equality", kind, kind, holder=bool))
    _changes(kind, "assign" if kind is Quaternion else "_assign", own.row("other", kind, kind))
    if kind is not Quaternion:
        _direct(kind, "copy cast", own.row("copy", kind))
        kind.__copy__ = _copied  # type: ignore[attr-defined]
    if excess is not None:
        within = own.row("agreement within", kind, kind, float, holder=bool)
        _direct(kind, "isApprox", own.row("agreement", kind, kind, holder=bool), within)


def _copied(self: Any) -> Any:
    """A copy."""
    return self.copy()  # `copy.copy` asks the class for its method, which runs Python whatever it is


_copied.__name__ = _copied.__qualname__ = "__copy__"


def _sums(kind: Any) -> None:
    """Sums and differences."""
    for name, sign in (("sum", "add"), ("difference", "sub")):
        row = (BODIES if kind is Inertia else kind._made).row(name, kind, kind)
        _direct(kind, f"__{sign}__", row)
        _changes(kind, f"__i{sign}__", row)


def _placements() -> None:
    moved, back = (
        [table.row(name, SE3, kind) for kind, table in _MOVED.items()] for name in ("moved", "moved back")
    )
    point = SMALL.row("pose point", SE3, np.ndarray)
    point_back = SMALL.row("pose point back", SE3, np.ndarray)
    _direct(SE3, "__mul__ __matmul__ act", PLACEMENTS.row("product", SE3, SE3), point, *moved)
    _direct(SE3, "actInv", PLACEMENTS.row("quotient", SE3, SE3), point_back, *back)
    _assigned(SE3, "rotation", lambda m: m[:3, :3])
    _assigned(SE3, "translation", lambda m: m[:3, 3])
    _direct(SE3, "inverse __invert__", PLACEMENTS.row("inverse", SE3))
    _direct(SE3, "homogeneous np", MATRICES.row("itself", SE3))
    _direct(SE3, "action toActionMatrix", MATRICES.row("action", SE3))
    _direct(SE3, "actionInverse toActionMatrixInverse", MATRICES.row("action back", SE3))
    _direct(SE3, "dualAction toDualActionMatrix", MATRICES.row("dual action", SE3))
    _direct(SE3, "Interpolate", PLACEMENTS.row("interpolation", SE3, SE3, float))
    _direct(SE3, "Random", PLACEMENTS.row("random"))
    _direct(SE3, "Identity", copies_of(np.eye(4), SE3))


_MOVED = {Motion: Motion._made, Force: Force._made, Inertia: BODIES}
"""What moves by a placement, and its functions."""


def _motions_and_forces() -> None:
    for kind, other in ((Motion, Force), (Force, Motion)):
        own = kind._made
        _assigned(kind, "linear", lambda v: v[:3])
        _assigned(kind, "angular", lambda v: v[3:])
        _assigned(kind, "vector", lambda v: v, reads=False)  # which is the array itself
        _sums(kind)
        _direct(kind, "__neg__", own.row("opposite", kind))
        _direct(kind, "__mul__ __rmul__", *[own.row("product", kind, x) for x in _NUMBERS])
        _direct(kind, "__truediv__", *[own.row("quotient", kind, x) for x in _NUMBERS])
        _direct(kind, "se3Action", own.row("moved by", kind, SE3))
        _direct(kind, "se3ActionInverse", own.row("moved back by", kind, SE3))
        _direct(kind, "dot", SMALL.row("power", kind, other, holder=float))
        _direct(kind, "Random", own.row("random"))
        _direct(kind, "Zero", copies_of(np.zeros(6), kind))
    _direct(Motion, "cross __xor__", *[kind._made.row("cross", Motion, kind) for kind in (Motion, Force)])

    _direct(Motion, "action", SMALL.row("motion matrix", Motion))
    _direct(Motion, "homogeneous", SMALL.row("motion homogeneous", Motion))
    _direct(Motion, "dualAction", SMALL.row("motion dual", Motion))


def _inertias() -> None:
    _sums(Inertia)
    _direct(Inertia, "__mul__", FORCES_OF_BODIES.row("momentum", Inertia, Motion))
    _assigned(Inertia, "mass", lambda p: p[0:1].reshape(()))
    _assigned(Inertia, "lever", lambda p: p[1:4])
    _direct(Inertia, "inertia", SMALL.row("moments", Inertia))
    _assigned(Inertia, "inertia", lambda p: p[4:].reshape(3, 3), reads=False)  # which is a copy
    _direct(Inertia, "matrix np", SMALL.row("inertia matrix", Inertia))
    _direct(Inertia, "inverse", SMALL.row("inertia inverse", Inertia))
    _direct(Inertia, "vtiv", SMALL.row("inertia energy", Inertia, Motion, holder=float))
    _direct(Inertia, "toDynamicParameters", SMALL.row("inertia parameters", Inertia))
    of_parameters = SMALL.row("inertia of parameters", np.ndarray, holder=Inertia)
    _direct(Inertia, "FromDynamicParameters", of_parameters)
    for name, solid, count in (
        *(("FromBox", "box", 4), ("FromEllipsoid", "ellipsoid", 4), ("FromSphere", "ball", 2)),
        *(("FromCylinder", "cylinder", 3), ("FromCapsule", "capsule", 3)),
    ):
        _direct(Inertia, name, BODIES.row(solid, *[float] * count))
    _direct(Inertia, "Random", BODIES.row("random"))
    _direct(Inertia, "Zero", copies_of(np.zeros(13), Inertia))
    _direct(Inertia, "Identity", copies_of(Inertia.Identity()._p, Inertia))


def _quaternions() -> None:
    for place, letter in enumerate("xyzw"):
        _assigned(Quaternion, letter, lambda c, place=place: c[place : place + 1].reshape(()))
    product = SMALL.row("quaternion product", Quaternion, Quaternion, holder=Quaternion)
    _direct(Quaternion, "__mul__", product, SMALL.row("quaternion point", Quaternion, np.ndarray))
    _direct(Quaternion, "matrix toRotationMatrix", SMALL.row("quaternion matrix", Quaternion))
    _changes(Quaternion, "__imul__", product)
    _changes(Quaternion, "normalize", SMALL.row("quaternion of length 1", Quaternion, holder=Quaternion))
    _direct(Quaternion, "Identity", copies_of(np.array([0.0, 0.0, 0.0, 1.0]), Quaternion))
    _direct(Quaternion, "_transformVector", SMALL.row("quaternion point", Quaternion, np.ndarray))
    _direct(Quaternion, "norm", SMALL.row("quaternion norm", Quaternion, holder=float))
    _direct(Quaternion, "squaredNorm", SMALL.row("quaternion squared norm", Quaternion, holder=float))
    _direct(Quaternion, "dot", SMALL.row("quaternion dot", Quaternion, Quaternion, holder=float))
    for name, function in (
        ("normalized", "quaternion of length 1"),
        ("inverse", "quaternion inverse"),
        ("conjugate", "quaternion conjugate"),
    ):
        _direct(Quaternion, name, SMALL.row(function, Quaternion, holder=Quaternion))
    _direct(Quaternion, "isApprox", SMALL.row("quaternion agreement", Quaternion, Quaternion, holder=bool))
    _direct(
        Quaternion, "angularDistance", SMALL.row("quaternion angle", Quaternion, Quaternion, holder=float)
    )
    vectors = SMALL.row("quaternion between vectors", np.ndarray, np.ndarray, holder=Quaternion)
    _direct(Quaternion, "FromTwoVectors", vectors)
    own_vectors = SMALL.row(
        "quaternion set between vectors", Quaternion, np.ndarray, np.ndarray, holder=Quaternion
    )
    _changes(Quaternion, "setFromTwoVectors", own_vectors)
    slerp = SMALL.row("quaternion slerp", Quaternion, float, Quaternion, holder=Quaternion)
    _direct(Quaternion, "slerp", slerp)


def _symmetric_matrices() -> None:
    _sums(Symmetric3)
    products = [Symmetric3._made.row("product", Symmetric3, x) for x in _NUMBERS]
    _direct(Symmetric3, "__mul__", *products, SMALL.row("symmetric product", Symmetric3, np.ndarray))
    _changes(Symmetric3, "__imul__", *products)
    _direct(Symmetric3, "__neg__", Symmetric3._made.row("opposite", Symmetric3))
    _direct(Symmetric3, "matrix", SMALL.row("symmetric matrix", Symmetric3))
    _direct(Symmetric3, "rotate", Symmetric3._made.row("rotated", Symmetric3, np.ndarray))
    _direct(Symmetric3, "vtiv", SMALL.row("symmetric square", Symmetric3, np.ndarray, holder=float))
    for name in ("vxs", "svx"):
        row = SMALL.row(f"symmetric {name}", np.ndarray, Symmetric3)
        _direct(Symmetric3, name, row)
    _direct(Symmetric3, "Zero", copies_of(np.zeros(6), Symmetric3))
    _direct(Symmetric3, "Identity", copies_of(Symmetric3.Identity()._d, Symmetric3))


def call_small_objects_directly() -> None:
    """Has what is called often of placements, motions, inertias, quaternions and the like called by machine code."""
    for kind in _SHAPES:
        _shared(kind)
    _placements()
    _motions_and_forces()
    _inertias()
    _quaternions()
    _symmetric_matrices()
