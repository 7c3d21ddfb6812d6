"""Checks of masses and inertias: missing, impossible, or far off for the size of the body.

| symbol | meaning | unit | equation |
|---|---|---|---|
| a <= b <= c | principal moments of inertia about the centre of mass | kg m^2 | c <= a + b for every body |
| R | greatest distance of the body's geometry from its centre of mass | m | c <= m R^2 where the mass is inside |

Source: Wensing, Kim & Slotine, Linear matrix inequalities for physically consistent inertial parameter identification
(2018).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ulna.diagnosis.finding import Finding
from ulna.model import Model
from ulna.model.parts import Link
from ulna.typing import Floats

_TRIANGLE_TOLERANCE = 0.01
"""How far the triangle inequality may be missed by rounded numbers, relative to the largest moment."""

_LARGE, _SMALL = 2.0, 1e-3
"""Beyond these multiples of m R^2 the largest moment is not that of a body of this size."""


def body_findings(model: Model, points: Mapping[str, Floats]) -> Iterator[Finding]:
    """What looks wrong with the masses and inertias of a model.

    Args:
        model: The model.
        points: For names of links, points that its geometry lies within, (n, 3) in the link's frame [m].

    Yields:
        A finding for each of them.
    """
    for link in model.links:
        if link.joint >= 0:
            yield from _link(link, points.get(link.name))
    for index, joint in enumerate(model.joints):
        if joint.kind.nv == 0:
            continue
        if _moved_mass(model, index) > 0.0:
            yield from _body_without_mass(model, index, points)
        elif all(armature == 0.0 for armature in joint.armature):
            yield Finding(
                "warning",
                "no-mass",
                f"joint {joint.name!r}",
                "it moves no mass at all, so its acceleration under a torque has no value",
                "Give a link that it moves an <inertial>, make the joint fixed, or give it an armature.",
            )


def _moved_mass(model: Model, index: int) -> float:
    return float(sum(float(model.inertias[i].mass) for i in model.subtree(index)))


def _body_without_mass(model: Model, index: int, points: Mapping[str, Floats]) -> Iterator[Finding]:
    """A link that a joint moves, that has shapes, and of which neither it nor what is fixed to it has a mass."""
    if float(model.inertias[index].mass) > 0.0:
        return
    shaped = [link.name for link in model.links if link.joint == index and len(points.get(link.name, ()))]
    if shaped:
        yield Finding(
            "warning",
            "shape-without-mass",
            f"link {shaped[0]!r}",
            "it has shapes and no mass, as if it weighed nothing",
            "Give it an <inertial>; ulna.diagnosis.shape_inertias computes that of its shapes for a density.",
        )


def _link(link: Link, points: Floats | None) -> Iterator[Finding]:
    name = f"link {link.name!r}"
    mass, tensor = float(link.inertia.mass), np.asarray(link.inertia.inertia, dtype=float)
    moments = np.linalg.eigvalsh(tensor)
    a, b, c = (float(x) for x in moments)
    shown = f"principal moments {a:.4g}, {b:.4g}, {c:.4g} kg m^2"
    if mass == 0.0:
        if c > 0.0:
            yield Finding(
                "warning",
                "inertia-without-mass",
                name,
                f"it has an inertia ({shown}) and no mass",
                "Give it its mass, or leave the inertia out.",
            )
        return
    if not tensor.any():
        yield Finding(
            "warning",
            "mass-without-inertia",
            name,
            _with_box(f"it has a mass of {mass:g} kg and no rotational inertia: a point", mass, points),
            "Give it the inertia of its shape; ulna.Inertia.from_box and the like compute it.",
        )
        return
    for finding in _moments(name, a, b, c, shown):
        yield replace(finding, message=_with_box(finding.message, mass, points))
    if points is not None and len(points):
        yield from _size(name, mass, c, np.asarray(link.inertia.com, dtype=float), points)


def _with_box(message: str, mass: float, points: Floats | None) -> str:
    """The message with numbers to begin with: the inertia of a solid box as large as the link's geometry."""
    if points is None or not len(points):
        return message
    edges = np.ptp(points, axis=0)
    x, y, z = mass / 12.0 * (edges @ edges - edges**2)
    size = " x ".join(f"{edge:.3g}" for edge in edges)
    return f'{message}. A solid box of its mass and size, {size} m, has ixx="{x:.3g}" iyy="{y:.3g}" izz="{z:.3g}"'


def _moments(name: str, a: float, b: float, c: float, shown: str) -> Iterator[Finding]:
    if a < -1e-9 * max(abs(a), abs(c)):
        yield Finding(
            "error",
            "not-positive",
            name,
            f"its inertia is not positive definite: {shown}",
            "No body has a negative moment of inertia; look at the signs of ixy, ixz, iyz.",
        )
    elif c > a + b + _TRIANGLE_TOLERANCE * c:
        yield Finding(
            "error",
            "triangle-inequality",
            name,
            f"its inertia violates the triangle inequality: {shown}, and {c:.4g} > {a:.4g} + {b:.4g}",
            "No distribution of mass has it; ulna info FILE --repair NEW.urdf writes the nearest possible one, "
            "and with --from-shapes LINK that of its shapes.",
        )


def _size(name: str, mass: float, moment: float, com: Floats, points: Floats) -> Iterator[Finding]:
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.linalg.norm(high - low))
    outside = float(np.linalg.norm(np.maximum(np.maximum(low - com, com - high), 0.0)))
    radius = float(np.linalg.norm(points - com, axis=1).max())
    if outside > size:
        yield Finding(
            "warning",
            "com-outside",
            name,
            f"its centre of mass is {outside:.3g} m outside its geometry, which is {size:.3g} m large",
            "Look at the units and the frame of <inertial><origin>.",
        )
        return
    most = mass * radius**2
    if moment > _LARGE * most > 0.0:
        yield Finding(
            "warning",
            "inertia-large",
            name,
            _with_box(
                f"its largest moment of inertia, {moment:.3g} kg m^2, is {moment / most:.3g} times m R^2, the most "
                f"that {mass:.3g} kg within {radius:.3g} m can have",
                mass,
                points,
            ),
            "Look at the units: kg m^2, not kg mm^2 or g cm^2.",
        )
    elif moment < _SMALL * most:
        yield Finding(
            "note",
            "inertia-small",
            name,
            f"its largest moment of inertia, {moment:.3g} kg m^2, is {moment / most:.1g} times m R^2, as if "
            f"{mass:.3g} kg within {radius:.3g} m were nearly a point",
            "Look at the units: kg m^2.",
        )
