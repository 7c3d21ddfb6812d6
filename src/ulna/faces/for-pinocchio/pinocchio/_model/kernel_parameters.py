"""Kernels that take numbers of a model as inputs, for models whose numbers change again and again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, final

import numpy as np

from ulna import spatial
from ulna.model import Model as TowerModel
from ulna.model.inertial import told_of_drives
from ulna.numeric import matrix
from ulna.typing import Array, Floats

NAMES = ("placements", "inertias", "gravity", "armature")
"""The numbers of a model that kernels depend on, besides those of frames."""


@final
class Told:
    """A kernel whose last inputs are numbers of a model, told once: called, and bound, with the others."""

    def __init__(self, kernel: Any, numbers: tuple[Floats, ...]) -> None:
        self.kernel, self.numbers = kernel, numbers
        self.function = kernel.function

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Evaluates the kernel."""
        return self.kernel(*args, *self.numbers, **options)

    def into(self, *targets: Floats, given: Sequence[Floats] = (), **options: Any) -> Any:
        """The kernel bound to arrays; see `KernelBase.into`."""
        return self.kernel.into(*targets, given=(*given, *self.numbers), **options)


def unread(kernel: Any, watch: list[tuple[Array, Array]]) -> list[tuple[Array, Array]]:
    """Of what is watched, what a kernel does not read at every call."""
    read = kernel.numbers if isinstance(kernel, Told) else ()
    return [pair for pair in watch if not any(np.may_share_memory(pair[0], x) for x in read)]


def with_numbers(model: TowerModel, told: Mapping[str, Array]) -> TowerModel:
    """The tower's model with some of its numbers told anew, traced or not, as the face stores them."""
    if "placements" in told:
        poses = [pose_of(T) for T in told["placements"][1:]]
        joints = (replace(j, placement=T) for j, T in zip(model.joints, poses, strict=True))
        model = replace(model, joints=tuple(joints))
    if "inertias" in told:
        base, *bodies = map(_body, told["inertias"])
        model = replace(model, inertias=tuple(bodies), base_inertia=base)
    if "gravity" in told:
        model = replace(model, gravity=told["gravity"][:3])
    if "armature" in told:
        model = told_of_drives(model, "armature", told["armature"])
    return model


def pose_of(T: Array) -> spatial.SE3:
    """A homogeneous matrix as a pose."""
    return spatial.SE3(T[:3, :3], T[:3, 3])


def _body(p: Array) -> spatial.Inertia:
    """Mass, lever, and the rotational inertia row by row, of which the upper triangle is read."""
    xx, xy, xz, _, yy, yz, _, _, zz = p[4:]
    return spatial.Inertia(p[0], np.array(p[1:4]), matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
