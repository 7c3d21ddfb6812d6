"""Inverse kinematics in closed form of six turning joints of which three neighbours meet in a point or are parallel.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| G | the goal as a motion: E_1 ... E_6 = G | SE3 | Murray, Li & Sastry 1994, 3.3 |
| W | the motion of the three special joints | SE3 | Pieper 1968 |
| X Y Z | the motions of the others, cyclically: W X Y Z = G; those before W have their axes carried by G^-1 | SE3 | |
| E_a E_b E_c | X Y Z, or its inverse with the axes reversed | | |
| source, target | what W leaves alone, seen through G: E_a E_b E_c carries one to the other | | |
| u, k | b turns u(c), which swings about c, so that h_a.R_b u = k1 and (p_b - p_a).R_b u = k2(c) | (3,), 1 | below |

If the axes of W meet in a point p, then W^-1 p = p: X Y Z carries the point G^-1 p to p. If they are parallel, W maps
planes across them to themselves: X Y Z carries the plane through the origin with normal R_G^T h to that with normal h
at the height h.t_G. What turning about a cannot change, the height along a and the distance from it, of a point, or the
inclination to a and the distance from a's origin, of a plane, gives two equations in c and b:

    point   x = E_b E_c s, u = E_c s - p_b:   h_a.R_b u = h_a.(t - p_b)
            (p_b - p_a).R_b u = (|t - p_a|^2 - |p_b - p_a|^2 - |u|^2) / 2
    plane   n = R_b R_c g, u = R_c g:         h_a.R_b u = h_a.n_t
            (p_b - p_a).R_b u = d_t - n_t.p_a - d_s + g.p_c - u.(p_c - p_b)

If a and b are parallel, the first is free of b; if they meet, the second is; else they give R_b u across b, whose
length is that of u: a quartic in c. Then a follows, and what is left is for W: a rotation, or a motion in a plane.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ulna.ik.analytic.geometry import ArmGeometry, Pair, loop_order, meeting_point
from ulna.ik.analytic.lines import Line, across, nearest_points, perpendicular, swing, turn, turn_about
from ulna.ik.analytic.subproblems import Affine, angle_between, four_angles, square, two_angles
from ulna.numeric import cross, dot, vector
from ulna.spatial import SE3
from ulna.typing import Array


class _Point(NamedTuple):
    at: Array


class _Plane(NamedTuple):
    normal: Array
    height: Any


class _Equations(NamedTuple):
    """h_a.R_b u = k1, (p_b - p_a).R_b u = k2(c)."""

    u: Affine
    k1: Any
    k2: Affine


def solve(geometry: ArmGeometry, lines: list[Line], G: SE3, branch: Array, near: Array) -> Array:
    """The angles (6,) of one branch; far from the goal where that branch has no solution.

    Args:
        geometry: The relations of its axes.
        lines: The six axes, with all angles at 0.
        G: The motion to make.
        branch: Which solutions to take, (3,): numbers from 0, below `geometry.solution_counts`.
        near: Angles (6,) to take where any would do.

    Returns:
        Angles (6,) [rad].
    """
    W = lines[geometry.first : geometry.first + 3]
    back = G.inverse()
    order = loop_order(geometry.first)
    others = [lines[i] if i > geometry.first else lines[i].moved(back) for i in order]
    centre, source, target = _invariants(geometry, W, G, back)
    if geometry.reverse:
        others = [line.reversed() for line in others[::-1]]
        order = order[::-1]
        source, target = target, source
    angles = _three_others(geometry.pair, others, source, target, branch, [near[i] for i in order])
    motion = SE3.identity()
    for line, angle in zip(others, angles, strict=True):
        motion = motion @ turn_about(line, angle)
    remaining = G @ motion if geometry.reverse else G @ motion.inverse()
    sign, nearby = 1.0 - 2.0 * branch[2], near[geometry.first : geometry.first + 3]
    if geometry.triple == "spherical":
        wrist = _rotation(W, remaining.rotation, sign, nearby)
    else:
        wrist = _planar(W, centre, remaining, sign, nearby)
    q: list[Any] = [None] * 6
    for i, angle in zip([*order, *range(geometry.first, geometry.first + 3)], [*angles, *wrist], strict=True):
        q[i] = angle
    return vector(*q)


def _invariants(geometry: ArmGeometry, W: list[Line], G: SE3, back: SE3) -> tuple[Array, Any, Any]:
    if geometry.triple == "spherical":
        p = _meeting(W[0], W[1]) if geometry.free is not None else meeting_point(W)
        return p, _Point(back @ p), _Point(p)
    h = W[0].direction
    return W[0].point, _Plane(G.rotation.T @ h, 0.0), _Plane(h, dot(h, G.translation))


def _meeting(a: Line, b: Line) -> Array:
    on_a, on_b = nearest_points(a, b)
    return 0.5 * (on_a + on_b)


def _three_others(
    pair: Pair, lines: list[Line], source: Any, target: Any, branch: Array, near: list[Any]
) -> list[Any]:
    """The angles of a, b, c that carry the source to the target."""
    a, b, c = lines
    if pair == "intersecting":
        p = _meeting(a, b)
        a, b = Line(a.direction, p), Line(b.direction, p)
    elif pair == "general":
        on_a, on_b = nearest_points(a, b)
        a, b = Line(a.direction, on_a), Line(b.direction, on_b)
    c = Line(c.direction, c.point + c.direction * dot(c.direction, b.point - c.point))
    is_point = isinstance(source, _Point)
    equations = _of_point(a, b, c, source, target) if is_point else _of_plane(a, b, c, source, target)
    if pair == "general":
        angle_c, angle_b = _by_quartic(a, b, equations, branch[0], near)
    else:
        angle_c, angle_b = _one_by_one(pair, a, b, equations, branch, near)
    R_b = turn(b.direction, angle_b)
    R_c = turn(c.direction, angle_c)
    if is_point:
        x = b.point + R_b @ (c.point + R_c @ (source.at - c.point) - b.point)
        angle_a = angle_between(a.direction, x - a.point, target.at - a.point, near[0])
    else:
        angle_a = angle_between(a.direction, R_b @ (R_c @ source.normal), target.normal, near[0])
    return [angle_a, angle_b, angle_c]


def _of_point(a: Line, b: Line, c: Line, source: _Point, target: _Point) -> _Equations:
    arm, offset, reach = source.at - c.point, c.point - b.point, target.at - a.point
    still, cosine, sine = swing(c.direction, arm)
    between = b.point - a.point
    k = 0.5 * (dot(reach, reach) - dot(between, between) - dot(offset, offset) - dot(arm, arm))
    k2 = (k - dot(offset, still), -dot(offset, cosine), -dot(offset, sine))
    return _Equations((offset + still, cosine, sine), dot(a.direction, target.at - b.point), k2)


def _of_plane(a: Line, b: Line, c: Line, source: _Plane, target: _Plane) -> _Equations:
    still, cosine, sine = swing(c.direction, source.normal)
    offset = c.point - b.point
    k = target.height - dot(target.normal, a.point) - source.height + dot(source.normal, c.point)
    k2 = (k - dot(offset, still), -dot(offset, cosine), -dot(offset, sine))
    return _Equations((still, cosine, sine), dot(a.direction, target.normal), k2)


def _one_by_one(
    pair: Pair, a: Line, b: Line, equations: _Equations, branch: Array, near: list[Any]
) -> tuple[Any, Any]:
    """c from the equation that is free of b, then b from the other."""
    u, k1, k2 = equations
    first, second = 1.0 - 2.0 * branch[0], 1.0 - 2.0 * branch[1]
    if pair == "parallel":
        free = tuple(dot(a.direction, part) for part in u)
        angle_c = two_angles(free[1], free[2], k1 - free[0], first, near[2])
    else:
        angle_c = two_angles(k2[1], k2[2], -k2[0], first, near[2])
    cosine, sine = np.cos(angle_c), np.sin(angle_c)
    at = u[0] + u[1] * cosine + u[2] * sine
    if pair == "parallel":
        w, k = b.point - a.point, k2[0] + k2[1] * cosine + k2[2] * sine
    else:
        w, k = a.direction, k1
    still, with_cosine, with_sine = swing(b.direction, at)
    return angle_c, two_angles(dot(w, with_cosine), dot(w, with_sine), k - dot(w, still), second, near[1])


def _by_quartic(a: Line, b: Line, equations: _Equations, number: Any, near: list[Any]) -> tuple[Any, Any]:
    """c from the length of u across b, then b; p_b - p_a is perpendicular to a and b."""
    u, k1, k2 = equations
    between = b.point - a.point
    rho = dot(a.direction, b.direction)
    inclined, apart = 1.0 - rho * rho, dot(between, between)
    along: Affine = tuple(dot(b.direction, part) for part in u)  # type: ignore[assignment]
    x: Affine = (k1 - rho * along[0], -rho * along[1], -rho * along[2])
    length = square(u) - square(along)
    angle_c = four_angles(apart * square(x) + inclined * square(k2) - inclined * apart * length, number)
    cosine, sine = np.cos(angle_c), np.sin(angle_c)
    at = u[0] + u[1] * cosine + u[2] * sine
    goal = across(a.direction, b.direction) * ((x[0] + x[1] * cosine + x[2] * sine) / inclined)
    goal = goal + between * ((k2[0] + k2[1] * cosine + k2[2] * sine) / apart)
    return angle_c, angle_between(b.direction, at, goal, near[1])


def _rotation(W: list[Line], R: Array, sign: Any, near: Array) -> list[Any]:
    """Three angles about the axes of W that make the rotation R."""
    d, e, f = (line.direction for line in W)
    still, cosine, sine = swing(e, f)
    goal = R @ f
    angle_e = two_angles(dot(d, cosine), dot(d, sine), dot(d, goal) - dot(d, still), sign, near[1])
    R_e = turn(e, angle_e)
    angle_d = angle_between(d, R_e @ f, goal, near[0])
    x = perpendicular(f)
    return [angle_d, angle_e, angle_between(f, x, R_e.T @ (turn(d, angle_d).T @ (R @ x)), near[2])]


def _planar(W: list[Line], origin: Array, motion: SE3, sign: Any, near: Array) -> list[Any]:
    """Three angles about parallel axes that make a motion across them."""
    h = W[0].direction
    signs = [dot(h, line.direction) for line in W]  # 1, or -1 for an axis that points the other way
    d, e, f = (across(line.point - origin, h) for line in W)
    reach = across((motion @ W[2].point) - origin, h) - d
    between, arm = e - d, f - e
    k = 0.5 * (dot(reach, reach) - dot(between, between) - dot(arm, arm))
    angle_e = two_angles(dot(between, arm), dot(between, cross(h, arm)), k, sign, signs[1] * near[1])
    angle_d = angle_between(h, between + turn(h, angle_e) @ arm, reach, near[0])
    x = perpendicular(h)
    angle_f = angle_between(h, x, motion.rotation @ x, near[2]) - angle_d - angle_e
    return [angle_d, signs[1] * angle_e, signs[2] * angle_f]
