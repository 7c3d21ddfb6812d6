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

import functools
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from pinocchio._algorithms.of_fields import OfFields, inputs_by_name
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from pinocchio._spatial.small_kernels import as_motion, body, pose
from ulna import spatial
from ulna.compiler.runtime.repeated_calls import CallCache
from ulna.model import Model as CoreModel
from ulna.numeric import cross, dot, is_symbolic, less, where
from ulna.spatial import Motion
from ulna.typing import Array

Sum = TypeVar("Sum")


def _parents(core: CoreModel) -> list[int]:
    """The joint before each joint, the universe first."""
    return [0, *(joint.parent + 1 for joint in core.joints)]


def _summed(parents: Sequence[int], values: Sequence[Sum], carried: Callable[[int, Any], Any]) -> list[Any]:
    """For each joint, the universe first, the sum of what it moves."""
    sums: list[Any] = list(values)
    for i in range(len(sums) - 1, 0, -1):
        sums[parents[i]] = sums[parents[i]] + carried(i, sums[i])
    return sums


def _kinetic_of(v: Array, rate: Array, inertias: Array, armature: Array) -> Any:
    energy = 0.5 * dot(rate * armature, rate)
    for k in range(1, len(v)):
        V = as_motion(v[k])
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


KINETIC_ENERGY = OfFields(
    "kinetic energy of fields", ("v", "velocities v"), ("energy K",), _kinetic, holder=float
)
POTENTIAL_ENERGY = OfFields("potential energy of fields", ("oMi",), ("energy P",), _potential, holder=float)
MECHANICAL_ENERGY = OfFields(
    "mechanical energy of fields",
    ("oMi", "v", "velocities v"),
    ("energy K", "energy P", "energy K + P"),
    _mechanical,
    2,
    holder=float,
)


def _momentum(core: CoreModel, with_rate: bool) -> Any:
    """Momenta of what each joint moves, and the rates of these, in its frame; of all about the centre of mass."""
    parents = _parents(core)

    def run(liMi: Array, v: Array, *rest: Array) -> tuple[Any, ...]:
        accelerations, inertias = rest[:-3], rest[-3]
        placed = [pose(M) for M in liMi]
        bodies = [body(row) for row in inertias]
        moving = range(1, len(parents))
        twists = [as_motion(row) for row in v]
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
                bodies[k].apply(as_motion(accelerations[0][k])) + twists[k].cross(momenta[k - 1])
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


_MASSES = (("computeSubtreeMasses", ("mass",)),)
_MOMENTUM_FIELDS = ("hg", "Ig", "h", "com", "vcom")
MOMENTUM = OfFields(
    "centroidal momentum of fields",
    ("liMi", "v"),
    _MOMENTUM_FIELDS,
    lambda core: _momentum(core, False),
    leaves=_MASSES,
    answer="hg",
)
MOMENTUM_RATE = OfFields(
    "centroidal momentum rate of fields",
    ("liMi", "v", "a"),
    ("dhg", "f", *_MOMENTUM_FIELDS),
    lambda core: _momentum(core, True),
    leaves=_MASSES,
    answer="dhg",
)


def _centers(core: CoreModel) -> Any:
    """Centres of mass of what each joint moves, in its frame, and their rates where motions are of the placements."""
    parents = _parents(core)
    own_masses = [0.0, *(Y.mass for Y in core.inertias)]
    masses = _summed(parents, own_masses, lambda _, mass: mass)

    def run(x: dict[str, Array]) -> tuple[Any, ...]:
        liMi, coms = x["liMi"], [np.zeros(3), *(Y.com for Y in core.inertias)]
        own = [_points(com, x["v"][k], x["a"][k]) for k, com in enumerate(coms)]

        def carried(i: int, sums: Array) -> Array:
            R, p = liMi[i][:3, :3], liMi[i][:3, 3]
            position, velocity, acceleration = (R @ one for one in sums)
            return np.stack([position + masses[i] * p, velocity, acceleration])

        shares = [mass * points for mass, points in zip(own_masses, own, strict=True)]
        sums = _summed(parents, shares, carried)
        results = np.stack([_quotient(total, mass) for total, mass in zip(sums, masses, strict=True)], axis=1)
        return results[0, 0], *_of_known_motions(x, *results)

    return run


def _quotient(total: Array, mass: Any) -> Array:
    """A sum of shares by the mass of all, nan where nothing has mass."""
    if not is_symbolic(mass) and not mass:
        return np.full(np.shape(total), np.nan)
    return total * (1.0 / mass)


def _of_known_motions(x: dict[str, Array], com: Array, vcom: Array, acom: Array) -> list[Array]:
    """Centres, and their rates, marks and state; all but centres stay what they are where motions are of another q."""
    gaps = [x[f"{name} q"] - x["placements q"] for name in ("velocities", "accelerations")]
    moves = less(gaps[0] @ gaps[0], _TINY)
    accelerates = less(gaps[0] @ gaps[0] + gaps[1] @ gaps[1], _TINY)
    state = [where(moves, x[f"velocities {k}"], x[f"center_velocities {k}"]) for k in "qv"]
    rates = [where(moves, vcom, x["kept vcom"]), where(accelerates, acom, x["kept acom"])]
    marks = [where(moves, 0.0, x["mark of vcom"]), where(accelerates, 0.0, x["mark of acom"])]
    return [com, *rates, *marks, *state]


_TINY = 1e-300
_CENTER_READS = (
    *("liMi", "v", "a", "kept vcom", "kept acom", "mark of vcom", "mark of acom"),
    *("placements q", "velocities q", "velocities v", "accelerations q", "center_velocities q"),
    "center_velocities v",
)


def _masses(inertias: Array) -> list[Any]:
    """The mass of each body; that of the universe does not count."""
    return [0.0 * inertias[0][0], *(row[0] for row in inertias[1:])]


def _points(com: Array, v: Array, a: Array) -> Array:
    """The centre of mass of a body, its velocity and its acceleration, (3, 3)."""
    rate = v[:3] + cross(v[3:], com)
    return np.stack([com, rate, a[:3] + cross(a[3:], com) + cross(v[3:], rate)])


CENTERS = tuple(
    OfFields(
        f"centre of mass of fields {level}",
        _CENTER_READS,
        (
            "",
            "com",
            "vcom",
            "acom",
            "mark of vcom",
            "mark of acom",
            "center_velocities q",
            "center_velocities v",
        ),
        _centers,
        same=(("velocities q", "placements q"), ("accelerations q", "placements q"))[:level],
        of_numbers=True,
        depends_on="inertias",
        stores=(("centers q", "placements q"),),
        leaves=_MASSES,
        state="placements",
    )
    for level in range(3)
)
"""For each `KinematicLevel` the one that applies where motions up to it are of the placements."""


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


def _moments_in_world(oMi: Array, inertias: Array) -> list[tuple[Any, Array]]:
    """The mass of each body, and mass times centre in the world; the universe's do not count."""
    masses = _masses(inertias)
    return [
        (mass, mass * (T[:3, :3] @ row[1:4] + T[:3, 3]))
        for mass, T, row in zip(masses, oMi, inertias, strict=True)
    ]


def _center_rate_columns(core: CoreModel, taken: tuple[str, ...]) -> Any:
    """The derivative of the velocity of the centre of mass by q: see `_velocity_change`."""
    parents = _parents(core)

    def run(*args: Array) -> tuple[Array]:
        x = inputs_by_name((*_CENTER_RATE_READS, *taken), args)
        oMi, inertias = x["oMi"], x["inertias"]
        moments = _moments_in_world(oMi, inertias)
        twists = [
            Motion.zero(),
            *(pose(T).act(as_motion(v)) for T, v in zip(oMi[1:], x["v"][1:], strict=True)),
        ]
        momenta = [
            mass * V.linear + cross(V.angular, moment)
            for (mass, moment), V in zip(moments, twists, strict=True)
        ]
        masses = _summed(parents, [mass for mass, _ in moments], lambda _, y: y)
        firsts = _summed(parents, [moment for _, moment in moments], lambda _, y: y)
        p = _summed(parents, momenta, lambda _, y: y)
        masses = list(x["mass"]) if "mass" in x else masses
        columns = _columns_of(core, oMi, x["velocities q"])
        changes: list[list[Array]] = [[]]
        for i in range(1, len(parents)):
            first = masses[i] * (oMi[i][:3, :3] @ x["com"][i] + oMi[i][:3, 3]) if "com" in x else firsts[i]
            momentum = masses[i] * (oMi[i][:3, :3] @ x["vcom"][i]) if "vcom" in x else p[i]
            before = twists[parents[i]]
            changes.append(
                [_velocity_change(s, before, masses[i], first, momentum) / masses[0] for s in columns[i]]
            )
        return (_jacobian(core, changes),)

    return run


def _velocity_change(s: Motion, before: Motion, mass: Any, first: Array, momentum: Array) -> Array:
    """How the momentum of what column s moves, beyond a joint with the twist `before`, changes by its coordinate."""
    displaced = mass * s.linear + cross(s.angular, first)
    relative = momentum - mass * before.linear - cross(before.angular, first)
    return cross(before.angular, displaced) + cross(s.angular, relative)


_CENTER_RATE_READS = ("oMi", "v", "velocities q")
CENTER_RATE_COLUMNS = OfFields(
    "centre of mass velocity derivatives of fields",
    _CENTER_RATE_READS,
    ("",),
    _center_rate_columns,
    if_read=("com", "vcom", "mass"),
    known_of=(("com", "centers"), ("vcom", "center_velocities")),
    same=(("placements q", "velocities q"),),
    state="velocities",
)


@functools.cache
def subtree_columns(root: int, is_anew: bool) -> OfFields:
    """The Jacobian (3, nv) of the centre of mass of what a joint moves.

    Args:
        root: The joint.
        is_anew: Whether all columns are computed of `oMi`, which fills J; else J is read.

    Returns:
        The algorithm.
    """

    def build(core: CoreModel, taken: tuple[str, ...]) -> Any:
        return lambda *args: _subtree_results(core, root, inputs_by_name((*reads, *taken), args))

    if is_anew:
        reads = ("oMi", "placements q")
        return OfFields(
            f"subtree Jacobian {root} at placements",
            reads,
            ("", "J", "com[0]"),
            lambda core: build(core, ()),
            stores=(("jacobians q", "placements q"),),
            leaves=(("subtree_jacobian", ("com", "mass", "Jcom")),),
            state="placements",
            depends_on="masses",
        )
    reads = ("oMi", "J")
    return OfFields(
        f"subtree Jacobian {root}",
        reads,
        ("",),
        build,
        if_read=("Jcom", "com", "mass"),
        known_of=(("Jcom", "center_jacobian"), ("com", "centers")),
        same=(("placements q", "jacobians q"),),
        state="jacobians",
        depends_on="masses",
    )


def _subtree_results(core: CoreModel, root: int, x: dict[str, Array]) -> tuple[Array, ...]:
    parents, oMi = _parents(core), x["oMi"]
    moments = _moments_in_world(oMi, x["inertias"])
    masses = _summed(parents, [mass for mass, _ in moments], lambda _, y: y)
    firsts = _summed(parents, [moment for _, moment in moments], lambda _, y: y)
    center = firsts[0] / masses[0]
    masses = list(x["mass"]) if "mass" in x else masses
    if "J" in x:
        columns = [
            [as_motion(x["J"][:, joint.idx_v + k]) for k in range(joint.kind.nv)] for joint in core.joints
        ]
    else:
        columns = _columns_of(core, oMi, x["placements q"])[1:]
    chain = {root}
    while parents[min(chain)]:
        chain.add(parents[min(chain)])
    own = (
        firsts[root] / masses[root]
        if "com" not in x
        else oMi[root][:3, :3] @ x["com"][root] + oMi[root][:3, 3]
    )
    moved = {root}
    found: list[list[Array]] = [[]]
    for i, of_joint in enumerate(columns, start=1):
        if (i > root and parents[i] in moved) or not root:
            moved.add(i)
        if i in moved and "Jcom" in x:
            first = core.joints[i - 1].idx_v
            share = masses[0] / masses[root] if root else 1.0
            found.append([share * x["Jcom"][:, first + k] for k in range(len(of_joint))])
        elif i in moved:
            found.append(
                [(masses[i] * s.linear + cross(s.angular, firsts[i])) / masses[root] for s in of_joint]
            )
        else:
            found.append([s.linear + cross(s.angular, own) if i in chain else np.zeros(3) for s in of_joint])
    J = _jacobian(core, found)
    if "J" in x:
        return (J,)
    return J, _jacobian(core, [[], *([s.vector() for s in of_joint] for of_joint in columns)]), center


COLUMNS = OfFields(
    "joint Jacobians of fields",
    ("oMi", "placements q"),
    ("J",),
    _all_columns,
    stores=(("jacobians q", "placements q"),),
)
CENTER_COLUMNS = OfFields(
    "centre of mass Jacobian of fields",
    ("oMi", "placements q"),
    ("Jcom", "com", "J"),
    _center_columns,
    stores=(
        ("jacobians q", "placements q"),
        ("center_jacobian q", "placements q"),
        ("centers q", "placements q"),
    ),
    leaves=_MASSES,
    state="placements",
)


def columns_of_fields(model: Model, data: Data, calls: CallCache, algorithm: OfFields) -> Any:
    """Runs one of `COLUMNS` and `CENTER_COLUMNS`, whose columns are then of the placements' configuration.

    Args:
        model: The model.
        data: Its data, which is filled.
        calls: The cache of calls that return what this does.
        algorithm: Which one.

    Returns:
        What it returns; NotImplemented for models with mimic joints, whose columns are not separate.
    """
    if model.nvExtended != model.nv:
        return NotImplemented
    result = algorithm.run(model, data, calls)
    data._known_states |= {name.split()[0] for name, _ in algorithm.stores}
    return result
