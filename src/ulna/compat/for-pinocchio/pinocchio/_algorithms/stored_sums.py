"""Energies, momenta and centres of mass out of the placements and motions of a Data as they are, whoever wrote them.

| symbol | meaning |
|---|---|
| X_i | placement of joint i in the frame of the joint before it, `liMi` |
| T_i | its placement in the world, `oMi` |
| V_i, A_i | twist and spatial acceleration, in its frame |
| Y_i | inertia of its body, in its frame |
| p | the joint before it, 0 for the universe |

What a joint moves is summed from the last joint to the first: the sum of p gains X_i acting on that of i.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar, final

import numpy as np

from pinocchio._containers.arguments import check_layout
from pinocchio._containers.arrays import not_applicable
from pinocchio._data.data import Data
from pinocchio._data.evaluated_model import NUMBER_CALLS, EvaluatedModel
from pinocchio._data.states import compiled_for
from pinocchio._model.model import Model
from pinocchio._spatial.small_kernels import body, pose
from ulna import spatial
from ulna.model import Model as CoreModel
from ulna.numeric import cross, dot
from ulna.spatial import Motion
from ulna.typing import Array

Sum = TypeVar("Sum")


@final
@dataclass(frozen=True, eq=False)
class OfFields:
    """An algorithm whose inputs are fields of a Data.

    Attributes:
        name: Its name, under which it is bound.
        reads: The fields that it reads, and of states such as "velocities v" the arrays.
        fills: The arrays of the Data that it fills.
        build: Makes, of a model of Ulna whose joints count and not its numbers, the function of these fields, of the
            inertias (n, 13), gravity (3,) and the armature (nv,).
        returns: The index of what a call returns a copy of.
    """

    name: str
    reads: tuple[str, ...]
    fills: tuple[str, ...]
    build: Callable[[CoreModel], Callable[..., tuple[Any, ...]]]
    returns: int = 0

    def run(self, model: Model, data: Data) -> Any:
        """Fills the Data.

        Args:
            model: The model.
            data: Its data.

        Returns:
            A copy of one of the results.

        Raises:
            InputError: The Data does not fit the model.
        """
        check_layout(model, data)
        fields = [name for name in self.reads if name in data._slots]
        for field in fields:
            data._read(field)
        step = data._bound_at.get(self.name, not_applicable) if data._model is model else not_applicable
        result = step()
        if result is NotImplemented:
            compiled_for(model, data)
            result = self._run_anew(model, data, fields)
        data._mark_filled(*(name for name in self.fills if name in data._slots))
        return result

    def _run_anew(self, model: Model, data: Data, fields: Sequence[str]) -> Any:
        """Evaluates it on numbers, or compiles it and binds it to the arrays of the Data and of the model."""
        bodies = model._parameter_blocks("inertias")
        parameters = [*model._parameter_blocks("gravity"), *model._parameter_blocks("armature")]
        inputs = [*(data._arrays[name] for name in self.reads), np.concatenate(bodies), *parameters]
        targets = [data._arrays[name] for name in self.fills]
        if len(bodies) > 1 or model.first_calls.includes(self.name, NUMBER_CALLS):
            with np.errstate(all="ignore"):
                results = self.build(EvaluatedModel(model).model)(*inputs)
            for target, values in zip(targets, results, strict=True):
                target[...] = values
            return np.array(targets[self.returns])
        sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(inputs)}
        key = self.name, tuple(model.parents)
        kernel = model._compiled_structure().compile(key, self.build, **sizes)
        inputs[len(self.reads)] = bodies[0]
        step = kernel.into(
            *targets,
            returns=(self.returns,),
            watch=[*model._watched("structure"), *((data._mark_of(x), np.zeros(())) for x in fields)],
            otherwise=not_applicable,
            trailing_inputs=inputs,
        )
        if data._model is model:
            data._bound_at[self.name] = step
        return step()


def _parents(core: CoreModel) -> list[int]:
    """The joint before each joint, the universe first."""
    return [0, *(joint.parent + 1 for joint in core.joints)]


def _summed(parents: Sequence[int], values: Sequence[Sum], carried: Callable[[int, Any], Any]) -> list[Any]:
    """For each joint, the universe first, the sum of what it moves."""
    sums: list[Any] = list(values)
    for i in range(len(sums) - 1, 0, -1):
        sums[parents[i]] = sums[parents[i]] + carried(i, sums[i])
    return sums


def _motion(vector: Array) -> Motion:
    return Motion(vector[:3], vector[3:])


def _kinetic_of(v: Array, rate: Array, inertias: Array, armature: Array) -> Any:
    energy = 0.5 * dot(rate * armature, rate)
    for k in range(1, len(v)):
        V = _motion(v[k])
        energy = energy + 0.5 * dot(V.vector(), body(inertias[k]).apply(V).vector())
    return energy


def _potential_of(oMi: Array, inertias: Array, gravity: Array) -> Any:
    moments = [
        inertias[k][0] * (oMi[k][:3, :3] @ inertias[k][1:4] + oMi[k][:3, 3]) for k in range(1, len(oMi))
    ]
    return -dot(gravity, sum(moments, np.zeros(3)))


def _kinetic(_: CoreModel) -> Any:
    return lambda v, rate, inertias, _, armature: (_kinetic_of(v, rate, inertias, armature),)


def _potential(_: CoreModel) -> Any:
    return lambda oMi, inertias, gravity, _: (_potential_of(oMi, inertias, gravity),)


def _mechanical(_: CoreModel) -> Any:
    def run(
        oMi: Array, v: Array, rate: Array, inertias: Array, gravity: Array, armature: Array
    ) -> tuple[Any, ...]:
        kinetic = _kinetic_of(v, rate, inertias, armature)
        potential = _potential_of(oMi, inertias, gravity)
        return kinetic, potential, kinetic + potential

    return run


KINETIC_ENERGY = OfFields("kinetic energy of fields", ("v", "velocities v"), ("energy K",), _kinetic)
POTENTIAL_ENERGY = OfFields("potential energy of fields", ("oMi",), ("energy P",), _potential)
MECHANICAL_ENERGY = OfFields(
    "mechanical energy of fields",
    ("oMi", "v", "velocities v"),
    ("energy K", "energy P", "energy K + P"),
    _mechanical,
    2,
)


def _momentum(core: CoreModel, with_rate: bool) -> Any:
    """Momenta of what each joint moves, and the rates of these, in its frame; of all about the centre of mass."""
    parents = _parents(core)

    def run(liMi: Array, v: Array, *rest: Array) -> tuple[Any, ...]:
        accelerations, inertias = rest[:-3], rest[-3]
        placed = [pose(M) for M in liMi]
        bodies = [body(row) for row in inertias]
        moving = range(1, len(parents))
        twists = [_motion(row) for row in v]
        momenta = [bodies[k].apply(twists[k]) for k in moving]

        def sums(values: Sequence[Any], nothing: Any) -> list[Any]:
            return _summed(parents, [nothing, *values], lambda i, value: placed[i].act(value))

        h = sums(momenta, spatial.Force.zero())
        moved = sums(bodies[1:], spatial.Inertia.zero())
        centers = np.stack([Y.com for Y in moved])
        rates = np.stack([momentum.linear / Y.mass for momentum, Y in zip(h, moved, strict=True)])
        center = moved[0].com
        results = [_about(center, h[0]), _about_centre(moved[0]), _rows(h), centers, rates]
        if with_rate:
            gains = [
                bodies[k].apply(_motion(accelerations[0][k])) + twists[k].cross(momenta[k - 1])
                for k in moving
            ]
            f = sums(gains, spatial.Force.zero())
            results = [_about(center, f[0]), _rows(f), *results]
        return tuple(results)

    return run


def _rows(forces: Sequence[spatial.Force]) -> Array:
    return np.stack([force.vector() for force in forces])


def _about(point: Array, total: spatial.Force) -> Array:
    """A force or a momentum about a point, in place of the origin."""
    return np.concatenate([total.linear, total.angular - cross(point, total.linear)])


def _about_centre(Y: spatial.Inertia) -> Array:
    """An inertia about its own centre of mass, as an Inertia stores it."""
    return np.concatenate([[Y.mass, 0.0, 0.0, 0.0], np.reshape(Y.inertia, 9)])


_MOMENTUM_FIELDS = ("hg", "Ig", "h", "com", "vcom")
MOMENTUM = OfFields(
    "centroidal momentum of fields",
    ("liMi", "v"),
    _MOMENTUM_FIELDS,
    lambda core: _momentum(core, False),
)
MOMENTUM_RATE = OfFields(
    "centroidal momentum rate of fields",
    ("liMi", "v", "a"),
    ("dhg", "f", *_MOMENTUM_FIELDS),
    lambda core: _momentum(core, True),
)


def _centers(core: CoreModel, level: int) -> Any:
    """Centres of mass of what each joint moves, in its frame, and their rates up to a level."""
    parents = _parents(core)

    def run(liMi: Array, *rest: Array) -> tuple[Any, ...]:
        motions, inertias = rest[:-3], rest[-3]
        masses = _summed(parents, _masses(inertias), lambda _, mass: mass)
        own = [_points(row, [x[k] for x in motions]) for k, row in enumerate(inertias)]
        results = []
        for order in range(level + 1):
            shares = [mass * points[order] for mass, points in zip(_masses(inertias), own, strict=True)]
            moved = (lambda i, x: liMi[i][:3, :3] @ x) if order else None
            sums = _summed(
                parents, shares, moved or (lambda i, x: liMi[i][:3, :3] @ x + masses[i] * liMi[i][:3, 3])
            )
            results.append(np.stack([x / mass for x, mass in zip(sums, masses, strict=True)]))
        return tuple(results)

    return run


def _masses(inertias: Array) -> list[Any]:
    """The mass of each body; that of the universe does not count."""
    return [0.0 * inertias[0][0], *(row[0] for row in inertias[1:])]


def _points(inertia: Array, motions: Sequence[Array]) -> list[Array]:
    """The centre of mass of a body, its velocity and its acceleration, as far as the twist and the acceleration go."""
    points = [inertia[1:4]]
    for k, motion in enumerate(motions):
        rate = motion[:3] + cross(motion[3:], inertia[1:4])
        points.append(rate + cross(motions[0][3:], points[1]) if k else rate)
    return points


CENTERS = tuple(
    OfFields(
        f"centre of mass of fields {level}",
        ("liMi", "v", "a")[: level + 1],
        ("com", "vcom", "acom")[: level + 1],
        lambda core, level=level: _centers(core, level),
    )
    for level in range(3)
)


def _columns_of(core: CoreModel, oMi: Array, q: Array) -> list[list[Motion]]:
    """The columns of each joint in the world, the universe first."""
    columns: list[list[Motion]] = [[]]
    for joint, T in zip(core.joints, oMi[1:], strict=True):
        columns.append([pose(T).act(S) for S in joint.kind.motion_subspace(joint.q_of(q))])
    return columns


def _jacobian(core: CoreModel, columns: Sequence[Sequence[Array]]) -> Array:
    """The matrix whose columns these are, of joints in their order."""
    found = {}
    for joint, own in zip(core.joints, columns[1:], strict=True):
        found |= {joint.idx_v + k: column for k, column in enumerate(own)}
    return np.stack([found[k] for k in range(core.nv)], axis=-1)


def _all_columns(core: CoreModel) -> Any:
    def run(oMi: Array, q: Array, *_: Array) -> tuple[Array]:
        columns = _columns_of(core, oMi, q)
        return (_jacobian(core, [[column.vector() for column in own] for own in columns]),)

    return run


def _center_columns(core: CoreModel) -> Any:
    """The Jacobian of the centre of mass, all columns, and the centres of what each joint moves, in its frame."""
    parents = _parents(core)

    def run(oMi: Array, q: Array, inertias: Array, *_: Array) -> tuple[Array, ...]:
        masses = _masses(inertias)
        placed = [T[:3, :3] @ row[1:4] + T[:3, 3] for T, row in zip(oMi, inertias, strict=True)]
        shares = [mass * point for mass, point in zip(masses, placed, strict=True)]
        moments = _summed(parents, shares, lambda _, moment: moment)
        masses = _summed(parents, masses, lambda _, mass: mass)
        columns = _columns_of(core, oMi, q)
        of_center = [
            [(mass * column.linear + cross(column.angular, moment)) / masses[0] for column in own]
            for own, mass, moment in zip(columns, masses, moments, strict=True)
        ]
        J = _jacobian(core, [[column.vector() for column in own] for own in columns])
        centers = [
            T[:3, :3].T @ (moment / mass - T[:3, 3])
            for T, moment, mass in zip(oMi, moments, masses, strict=True)
        ]
        centers[0] = moments[0] / masses[0]
        return _jacobian(core, of_center), np.stack(centers), J

    return run


COLUMNS = OfFields("joint Jacobians of fields", ("oMi", "placements q"), ("J",), _all_columns)
CENTER_COLUMNS = OfFields(
    "centre of mass Jacobian of fields", ("oMi", "placements q"), ("Jcom", "com", "J"), _center_columns
)


def columns_of_fields(model: Model, data: Data, algorithm: OfFields) -> Any:
    """Runs one of `COLUMNS` and `CENTER_COLUMNS`, whose columns are then of the placements' configuration.

    Args:
        model: The model.
        data: Its data, which is filled.
        algorithm: Which one.

    Returns:
        What it returns; NotImplemented for models with mimic joints, whose columns are not separate.
    """
    if model.nvExtended != model.nv:
        return NotImplemented
    result = algorithm.run(model, data)
    data._q_of_jacobians = data._q
    return result
