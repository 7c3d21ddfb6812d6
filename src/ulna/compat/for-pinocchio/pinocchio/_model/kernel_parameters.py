"""Parameters of a model as arrays: what of them kernels can take as inputs, and Ulna's model with other values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from pinocchio._spatial.small_kernels import pose
from ulna import spatial
from ulna.model import Model as CoreModel
from ulna.model.inertial import with_drive_values
from ulna.numeric import matrix
from ulna.typing import Array

PARAMETERS = ("placements", "inertias", "gravity", "armature")
"""The parameters of a model that kernels depend on, besides placements of frames."""


def with_parameters(model: CoreModel, values: Mapping[str, Array]) -> CoreModel:
    """Ulna's model with other values of some parameters.

    Args:
        model: Ulna's model.
        values: Values (...) by name, traced or not, as this package stores them.

    Returns:
        The changed model.
    """
    if "placements" in values:
        poses = [pose(T) for T in values["placements"][1:]]
        joints = (replace(j, placement=T) for j, T in zip(model.joints, poses, strict=True))
        model = replace(model, joints=tuple(joints))
    if "inertias" in values:
        base, *bodies = map(_inertia_of, values["inertias"])
        model = replace(model, inertias=tuple(bodies), base_inertia=base)
    if "gravity" in values:
        model = replace(model, gravity=values["gravity"])
    if "armature" in values:
        model = with_drive_values(model, "armature", values["armature"])
    return model


def _inertia_of(p: Array) -> spatial.Inertia:
    """Mass, lever, and the rotational inertia row by row, of which the upper triangle is read."""
    xx, xy, xz, _, yy, yz, _, _, zz = p[4:]
    rotational: Any = matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return spatial.Inertia(p[0], np.array(p[1:4]), rotational)
