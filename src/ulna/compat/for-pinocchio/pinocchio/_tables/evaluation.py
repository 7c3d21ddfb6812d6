"""Runs the procedures of `recursions` for the present parameters of a model."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._model.building import KinematicTree
from pinocchio._model.kernel_parameters import PARAMETERS
from pinocchio._tables import recursions as r
from pinocchio._tables.joint_table import JointTable, matrices_of
from ulna.typing import Floats


@final
class TableEvaluator:
    """A joint table with storage for numbers and results; for one thread at a time.

    Attributes:
        steps: The joint table.
        out: What the procedures computed last.
    """

    def __init__(self, steps: JointTable, nq: int, nv: int) -> None:
        n, m = len(steps.tree.parents), len(steps.tree.entries)
        self.steps = steps
        self._nv = nv
        tree = steps.tree
        self._tree = tree._replace(
            **{name: getattr(tree, name).copy() for name in ("fixed", "inertias", "armature", "gravity")}
        )
        arrays = map(np.zeros, ((nq, 1), (nv, 1), (nv, 1), (n, 6)))
        self._state = r.State._make([*arrays, np.zeros(6, r.INT)])
        storage = r.new_storage(n, m, nv)
        self.out = storage.results()
        self._evaluate = r.evaluate.bind(self._tree, self._state, *storage).unguarded

    def load(self, model: KinematicTree) -> None:
        """Reads the parameters of a model."""
        self.load_parameters(*(np.concatenate(model._parameter_blocks(name)) for name in PARAMETERS))

    def load_parameters(
        self, placements: Floats, inertias: Floats, gravity: Floats, armature: Floats
    ) -> None:
        """Reads parameters, as a model stores them.

        Args:
            placements: Placements of joints, the universe included (njoints, 4, 4) [m].
            inertias: Mass, lever and moments (njoints, 13) [kg, m, kg m^2].
            gravity: The acceleration of free fall (3,) [m/s^2].
            armature: The armature (nv,) [kg m^2].
        """
        placements = placements[1:].copy()
        for k, place in self.steps.leading.items():
            placements[k] = placements[k] @ place
        tree = self._tree
        tree.fixed[...] = self.steps.placed(placements)
        tree.inertias[self.steps.of_joint + 1] = about_origin(inertias[1:])
        tree.gravity[...] = gravity
        tree.armature[...] = armature

    def run(
        self, tasks: r.Tasks, q: Floats, v: Floats | None = None, a: Floats | None = None, F: Any = None
    ) -> r.Results:
        """Computes at a state.

        Args:
            tasks: What.
            v: Velocity (nv,) [rad/s or m/s]; None for rest.
            a: Acceleration (nv,) [rad/s^2 or m/s^2]; None for none.
            F: Forces on the joints (njoints - 1, 6) [N, N m]; None for none.

        Returns:
            The results, which the next run overwrites.
        """
        state = self._state
        state.q[:, 0] = q
        state.v[:, 0] = 0.0 if v is None else v
        state.a[:, 0] = 0.0 if a is None else a
        state.forces[self.steps.of_joint + 1] = 0.0 if F is None else F
        state.tasks[:] = tasks
        self._evaluate()
        return self.out

    @property
    def inertias(self) -> Floats:
        """Mass, mass times centre and moments about the frame's origin of each step, (steps, 10)."""
        return self._tree.inertias[1:]

    @property
    def gravity(self) -> Floats:
        """The acceleration of free fall (3,)."""
        return self._tree.gravity

    @property
    def armature(self) -> Floats:
        """The armature (nv,)."""
        return self._tree.armature

    def placements(self) -> Floats:
        """The placements of the joints in the world, (njoints - 1, 4, 4)."""
        return matrices_of(self.out.T[self.steps.of_joint])

    def of_joints(self, rows: Floats) -> Floats:
        """The rows of the steps whose moving frames are the joints'."""
        return rows[self.steps.of_joint]

    def stand_on_base(self) -> Any:
        """For each joint whether no joint moves it, (njoints - 1,)."""
        return self.steps.table.parents[self.steps.first] < 0

    def subtree_sums(self, rows: Floats) -> Floats:
        """The sums of values of steps over all that each step moves, (steps, ...)."""
        sums, parents = rows.copy(), self.steps.table.parents.tolist()
        for i in reversed(range(len(parents))):
            if parents[i] >= 0:
                sums[parents[i]] += sums[i]
        return sums

    def supports(self, joint: int) -> Floats:
        """1 for columns that move a joint, 0 for others, (columns,); joint 0 is the universe."""
        table, out = self.steps.table, np.zeros(len(self.steps.table.entries))
        step = self.steps.of_joint[joint - 1] if joint else -1
        while step >= 0:
            out[table.columns[step] : table.columns[step + 1]] = 1.0
            step = table.parents[step]
        return out

    def beyond(self, joint: int) -> Floats:
        """1 for columns of a joint and of those that it moves, 0 for others, (columns,)."""
        steps, parents = self.steps, self.steps.table.parents.tolist()
        moved = np.zeros(len(parents))
        for step in range(steps.first[joint - 1], len(parents)):
            own = steps.first[joint - 1] <= step <= steps.of_joint[joint - 1]
            moved[step] = 1.0 if own or (parents[step] >= 0 and moved[parents[step]]) else 0.0
        return np.repeat(moved, np.diff(steps.table.columns))

    def by_entries(self, columns: Floats) -> Floats:
        """Columns of the world, one a row, summed over what each entry of v moves: (6, nv)."""
        out = np.zeros((6, self._nv))
        np.add.at(out.T, self.steps.table.entries, columns)
        return out


def about_origin(parameters: Floats) -> Floats:
    """Mass, mass times centre, and moments about the frame's origin (n, 10), of mass, lever and moments (n, 13).

    Only the upper triangle of the moments is read.
    """
    mass, lever = parameters[:, 0], parameters[:, 1:4]
    out = np.empty((len(parameters), 10))
    out[:, 0] = mass
    out[:, 1:4] = mass[:, None] * lever
    out[:, 4:] = parameters[:, [4, 5, 6, 8, 9, 12]]
    squares = out[:, 1:4, None] * lever[:, None, :]
    trace = squares[:, 0, 0] + squares[:, 1, 1] + squares[:, 2, 2]
    for k, (i, j) in enumerate(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))):
        out[:, 4 + k] += (trace if i == j else 0.0) - squares[:, i, j]
    return out


def about_center(inertias: Floats) -> Floats:
    """Mass, lever and moments about it (n, 13), of what `about_origin` returns (n, 10)."""
    mass, first = inertias[:, 0], inertias[:, 1:4]
    lever = first / np.where(mass == 0.0, 1.0, mass)[:, None]
    squares = first[:, :, None] * lever[:, None, :]
    trace = np.einsum("nii->n", squares)
    moments = inertias[:, [4, 5, 6, 5, 7, 8, 6, 8, 9]].reshape(-1, 3, 3)
    moments = moments - trace[:, None, None] * np.eye(3) + squares
    return np.concatenate([mass[:, None], lever, moments.reshape(-1, 9)], axis=1)
