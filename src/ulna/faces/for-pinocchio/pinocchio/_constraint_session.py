"""Constraints bound to a Data: one native call solves, and writes what is known then."""

from __future__ import annotations

from typing import Any, NamedTuple, final

import numpy as np

from pinocchio._constraint_kernels import bonds_of, paired, shapes_of
from pinocchio._constraint_pair import changes
from pinocchio._constraint_state import Bound, Left
from pinocchio._data import Data
from pinocchio._kinematics import stacked
from pinocchio._model import Model
from pinocchio._proximal import ProximalSettings
from pinocchio._runs import refuse
from ulna import algorithms
from ulna.algorithms.constrained_dynamics_damped import Damped, damped_dynamics
from ulna.algorithms.constraint_twists import constraint_twists
from ulna.errors import InputError
from ulna.model import Model as TowerModel
from ulna.recipes.base import with_mass
from ulna.typing import Array, Floats


class Solved(NamedTuple):
    """What the last algorithm under constraints found."""

    state: Bound
    a: Floats
    forces: Floats
    wanted: Floats
    settings: ProximalSettings
    impact: bool

    def solved(self) -> Solved:
        """Itself."""
        return self


@final
class Session:
    """Constraints bound to a Data: one native call solves, and writes what is known then."""

    def __init__(self, model: Model, data: Data, models: Any, datas: Any, limit: int) -> None:
        self.models, self.datas = paired(model, models, datas), list(datas)
        if len({id(known) for known in self.datas}) < len(self.datas):
            raise InputError(
                "One data stands for two constraints; give each its own: constraint.createData()."
            )
        self.model, self.limit, self.version = model, limit, changes[0]
        self.home = data._blocks["ddq"]
        self.shapes = shapes = shapes_of(self.models)
        k, rows = len(shapes), sum(shape[0] for shape in shapes)
        self.places, self.gains = np.zeros((k, 2, 4, 4)), np.zeros((k, 2))
        self.wanted, self.numbers = np.zeros((k, 6)), np.zeros(3)
        self.settings = ProximalSettings()
        self.a, self.forces, self.report = np.zeros(model.nv), np.zeros(rows), np.zeros(3)
        self.kept = [np.zeros(model.nq), np.zeros(model.nv), self.places.copy(), self.gains.copy()]
        self.kept_wanted = self.wanted.copy()
        engine = data.attach(model)
        self.left = Left(engine, self.datas, shapes, *self.kept)
        given = {"q": self.kept[0], "v": self.kept[1], "tau": self.a, "places": self.places}
        given |= {"gains": self.gains, "wanted": self.wanted, "numbers": self.numbers}
        sizes: dict[str, Any] = {name: x.shape for name, x in given.items()}
        kernel = engine.made(
            ("constraint dynamics", shapes, limit), with_mass(_motion(shapes, limit)), **sizes
        )
        names = ("ddq", "M", "nle", "J", "oMi", "places q", "own q", "jacobians q")
        targets = [data.target(name) for name in names]
        own = [self.a, self.forces, self.report, *self.kept, self.kept_wanted]
        forces = [known._views["contact_force"]._v for known in self.datas]
        watch = model.watched("numbers")
        self.step = kernel.into(*targets, *own, *forces, returns=(0,), watch=watch, otherwise=refuse)

    def serves(self, model: Model, data: Data, models: Any, datas: Any, limit: int) -> bool:
        """Whether it was made for these."""
        return (
            self.model is model
            and self.home is data._blocks["ddq"]
            and self.limit == limit
            and self.version == changes[0]
            and models == self.models
            and datas == self.datas
        )

    def solve(self, models: Any, settings: ProximalSettings, q: Any, v: Any, tau: Any) -> Any:
        """The accelerations; NotImplemented where arguments or numbers of the model are not what they were."""
        for k, one in enumerate(models):
            self.places[k] = one._places
            self.gains[k] = one._gains._v
        for k, known in enumerate(self.datas):
            self.wanted[k] = known._views["contact_acceleration_desired"]._v
            known._due = self.left
        self.settings = settings
        self.numbers[:] = settings._numbers
        return self.step(q, v, tau, self.places, self.gains, self.wanted, self.numbers)

    def solved(self) -> Solved:
        """What it found."""
        q, v, places, gains = (x.copy() for x in self.kept)
        wanted = np.concatenate(
            [w[: shape[0]] for w, shape in zip(self.kept_wanted, self.shapes, strict=True)]
        )
        state = Bound(self.models, self.datas, q, v, places, gains)
        return Solved(state, self.a.copy(), self.forces.copy(), wanted, self.settings, False)


def _motion(shapes: Any, limit: int) -> Any:
    sizes = [shape[0] for shape in shapes]
    owner = [i for i, size in enumerate(sizes) for _ in range(size)]

    def build(tower: TowerModel) -> Any:
        def run(
            q: Array, v: Array, tau: Array, places: Array, gains: Array, wanted: Array, numbers: Array
        ) -> tuple[Any, ...]:
            twists = constraint_twists(tower, q, v, bonds_of(shapes, places))
            pull = gains[owner, 1] * twists.velocity + gains[owner, 0] * twists.error
            asked = np.concatenate([wanted[k, :size] for k, size in enumerate(sizes)])
            damped = Damped(numbers[0], numbers[1], numbers[2], limit)
            a, forces, *report = damped_dynamics(
                tower, q, v, tau, twists.J, twists.bias + pull - asked, damped
            )
            parts = np.split(forces, np.cumsum(sizes)[:-1])
            return (
                a,
                algorithms.mass_matrix(tower, q),
                algorithms.bias_forces(tower, q, v),
                algorithms.joint_jacobians(tower, q),
                stacked(algorithms.joint_poses(tower, q)),
                q,
                q,
                q,
                a,
                forces,
                np.stack(report),
                q,
                v,
                places,
                gains,
                wanted,
                *(np.concatenate([part, np.zeros(6 - len(part))]) for part in parts),
            )

        return run

    return build
