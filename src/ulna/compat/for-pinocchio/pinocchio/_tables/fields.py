"""The fields of a Data from a joint table: for each name, how it is computed at a state."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

import numpy as np

from pinocchio._model.building import KinematicTree
from pinocchio._tables import recursions as r
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.world_derivatives import WorldDerivatives
from pinocchio._tables.world_sums import WorldSums
from ulna.system.cached import cached_property
from ulna.typing import Floats

WORST_CONDITION = 1e8
"""Condition numbers of mass matrices beyond which what is compiled decides whether to warn or refuse."""


class NotByTable(Exception):
    """What is computed needs a closer look at the model; it is compiled at once."""


@final
class TableFields:
    """Fields of a Data at a state, each computed when it is asked for.

    Args:
        evaluator: The evaluator, whose parameters are loaded.
        model: The model, for its frames.
        inputs: Arrays by the letters of `Algorithm.inputs`: q, v, a, t for torques, f for forces on the joints.
    """

    def __init__(self, evaluator: TableEvaluator, model: KinematicTree, inputs: dict[str, Floats]) -> None:
        self._evaluator, self._model, self._inputs = evaluator, model, inputs
        self._q: Any = inputs.get("q")
        self._v, self._a = inputs.get("v"), inputs.get("a")
        self._forces = inputs.get("f")

    def field(self, name: str) -> Floats:
        """A field by its name in `Algorithm.fills`."""
        if name in FIELDS:
            return FIELDS[name](self)
        letter = name[-1]  # of a state that is stored
        return self.accelerations if letter == "a" and "a" not in self._inputs else self._inputs[letter]

    @cached_property
    def sums(self) -> WorldSums:
        """Sums over the bodies."""
        return WorldSums(self._evaluator, self._q, self._v, self._a)

    def torques(self, v: Floats | None, a: Floats | None) -> Floats:
        """Inverse dynamics under the forces.

        Args:
            v: Velocity (nv,) [rad/s or m/s]; None for rest.
            a: Acceleration (nv,) [rad/s^2 or m/s^2]; None for none.

        Returns:
            Torques (nv,) [N m or N].
        """
        return self._evaluator.run(r.DYNAMICS, self._q, v, a, self._forces).tau

    @cached_property
    def mass_matrix(self) -> Floats:
        """The mass matrix (nv, nv)."""
        return self._evaluator.run(r.MASS, self._q).M.copy()

    @cached_property
    def inverse_mass(self) -> Floats:
        """Its inverse (nv, nv).

        Raises:
            NotByTable: It is close to singular.
        """
        M = self.mass_matrix
        with np.errstate(all="ignore"):
            try:
                inverse = np.linalg.inv(M)
                np.linalg.cholesky(M)
            except np.linalg.LinAlgError:
                raise NotByTable from None
            condition = np.abs(M).sum(axis=0).max(initial=0) * np.abs(inverse).sum(axis=0).max(initial=0)
        if not condition < WORST_CONDITION:
            raise NotByTable
        return 0.5 * (inverse + inverse.T)

    @cached_property
    def accelerations(self) -> Floats:
        """Forward dynamics (nv,)."""
        _ = self.inverse_mass  # may refuse
        torques = self._inputs["t"] - self.torques(self._v, None)
        return np.asarray(np.linalg.solve(self.mass_matrix, torques), float)

    @cached_property
    def motion(self) -> tuple[Floats, Floats, Floats]:
        """Placements, velocities and accelerations of the joints, (njoints - 1, ...)."""
        evaluator = self._evaluator
        tasks = r.PLACEMENTS if self._v is None else r.MOTION
        out = evaluator.run(tasks, self._q, self._v, self._a)
        return evaluator.placements(), evaluator.of_joints(out.V), evaluator.of_joints(out.A)

    @cached_property
    def jacobian(self) -> Floats:
        """The columns of all joints in the world (6, nv)."""
        return self._evaluator.by_entries(self._evaluator.run(r.COLUMNS, self._q).J)

    @cached_property
    def jacobian_rate(self) -> Floats:
        """Their rates (6, nv)."""
        return self._evaluator.by_entries(self._evaluator.run(r.RATES, self._q, self._v).dJ)

    @cached_property
    def derivatives(self) -> WorldDerivatives:
        """Derivatives by the state; where torques are given, at the accelerations that they cause."""
        a = self.accelerations if "t" in self._inputs else self._a
        return WorldDerivatives(self._evaluator, self._q, self._v, a, self._forces)

    def accelerations_by(self, torques: Floats) -> Floats:
        """Derivatives of forward dynamics (nv, nv), of those of the torques that the accelerations need."""
        return -self.inverse_mass @ torques

    def about_center(self, columns: Floats, total: Floats | None = None) -> Floats:
        """Changes of momenta or forces about the origin, about the centre of mass, (6, nv).

        Args:
            columns: The changes (columns, 6).
            total: What moves with the centre of mass, about it (6,), where it is changed, too; None where it is not.

        Returns:
            The changes (6, nv), by entries of v.
        """
        out = self._evaluator.by_entries(columns)
        out[3:] -= np.cross(self.sums.center, out[:3], axisb=0, axisc=0)
        if total is not None:
            out[3:] -= np.cross(self.sums.center_jacobian, total[:3], axisa=0, axisc=0)
        return out

    def frames(self) -> Floats:
        """The placements of all frames in the world (nframes, 4, 4)."""
        poses = np.concatenate([np.eye(4)[None], self.motion[0]])
        return frames_at(self._model, poses)


def frames_at(model: KinematicTree, placements: Floats) -> Floats:
    """The placements of a model's frames.

    Args:
        placements: Those of the joints, the universe included (njoints, 4, 4).

    Returns:
        Matrices (nframes, 4, 4).
    """
    model._frame_state()  # stores frames that were added
    parents = [frame.parentJoint for frame in model.frames]
    return placements[parents] @ np.concatenate(model._parameter_blocks("frames"))


FIELDS: dict[str, Callable[[TableFields], Any]] = {
    "oMi": lambda f: f.motion[0],
    "v": lambda f: f.motion[1],
    "a": lambda f: f.motion[2],
    "oMf": TableFields.frames,
    "J": lambda f: f.jacobian,
    "dJ": lambda f: f.jacobian_rate,
    "tau": lambda f: f.torques(f._v, f._a),
    "nle": lambda f: f.torques(f._v, None),
    "g": lambda f: f.torques(None, None),
    "M": lambda f: f.mass_matrix,
    "Minv": lambda f: f.inverse_mass,
    "ddq": lambda f: f.accelerations,
    "dtau_dq": lambda f: f.derivatives.torques_by_configuration(),
    "dtau_dv": lambda f: f.derivatives.torques_by_velocity(),
    "ddq_dq": lambda f: f.accelerations_by(f.derivatives.torques_by_configuration()),
    "ddq_dv": lambda f: f.accelerations_by(f.derivatives.torques_by_velocity()),
    "ddq_dtau": lambda f: f.inverse_mass,
    "C": lambda f: f.derivatives.coriolis(),
    "gravity by q": lambda f: f.derivatives.torques_by_configuration(),
    "oa_gf[0]": lambda f: np.concatenate([-f._evaluator.gravity, np.zeros(3)]),
    "dHdq": lambda f: f.about_center(f.derivatives.momenta_by_configuration(), f.sums.momentum),
    "dFdq": lambda f: f.about_center(f.derivatives.forces_by_configuration(False), f.sums.momentum_rate),
    "dFdv": lambda f: f.about_center(f.derivatives.forces_by_velocity()),
    "dFda": lambda f: f.about_center(f.derivatives.by_acceleration),
    "com[0]": lambda f: f.sums.center,
    "vcom[0]": lambda f: f.sums.center_velocity,
    "acom[0]": lambda f: f.sums.center_acceleration,
    "Jcom": lambda f: f.sums.center_jacobian,
    "Ag": lambda f: f.sums.centroidal_map,
    "dAg": lambda f: f.sums.centroidal_map_rate,
    "hg": lambda f: f.sums.momentum,
    "dhg": lambda f: f.sums.momentum_rate,
    "oh[0]": lambda f: f.sums.about_origin(f.sums.momentum),
    "of[0]": lambda f: f.sums.about_origin(f.sums.momentum_rate),
    "h[0]": lambda f: f.sums.about_origin(f.sums.momentum),
    "f[0]": lambda f: f.sums.about_origin(f.sums.momentum_rate),
    "Ig": lambda f: f.sums.one_body,
    "energy K": lambda f: f.sums.kinetic_energy,
    "energy P": lambda f: f.sums.potential_energy,
    "energy K + P": lambda f: f.sums.kinetic_energy + f.sums.potential_energy,
}
