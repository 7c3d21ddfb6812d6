"""Fields of a Data that follow from others: of subtrees, of entries of v, of the mass matrix."""

from __future__ import annotations

import numpy as np

from pinocchio._containers.arrays import StdVec, views
from pinocchio._data.evaluated_model import evaluator_of
from pinocchio._data.states import FieldStates
from pinocchio._model.building import KinematicTree
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from pinocchio._tables import recursions as r
from pinocchio._tables.evaluation import about_center
from ulna.errors import InputError
from ulna.typing import Floats


class TreeFields(FieldStates):
    """The part of a Data that is computed from the tree whenever it is read."""

    @property
    def lastChild(self) -> StdVec[int]:
        """For each joint the last joint that it moves, itself included."""
        return StdVec([max(moved) for moved in _moved(self._model)])

    @property
    def nvSubtree(self) -> StdVec[int]:
        """For each joint how many entries of v move what it moves, its own included."""
        nvs = [0, *(joint.nv for joint in self._model.joints[1:])]
        return StdVec([sum(nvs[i] for i in moved) for moved in _moved(self._model)])

    @property
    def start_idx_v_fromRow(self) -> StdVec[int]:
        """For each entry of v the first one of its joint."""
        return StdVec([start for start, _, _ in _rows(self._model)])

    @property
    def end_idx_v_fromRow(self) -> StdVec[int]:
        """For each entry of v the last one of its joint."""
        return StdVec([start + size - 1 for start, size, _ in _rows(self._model)])

    @property
    def parents_fromRow(self) -> StdVec[int]:
        """For each entry of v the one before it towards the world; -1 for the first."""
        model, out = self._model, []
        for row, (start, _, joint) in enumerate(_rows(model)):
            out.append(row - 1 if row > start else _last_row(model, model.parents[joint]))
        return StdVec(out)

    @property
    def supports_fromRow(self) -> StdVec[StdVec[int]]:
        """For each entry of v those from the world to it."""
        supports: list[StdVec[int]] = []
        for row, parent in enumerate(self.parents_fromRow):
            supports.append(StdVec([*(supports[parent] if parent >= 0 else ()), row]))
        return StdVec(supports)

    @property
    def nvSubtree_fromRow(self) -> StdVec[int]:
        """For each entry of v how many entries move what it moves, itself included."""
        below = self.nvSubtree
        return StdVec(
            [below[joint] - (row - start) for row, (start, _, joint) in enumerate(_rows(self._model))]
        )

    @property
    def Ycrb(self) -> StdVec[Inertia]:
        """For each joint the inertia of all it moves, in its frame, at the configuration of the last algorithm."""
        return views(Inertia, self._composite_inertias()[0])

    @property
    def oYcrb(self) -> StdVec[Inertia]:
        """For each joint the inertia of all it moves, in the world; that of the whole robot first. See `Ycrb`."""
        inertias, placements = self._composite_inertias()
        placed = [SE3._of(T).act(Y) for T, Y in zip(placements, views(Inertia, inertias), strict=True)]
        parents = self._model.parents
        placed[0] = sum((Y for i, Y in enumerate(placed) if i and parents[i] == 0), Inertia())
        return StdVec(placed)

    @property
    def U(self) -> Floats:
        """The unit upper triangle (nv, nv) of `data.M` = U diag(D) U^T."""
        return self._factors_of_mass()[0]

    @property
    def D(self) -> Floats:
        """The diagonal (nv,) of `data.M` = U diag(D) U^T."""
        return self._factors_of_mass()[1]

    def _factors_of_mass(self) -> tuple[Floats, Floats]:
        try:
            reversed_factor = np.linalg.cholesky(self._arrays["M"][::-1, ::-1])
        except np.linalg.LinAlgError:
            raise InputError(
                "`data.M` has no factors: it is not positive definite. Call crba(model, data, q) first."
            ) from None
        roots = np.diag(reversed_factor)
        return (reversed_factor / roots)[::-1, ::-1].copy(), (roots * roots)[::-1].copy()

    def _composite_inertias(self) -> tuple[Floats, Floats]:
        """Parameters of the inertias (njoints, 13), and placements of the joints (njoints, 4, 4)."""
        model = self._model
        q = self.require(self._q_of_joints, "crba(model, data, q)")
        evaluator = evaluator_of(model, self)
        evaluator.load(model)
        out = evaluator.run(r.MASS, q)
        inertias = np.concatenate([np.zeros((1, 13)), about_center(evaluator.of_joints(out.B))])
        return inertias, np.concatenate([np.eye(4)[None], evaluator.placements()])


def _moved(model: KinematicTree) -> list[list[int]]:
    """For each joint those that it moves, itself included."""
    moved = [[i] for i in range(model.njoints)]
    for i in reversed(range(1, model.njoints)):
        moved[model.parents[i]] += moved[i]
    return moved


def _rows(model: KinematicTree) -> list[tuple[int, int, int]]:
    """For each entry of v: where its joint begins, how many it has, and the joint."""
    joints = [(joint.idx_v, joint.nv, i) for i, joint in enumerate(model.joints) if i and joint.nv]
    return [place for place in sorted(joints) for _ in range(place[1])]


def _last_row(model: KinematicTree, joint: int) -> int:
    """The last entry of v of a joint, or of the nearest one below it that has some; -1 for none."""
    while joint and not model.joints[joint].nv:
        joint = model.parents[joint]
    return model.joints[joint].idx_v + model.joints[joint].nv - 1 if joint else -1
