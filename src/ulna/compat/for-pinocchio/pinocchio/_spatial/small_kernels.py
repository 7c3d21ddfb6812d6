"""Compiled functions of small objects: products, sums, actions and random draws of poses, inertias and quaternions.

An inertia is one array (13,): mass, lever, and the moments about the centre of mass row by row.
"""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

from pinocchio._spatial.bound_functions import BoundFunctions
from pinocchio._spatial.random_numbers import Random
from ulna import spatial
from ulna.numeric import cross, less, matrix, maximum, minimum, sincos, skew, sqrt, vector, where
from ulna.typing import Array


def pose(m: Array) -> spatial.SE3:
    """The placement of a homogeneous matrix (4, 4)."""
    return spatial.SE3(m[:3, :3], m[:3, 3])


def body(p: Array) -> spatial.Inertia:
    """The inertia of mass, lever and inertia about it row by row (13,) [kg, m, kg m^2]."""
    xx, yy, zz = p[4], p[8], p[12]
    xy, xz, yz = 0.5 * (p[5] + p[7]), 0.5 * (p[6] + p[10]), 0.5 * (p[9] + p[11])
    moments: Any = matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return spatial.Inertia(p[0], p[1:4], moments)


def _numbers(inertia: spatial.Inertia) -> Array:
    return np.concatenate([[inertia.mass], inertia.com, np.reshape(inertia.inertia, 9)])


def as_motion(v: Array) -> spatial.Motion:
    """The motion of six numbers, linear part first."""
    return spatial.Motion(v[:3], v[3:])


def as_force(v: Array) -> spatial.Force:
    """The force of six numbers, linear part first."""
    return spatial.Force(v[:3], v[3:])


def _dual(v: Array) -> Array:
    return -as_motion(v).cross_matrix().T


def _homogeneous(v: Array) -> Array:
    top = np.concatenate([skew(v[3:]), v[:3, None]], axis=1)
    return np.concatenate([top, np.zeros((1, 4))])


def _lever(first_moment: Array, mass: Any) -> Array:
    """The centre of mass, the origin where there is no mass."""
    divisor = where(less(0.0, mass * mass), mass, 1.0)
    return vector(*(x / divisor for x in first_moment))


def _sum(p: Array, o: Array) -> Array:
    a, b = body(p), body(o)
    mass = a.mass + b.mass
    divisor = where(less(0.0, mass * mass), mass, 1.0)
    way, share = b.com - a.com, b.mass / divisor
    com = vector(*((a.mass / divisor) * x + share * y for x, y in zip(a.com, b.com, strict=True)))
    return _numbers(spatial.Inertia(mass, com, a.inertia + b.inertia + (a.mass * share) * spread(way)))


def symmetric(d: Array) -> Array:
    """The symmetric matrix (3, 3) of xx, xy, yy, xz, yz, zz, (6,)."""
    xx, xy, yy, xz, yz, zz = d
    return matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def rotated(d: Array, R: Array) -> Array:
    """R S R^T of a symmetric matrix S.

    Args:
        d: The matrix as xx, xy, yy, xz, yz, zz, (6,).
        R: Matrix (3, 3).

    Returns:
        The product (6,), as `d`.
    """
    turned = R @ symmetric(d) @ R.T
    return np.stack([turned[i, j] for i, j in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))])


def spread(d: Array) -> Array:
    """|d|^2 I - d d^T: the moments of a unit mass at d."""
    x, y, z = d
    return matrix(
        [[y * y + z * z, -x * y, -x * z], [-x * y, x * x + z * z, -y * z], [-x * z, -y * z, x * x + y * y]]
    )


def _difference(p: Array, o: Array) -> Array:
    return inertia_of_parameters(body(p).parameters() - body(o).parameters())


def inertia_of_parameters(d: Array) -> Array:
    """The inertia (13,) of m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin, (10,) [kg, kg m, kg m^2]."""
    mass, (xx, xy, yy, xz, yz, zz) = d[0], d[4:]
    com = _lever(d[1:4], mass)
    about_origin: Any = matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return _numbers(spatial.Inertia(mass, com, about_origin - mass * spread(com)))


def _inverse(p: Array) -> Array:
    """The inverse of the 6x6 inertia; see Featherstone, eq. (2.74)."""
    own = body(p)
    (a, b, c), (_, d, e), (_, _, f) = own.inertia
    cofactors = [d * f - e * e, c * e - b * f, b * e - c * d, a * f - c * c, b * c - a * e, a * d - b * b]
    det = a * cofactors[0] + b * cofactors[1] + c * cofactors[2]
    xx, xy, xz, yy, yz, zz = (x / det for x in cofactors)
    turn: Any = matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    lever: Any = skew(own.com)
    corner = np.eye(3) / own.mass - lever @ turn @ lever
    return np.concatenate(
        [np.concatenate([corner, lever @ turn], axis=1), np.concatenate([-turn @ lever, turn], axis=1)]
    )


def _centred(mass: Any, x: Any, y: Any, z: Any) -> Array:
    """A body about its centre, with these squared radii of gyration [m^2]."""
    return vector(mass, 0.0, 0.0, 0.0, mass * x, 0.0, 0.0, 0.0, mass * y, 0.0, 0.0, 0.0, mass * z)


_LARGEST = 1e150
"""Above it, squares may overflow, which is for Python to say."""


def _none_is_large(*lengths: Any) -> Any:
    return reduce(minimum, (where(less(x * x, _LARGEST * _LARGEST), 1.0, 0.0) for x in lengths))


def _none_is_negative(*values: Any) -> Any:
    return reduce(minimum, (where(less(x, 0.0), 0.0, where(less(x, _LARGEST), 1.0, 0.0)) for x in values))


def _box(mass: Any, x: Any, y: Any, z: Any) -> tuple[Array, Any]:
    a, b, c = (length * length / 12 for length in (x, y, z))
    return _centred(mass, b + c, a + c, a + b), _none_is_large(x, y, z)


def _ellipsoid(mass: Any, x: Any, y: Any, z: Any) -> tuple[Array, Any]:
    a, b, c = (length * length / 5 for length in (x, y, z))
    return _centred(mass, b + c, a + c, a + b), _none_is_large(x, y, z)


def _ball(mass: Any, radius: Any) -> tuple[Array, Any]:
    squared = 0.4 * (radius * radius)
    return _centred(mass, squared, squared, squared), _none_is_large(radius)


def _cylinder(mass: Any, radius: Any, length: Any) -> tuple[Array, Any]:
    across = radius * radius / 4 + length * length / 12
    return _centred(mass, across, across, radius * radius / 2), _none_is_negative(mass, radius, length)


def _capsule(mass: Any, radius: Any, length: Any) -> tuple[Array, Any]:
    """See `spatial.Inertia.from_capsule`."""
    whole = length + 4 * radius / 3  # volume over pi radius^2
    share, squared = length / whole, radius * radius
    half_sphere = 2 * squared / 5 + length * length / 4 + 3 * length * radius / 8
    across = share * (squared / 4 + length * length / 12) + (1 - share) * half_sphere
    along = share * squared / 2 + (1 - share) * 2 * squared / 5
    is_usual = where(less(0.0, whole), _none_is_negative(mass, radius, length), 0.0)
    return _centred(mass, across, across, along), is_usual


def _classic(v: Array, a: Array) -> Array:
    return a[:3] + cross(v[3:], v[:3])


def _classic_at(v: Array, a: Array, m: Array) -> Array:
    there = pose(m)
    return _classic(there.act_inverse(as_motion(v)).vector(), there.act_inverse(as_motion(a)).vector())


def between(u: Array, v: Array) -> tuple[Array, Any]:
    """The quaternion of the least rotation that turns the direction of u into that of v.

    Of unit vectors a, b at an angle t it is (a x b, |a + b|^2 / 2) / |a + b|, for |a + b| = 2 cos(t/2).

    Args:
        u: Vector (3,), in any unit [-].
        v: Vector (3,), in any unit [-].

    Returns:
        Quaternion (4,) [-], and a number above zero unless they point away from each other, or one of them is zero.
    """
    a, b = u / _norm(u), v / _norm(v)
    both = a + b
    length = _norm(both)
    raw = np.concatenate([cross(a, b - a), [0.5 * length * length]])  # exact where they are the same
    return raw / _norm(raw), length - 1e-7


def _random_rotation(even: Array) -> Array:
    """Even on SO(3), of three even numbers [Shoemake 1992, Uniform random rotations, Graphics Gems III]."""
    long, short = sqrt(1.0 - even[0]), sqrt(even[0])
    (s, c), (t, d) = (sincos(2.0 * np.pi * x) for x in (even[1], even[2]))
    return spatial.quat_xyzw_to_matrix(vector(long * s, long * c, short * t, short * d))


def random_pose(even: Array) -> Array:
    """A placement drawn at random, (4, 4), by even numbers (6,): of its rotation, then of its place [m]."""
    return spatial.SE3(_random_rotation(even[:3]), 2.0 * even[3:] - 1.0).matrix()


def _random_inertia(draws: Array) -> Array:
    """Of even numbers (10,): mass, centre, and the factor L of the second moments (m/12) L L^T, which any body has."""
    mass, com = 0.1 + 0.9 * draws[0], 2.0 * draws[1:4] - 1.0
    a, c, f = (0.1 + 0.9 * x for x in draws[4:7])
    b, d, e = (x - 0.5 for x in draws[7:])
    xx, xy, xz, yy, yz, zz = a * a, a * b, a * d, b * b + c * c, b * d + c * e, d * d + e * e + f * f
    moments: Any = matrix([[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]])
    return _numbers(spatial.Inertia(mass, com, (mass / 12.0) * moments))


def _norm(x: Array) -> Any:
    return sqrt(sum((y * y for y in x), 0.0))


def _excess(pairs: list[tuple[Array, Array]], prec: Any) -> Any:
    """By how much pairs differ by more than a part `prec` of the smaller norm; at most zero where they are alike."""
    return reduce(maximum, (_norm(a - b) - prec * minimum(_norm(a), _norm(b)) for a, b in pairs))


def six_excess(a: Array, b: Array, prec: Any) -> Any:
    """By how much linear or angular parts differ by more than a part of the smaller norm.

    Args:
        a: Motion or force (6,).
        b: Another one (6,).
        prec: The part [-].

    Returns:
        The larger excess, at most zero where both agree.
    """
    return _excess([(a[:3], b[:3]), (a[3:], b[3:])], prec)


def pose_excess(a: Array, b: Array, prec: Any) -> Any:
    """By how much rotations or translations differ by more than a part of the smaller norm.

    Args:
        a: Placement (4, 4).
        b: Another one (4, 4).
        prec: The part [-].

    Returns:
        The larger excess, at most zero where both agree.
    """
    return _excess([(a[:3, :3].reshape(9), b[:3, :3].reshape(9)), (a[:3, 3], b[:3, 3])], prec)


def truth_within(excess: Any) -> Any:
    """1 where it is at most zero, 0 where it is above; nan, which no truth is made of, where it is not finite."""
    return where(less(excess, _LEAST), 1.0, where(less(excess, _MOST), 0.0, np.nan))


_LEAST, _MOST = 5e-324, 1e308


def finite(x: Array) -> Any:
    """Above zero where all entries of an array are finite, and not too large to be added up."""
    total: Any = reduce(lambda a, b: a + b, [abs(entry) for entry in x.reshape(-1)])
    return where(less(total, _MOST), 1.0, 0.0)


def equality(a: Array, b: Array) -> Any:
    """Whether all entries are equal.

    Args:
        a: Numbers (...).
        b: As many numbers (...).

    Returns:
        See `truth_within`.
    """
    gaps = (x - y for x, y in zip(a.reshape(-1), b.reshape(-1), strict=True))
    return truth_within(sum((where(less(gap, 0.0), -gap, gap) for gap in gaps), 0.0))


def smallness(x: Array, prec: Any) -> Any:
    """Whether no entry is larger than a bound.

    Args:
        x: Numbers (...).
        prec: The bound [any].

    Returns:
        See `truth_within`.
    """
    sizes = (where(less(y, 0.0), -y, y) for y in x.reshape(-1))
    # a difference that is nan, where one of both is, is no truth
    larger = (where(less(y, prec), 0.0, where(less(prec, y), 1.0, y - prec)) for y in sizes)
    return truth_within(sum(larger, 0.0))


def excess_of_all(p: Array, o: Array, prec: Any) -> Any:
    """By how much all numbers together differ by more than a part of their norm, or of 1 where that is less.

    Args:
        p: Numbers (n,), such as those of an inertia.
        o: As many (n,).
        prec: The part [-].

    Returns:
        The excess, at most zero where both agree.
    """
    return _norm(p - o) - prec * maximum(1.0, _norm(p))


def _angle(a: Array, b: Array) -> Array:
    return _norm(spatial.quat_log(spatial.quat_multiply(spatial.quat_conjugate(a), b)))


_M, _P, _V, _Q, _X = (4, 4), (13,), (6,), (4,), (3,)
INERTIAS: dict[str, tuple[Any, ...]] = {
    "sum": (_sum, _P, _P),
    "difference": (_difference, _P, _P),
    "moved": (lambda m, p: _numbers(pose(m).act(body(p))), _M, _P),
    "moved back": (lambda m, p: _numbers(pose(m).act_inverse(body(p))), _M, _P),
    "random": Random(_random_inertia, even=10),
    "box": (_box, (), (), (), ()),
    "ellipsoid": (_ellipsoid, (), (), (), ()),
    "ball": (_ball, (), ()),
    "cylinder": (_cylinder, (), (), ()),
    "capsule": (_capsule, (), (), ()),
}
"""What makes inertias."""
FORCES: dict[str, tuple[Any, ...]] = {
    "momentum": (lambda p, v: body(p).apply(as_motion(v)).vector(), _P, _V),
    "rate": (lambda p, v: as_motion(v).cross(body(p).apply(as_motion(v))).vector(), _P, _V),
}
"""What makes forces of an inertia and a velocity."""
_FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "pose point": (lambda m, x: m[:3, :3] @ x + m[:3, 3], _M, _X),
    "pose point back": (lambda m, x: m[:3, :3].T @ (x - m[:3, 3]), _M, _X),
    "pose excess": (pose_excess, _M, _M, ()),
    "excess": (six_excess, _V, _V, ()),
    "motion matrix": (lambda v: as_motion(v).cross_matrix(), _V),
    "motion homogeneous": (_homogeneous, _V),
    "motion dual": (_dual, _V),
    "inertia matrix": (lambda p: body(p).matrix(), _P),
    "inertia inverse": (_inverse, _P),
    "inertia energy": (lambda p, v: as_motion(v).dot(body(p).apply(as_motion(v))), _P, _V),
    "inertia v x I": (lambda p, v: _dual(v) @ body(p).matrix(), _P, _V),
    "inertia I v x": (lambda p, v: body(p).matrix() @ as_motion(v).cross_matrix(), _P, _V),
    "inertia rate": (
        lambda p, v: _dual(v) @ body(p).matrix() - body(p).matrix() @ as_motion(v).cross_matrix(),
        _P,
        _V,
    ),
    "inertia parameters": (lambda p: body(p).parameters(), _P),
    "inertia of parameters": (inertia_of_parameters, (10,)),
    "quaternion product": (spatial.quat_multiply, _Q, _Q),
    "quaternion point": (lambda q, x: spatial.quat_xyzw_to_matrix(q) @ x, _Q, _X),
    "quaternion matrix": (spatial.quat_xyzw_to_matrix, _Q),
    "quaternion between": (spatial.quat_slerp, _Q, _Q, ()),
    "quaternion slerp": (lambda q, t, r: spatial.quat_slerp(q, r, t), _Q, (), _Q),
    "quaternion angle": (_angle, _Q, _Q),
    "quaternion norm": (_norm, _Q),
    "quaternion squared norm": (lambda q: q @ q, _Q),
    "quaternion of length 1": (lambda q: q / _norm(q), _Q),
    "quaternion inverse": (lambda q: spatial.quat_conjugate(q) / (q @ q), _Q),
    "quaternion conjugate": (spatial.quat_conjugate, _Q),
    "quaternion dot": (lambda q, r: q @ r, _Q, _Q),
    "quaternion agreement": (lambda q, r: truth_within(_norm(q - r) - 1e-12), _Q, _Q),
    "quaternion between vectors": (between, _X, _X),
    "quaternion set between vectors": (lambda q, u, v: between(u, v), _Q, _X, _X),
    "classic acceleration": (_classic, _V, _V),
    "classic acceleration at a placement": (_classic_at, _V, _V, _M),
    "power": (lambda v, f: v @ f, _V, _V),
    "mass": (lambda p: 1.0 * p[0], _P),
    "moments": (lambda p: 1.0 * p[4:].reshape(3, 3), _P),
    "turn": (spatial.angle_axis_to_matrix, (), _X),
    "symmetric matrix": (symmetric, _V),
    "symmetric product": (lambda d, x: symmetric(d) @ x, _V, _X),
    "symmetric vxs": (lambda v, d: skew(v) @ symmetric(d), _X, _V),
    "symmetric svx": (lambda v, d: symmetric(d) @ skew(v), _X, _V),
    "symmetric square": (lambda d, x: x @ (symmetric(d) @ x), _V, _X),
}
SIX_NUMBERS: dict[str, tuple[Any, ...]] = {
    "sum": (lambda v, w: v + w, _V, _V),
    "difference": (lambda v, w: v - w, _V, _V),
    "opposite": (lambda v: -v, _V),
    "product": (lambda v, x: x * v, _V, ()),
    "quotient": (lambda v, x: v / x, _V, ()),
}
"""What makes six numbers of others, as motions, forces and symmetric matrices have."""


SMALL = BoundFunctions(_FUNCTIONS)
small_kernel = SMALL.kernel
"""The compiled function of a name."""
