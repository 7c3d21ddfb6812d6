"""Fields of a Data that follow from others: of subtrees, of entries of v, of the mass matrix."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pinocchio._containers.arrays import StdVec, fixed, not_applicable, vector, views
from pinocchio._containers.computed_lists import ComputedList
from pinocchio._data.evaluated_model import evaluator_of
from pinocchio._data.first_evaluation import TABLE_CALLS
from pinocchio._data.states import FieldStates
from pinocchio._model.building import KinematicTree
from pinocchio._model.joint_model import JointModel
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from pinocchio._tables import recursions as r
from pinocchio._tables.evaluation import about_center
from ulna.compiler import compile as compile_function
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats


class TreeFields(FieldStates):
    """The part of a Data that is computed from the tree whenever it is read."""

    @property
    def lastChild(self) -> StdVec[int]:
        """For each joint the last joint that it moves, itself included."""
        return ComputedList([max(moved) for moved in _moved(self._model)])

    @property
    def nvSubtree(self) -> StdVec[int]:
        """For each joint how many entries of v move what it moves, its own included."""
        nvs = [0, *(joint.nv for joint in list(self._model.joints)[1:])]
        return ComputedList([sum(nvs[i] for i in moved) for moved in _moved(self._model)])

    @property
    def start_idx_v_fromRow(self) -> StdVec[int]:
        """For each entry of v the first one of its joint."""
        return ComputedList([start for start, _, _ in _rows(self._model)])

    @property
    def end_idx_v_fromRow(self) -> StdVec[int]:
        """For each entry of v the last one of its joint."""
        return ComputedList([start + size - 1 for start, size, _ in _rows(self._model)])

    @property
    def parents_fromRow(self) -> StdVec[int]:
        """For each entry of v, mimic joints included, the one before it towards the world; -1 for none."""
        return self._nearest_rows(lambda joint: True)

    @property
    def non_mimic_parents_fromRow(self) -> StdVec[int]:
        """The same, passing over mimic joints."""
        return self._nearest_rows(lambda joint: joint.mimic is None)

    @property
    def mimic_parents_fromRow(self) -> StdVec[int]:
        """The same, passing over all joints but mimic ones."""
        return self._nearest_rows(lambda joint: joint.mimic is not None)

    def _nearest_rows(self, counts: Callable[[JointModel], bool]) -> StdVec[int]:
        """For each row of a v with those of mimic joints, the one before it; of other joints, only those that count."""
        model = self._model
        out = [-1] * model.nvExtended
        for i, joint in enumerate(list(model.joints)[1:], start=1):
            before = model.parents[i]
            while before and not (counts(model.joints[before]) and model.joints[before].nvExtended):
                before = model.parents[before]
            last = model.joints[before].idx_vExtended + model.joints[before].nvExtended - 1 if before else -1
            for row in range(joint.idx_vExtended, joint.idx_vExtended + joint.nvExtended):
                out[row] = last if row == joint.idx_vExtended else row - 1
        return ComputedList(out)

    @property
    def mimic_subtree_joint(self) -> StdVec[int]:
        """For each mimic joint the first joint behind it that has entries of v of its own; 0 for none."""
        model, moved = self._model, _moved(self._model)
        mimicking = [i for i, joint in enumerate(model.joints) if joint.mimic is not None]
        return ComputedList(
            [min((j for j in moved[i] if model.joints[j].mimic is None), default=0) for i in mimicking]
        )

    @property
    def idx_vExtended_to_idx_v_fromRow(self) -> StdVec[int]:
        """For each entry of a v with those of mimic joints, the entry of v that it follows."""
        joints = sorted(list(self._model.joints)[1:], key=lambda joint: joint.idx_vExtended)
        return ComputedList([joint.idx_v + k for joint in joints for k in range(joint.nvExtended)])

    @property
    def supports_fromRow(self) -> StdVec[StdVec[int]]:
        """For each entry of v those from the world to it."""
        supports: list[StdVec[int]] = []
        for row, parent in enumerate(self.parents_fromRow):
            supports.append(ComputedList([*(supports[parent] if parent >= 0 else ()), row]))
        return ComputedList(supports)

    @property
    def nvSubtree_fromRow(self) -> StdVec[int]:
        """For each entry of v how many entries move what it moves, itself included."""
        below = self.nvSubtree
        return ComputedList(
            [below[joint] - (row - start) for row, (start, _, joint) in enumerate(_rows(self._model))]
        )

    @property
    def Ycrb(self) -> StdVec[Inertia]:
        """For each joint the inertia of all it moves, in its frame, at the last algorithm's configuration; live."""
        if self._bound_at.get("Ycrb as it is", not_applicable)() is NotImplemented:
            self._fill_composite_inertias()
        return self._lists["Ycrb"]

    def _fill_composite_inertias(self) -> None:
        """Computes the composite inertias; after the first calls by a kernel that is bound here."""
        if self._bound_at.get("Ycrb", not_applicable)() is not NotImplemented:
            self._arrays["Ycrb q"][...] = self._q_of_joints
            return
        model, inertias = self._model, self._arrays["composite inertias"]
        q = self._require(self._q_of_joints, "crba(model, data, q)")
        if model.first_calls.includes("Ycrb", TABLE_CALLS):
            inertias[...] = self._composite_inertias()[0]
            return
        watch = model._watched("masses")
        compiled = self._attach(model)
        if compiled.parameter_names:  # where masses are inputs, bodies without mass need the table's cases
            inertias[...] = self._composite_inertias()[0]
            return
        kernel = compiled.compile("composite inertias", _composite, q=(model.nq,))
        step = kernel.into(inertias, watch=watch, otherwise=not_applicable, trailing_inputs=[q])
        computed_at = self._arrays["Ycrb q"]
        computed_at[...] = q
        nothing, unchanged = np.zeros(()), compile_function(lambda x: x, x=())
        self._bound_at["Ycrb"] = step
        self._bound_at["Ycrb as it is"] = unchanged.into(
            np.zeros(()),
            watch=[(q, computed_at), *watch],
            otherwise=not_applicable,
            trailing_inputs=[nothing],
        )
        step()

    @property
    def oYcrb(self) -> StdVec[Inertia]:
        """For each joint the inertia of all it moves, in the world, read only; that of the robot first. See `Ycrb`."""
        inertias, placements = self._composite_inertias()
        placed = [SE3._of(T).act(Y) for T, Y in zip(placements, views(Inertia, inertias), strict=True)]
        parents = self._model.parents
        placed[0] = sum((Y for i, Y in enumerate(placed) if i and parents[i] == 0), Inertia())
        return ComputedList(views(Inertia, fixed(np.stack([Y._p for Y in placed]))))

    @property
    def U(self) -> Floats:
        """The unit upper triangle (nv, nv) of M = U diag(D) U^T, a copy; see `D`."""
        return fixed(self._factors_of_mass()[0])

    @property
    def D(self) -> Floats:
        """The diagonal (nv,) of M = U diag(D) U^T, live, as `cholesky.decompose` or `forwardDynamics` left it.

        Before these U is the identity and D zero.
        """
        return self._factors_of_mass()[1]

    @D.setter
    def D(self, value: Any) -> None:
        D = self._factors_of_mass()[1]
        D[...] = vector(value, D.size, "D")

    def _factors_of_mass(self) -> tuple[Floats, Floats]:
        """U, which is not kept, and D, which is."""
        factors = self._decomposed()
        if factors is not None:
            return factors.upper(), factors.D
        U, D = self._arrays["U of mass"], self._arrays["D of mass"]
        if self._damped is not self._factored_for:  # forwardDynamics, or the like, came after
            lower = np.linalg.cholesky(self._arrays["M"][::-1, ::-1])
            roots = np.diag(lower)
            U[...], D[...] = (lower / roots)[::-1, ::-1], (roots * roots)[::-1]
            self._factored_for = self._damped
        elif not U.any():
            np.fill_diagonal(U, 1.0)
        return U.copy(), D

    def _decomposed(self) -> Any:
        """The factors that `cholesky.decompose` left; None where it was not called, or another one came after."""
        factors = self._bound_at.get("cholesky")
        return None if factors is None or factors.outdated[0] else factors

    def _keep_factors(self) -> None:
        """Writes U and D into arrays, for copies, which have no bound kernels."""
        if self._decomposed() is not None:
            self._arrays["U of mass"][...], self._arrays["D of mass"][...] = self._factors_of_mass()
            self._factored_for = self._damped

    def _composite_inertias(self) -> tuple[Floats, Floats]:
        """Parameters of the inertias (njoints, 13), and placements of the joints (njoints, 4, 4)."""
        model = self._model
        q = self._require(self._q_of_joints, "crba(model, data, q)")
        evaluator = evaluator_of(model, self)
        evaluator.load(model)
        out = evaluator.run(r.MASS, q)
        inertias = np.concatenate([np.zeros((1, 13)), about_center(evaluator.of_joints(out.B))])
        return inertias, np.concatenate([np.eye(4)[None], evaluator.placements()])


def _composite(model: CoreModel) -> Callable[[Array], Array]:
    """The inertias of what each joint moves, in its frame, as an Inertia stores them; the universe's, zero, first."""

    def run(q: Array) -> Array:
        sums = list(model.inertias)
        for i, joint in reversed([*enumerate(model.joints)]):
            if joint.parent >= 0:
                placed = joint.placement @ joint.kind.transform(joint.q_of(q))
                sums[joint.parent] = sums[joint.parent] + placed.act(sums[i])
        stored = [np.concatenate([[Y.mass], Y.com, Y.inertia.reshape(9)]) for Y in sums]
        return np.stack([np.zeros(13), *stored])

    return run


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
