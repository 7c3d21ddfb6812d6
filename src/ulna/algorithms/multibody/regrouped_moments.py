"""Regrouped inertias: the part of a body's inertia that its joint does not distinguish is counted with the parent.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| m, c, I | mass, first and second moment of a body about the origin of its moving frame | MassMoments | | |
| k; a, b | axis of a revolute joint; the two axes across it | | | |
| m', c', I' | the part that is moved to the parent | MassMoments | | |
| | revolute joint | | | m' = m, c' = c_k e_k, I' = I_bb (1 - e_k e_k^T) |
| | prismatic joint, translation | | | m' = 0, c' = 0, I' = I |
| | spherical joint | | | m' = m, c' = 0, I' = 0 |

A mass on the axis of a revolute joint, a first moment along it, and a second moment that is equal in aa and bb do not
change as the joint turns: the kinetic energy of the robot is the same when they belong to the parent. A prismatic
joint does not turn the body, so its second moment may belong to the parent; a mass at the centre of a spherical joint
moves with either body. Moved inward from the leaves to the root, this leaves most bodies without mass, without c_k and
without I_bb; the zeros shorten every recursion. What remains are the base parameters. Joint torques, the mass matrix,
kinetic energy and the total momentum stay the same. Forces and momenta of single bodies do not: use regrouped
inertias only for what is projected on motion subspaces or summed over the robot.

Source: Khalil & Kleinfinger, Minimum operations and minimum parameters of the dynamic models of tree structure robots
(1987).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.algorithms.multibody.mass_moments import MassMoments, rotation_axis
from ulna.algorithms.multibody.tree import Step
from ulna.model import Continuous, Prismatic, Revolute, Spherical, Translation
from ulna.numeric import is_symbolic


def regrouped_moments(
    tree: Sequence[Step], bodies: Sequence[MassMoments]
) -> tuple[list[MassMoments], MassMoments]:
    """The regrouped inertia of every step, and what is counted with the world.

    A placement that is not a number is skipped: moving inertia through it costs more operations than it saves.

    Args:
        tree: The steps of a model.
        bodies: The inertia of the body of every step, in its moving frame [kg, kg m, kg m^2].

    Returns:
        The regrouped inertias, one a step, in the same frames, and what those of the roots leave to the world, in its
        frame [kg, kg m, kg m^2]. Together they have the moments of the robot in every configuration.
    """
    regrouped, at_rest = list(bodies), MassMoments.zero()
    for i, step in reversed(list(enumerate(tree))):
        if step.parent >= 0 and is_symbolic(step.placement.rotation, step.placement.translation):
            continue
        part = _indistinguishable_part(step, regrouped[i])
        if part is None:
            continue
        regrouped[i] = regrouped[i] - part
        moved = part.to_outer_frame(step.placement)
        if step.parent >= 0:
            regrouped[step.parent] = regrouped[step.parent] + moved
        else:
            at_rest = at_rest + moved
    return regrouped, at_rest


def _indistinguishable_part(step: Step, body: MassMoments) -> MassMoments | None:
    """m', c' and I' in the moving frame of a step, which is its fixed frame at position zero; None for no part."""
    zero = np.zeros(3), np.zeros((3, 3))
    if isinstance(step.kind, (Prismatic, Translation)):
        return MassMoments(0.0, zero[0], body.second)
    if isinstance(step.kind, Spherical):
        return MassMoments(body.mass, *zero)
    if not isinstance(step.kind, (Revolute, Continuous)):
        return None
    k = rotation_axis(step.kind)
    if k is None:
        return MassMoments(body.mass, *zero)
    b, along = (k + 2) % 3, np.eye(3)[k]
    return MassMoments(body.mass, body.first * along, body.second[b, b] * (np.eye(3) - np.diag(along)))
