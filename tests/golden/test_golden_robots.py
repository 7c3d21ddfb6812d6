"""The robots that are written down in this package, as text."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from ulna.geometry import Geometry
from ulna.model import Model
from ulna.robots.catalogue import build_bundled
from ulna.spatial import SE3


def _numbers(values: object) -> str:
    """Numbers with nine digits, which every platform computes alike; no -0."""
    return " ".join(f"{x:.9g}" for x in np.round(np.ravel(np.asarray(values, dtype=float)), 12) + 0.0)


def _pose(pose: SE3) -> str:
    return f"at {_numbers(pose.translation)} turned {_numbers(pose.rotation)}"


def _shape(geometry: Geometry) -> str:
    fields = {name: value for name, value in vars(geometry.shape).items() if name[0] != "_"}
    sizes = ", ".join(f"{name} {_numbers(value)}" for name, value in sorted(fields.items()))
    colour = "" if geometry.material is None else f" colour {_numbers(geometry.material.rgba)}"
    return f"{geometry.name}: {type(geometry.shape).__name__} {sizes} {_pose(geometry.placement)}{colour}"


def _rows(model: Model) -> Iterator[str]:
    yield f"{model.name}: tool {model.tool}, gravity {_numbers(model.gravity)}"
    for joint in model.joints:
        yield f"joint {joint.name}: {joint.kind.describe()} on {joint.parent} {_pose(joint.placement)} mimic {joint.mimic}"
        limits = joint.limits
        yield "  " + "; ".join(map(_numbers, (limits.lower, limits.upper, limits.velocity, limits.effort)))
        yield "  " + "; ".join(map(_numbers, (joint.damping, joint.friction, joint.armature)))
    for link in model.links:
        yield f"link {link.name}: on {link.parent} by {link.parent_joint} {_pose(link.origin)}"
        yield f"  {_numbers(link.inertia.parameters())}"
        yield from (
            f"  {kind} {_shape(g)}" for kind in ("visuals", "collisions") for g in getattr(link, kind)
        )
    yield from (f"frame {frame.name}: on {frame.joint} {_pose(frame.placement)}" for frame in model.frames)
    yield from (f"configuration {name}: {_numbers(q)}" for name, q in model.configurations.items())
    yield from (f"disabled {' '.join(sorted(pair))}" for pair in sorted(map(sorted, model.disabled_pairs)))
    yield from (f"group {name}: {group}" for name, group in model.groups.items())


@pytest.mark.parametrize("name", ["panda", "panda_fingers", "ur5"])
def test_robots_that_are_written_down(golden, name):
    golden(f"{name}.txt", "\n".join(_rows(build_bundled(name, visuals="simple"))) + "\n")
