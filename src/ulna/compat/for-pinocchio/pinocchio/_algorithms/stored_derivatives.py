"""Derivatives of dynamics and of momenta, and the Coriolis matrix, out of the fields of a Data as they are.

| symbol | meaning |
|---|---|
| J_k, dJ_k | column k of the Jacobian in the world, and its rate |
| V_i, A_i | twist and spatial acceleration of joint i in the world |
| V_p, A_p | those of the joint before that of column k |
| Y, h, D | inertia of a body about the world's origin, its momentum, and the rate of its second moment |
| B | half of V x* Y - Y V x + (. x* h): C_ij = J_i . (B J_j + Y dJ_j) of what the outer one of both joints moves |
| psi_k, chi_k | V_p x J_k; A_p x J_k + V_p x psi_k: the changes of the twist and of the acceleration of what k moves |

Sources: Carpentier and Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms (2018); Echeandia and Wensing,
Numerical Methods to Compute the Coriolis Matrix and Christoffel Symbols (2021).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from pinocchio._algorithms.of_fields import OfFields, inputs_by_name
from pinocchio._spatial.small_kernels import as_force, as_motion, body, pose, spread
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.mass_moments import MassMoments
from ulna.model import Model as CoreModel
from ulna.numeric import apply, cross
from ulna.spatial import Force, Motion
from ulna.typing import Array


class Rates(NamedTuple):
    """What B of bodies is made of: sum and difference of the linear momenta of Y V and h, angular part of h, and D."""

    sum: Array
    difference: Array
    angular: Array
    D: Array

    @classmethod
    def of_body(cls, Y: MassMoments, V: Motion, h: Force | None) -> Rates:
        """Those of one body.

        Args:
            Y: Its inertia about the world's origin [kg, kg m, kg m^2].
            V: Its twist in the world [m/s, rad/s].
            h: Its momentum in the world [N s, N m s]; None for Y V.

        Returns:
            The rates.
        """
        own = Y.apply(V)
        h = own if h is None else h
        return cls(own.linear + h.linear, own.linear - h.linear, h.angular, Y.rate(V))

    def plus(self, other: Rates) -> Rates:
        """Those of both."""
        sums = self.sum + other.sum, self.difference + other.difference
        return Rates(*sums, self.angular + other.angular, self.D + other.D)

    def apply(self, s: Motion) -> Force:
        """B s."""
        w = s.angular
        turned = apply(self.D, w) + cross(w, self.angular) + cross(self.difference, s.linear)
        return Force(0.5 * cross(w, self.sum), 0.5 * turned)

    def transposed(self, s: Motion) -> Force:
        """The transpose of B times s."""
        w = s.angular
        turned = apply(self.D, w) - cross(w, self.angular) + cross(self.sum, s.linear)
        return Force(-0.5 * cross(self.difference, w), 0.5 * turned)


class Tree(NamedTuple):
    """The joints, the universe first: the joint before each, and the entries of v of each."""

    parents: list[int]
    entries: list[range]

    @classmethod
    def of(cls, core: CoreModel) -> Tree:
        """That of a model."""
        entries = [range(joint.idx_v, joint.idx_v + joint.kind.nv) for joint in core.joints]
        return cls([0, *(joint.parent + 1 for joint in core.joints)], [range(0), *entries])

    def ancestors(self, joint: int) -> Iterator[int]:
        """The joints that move a joint, from the one before it to the first."""
        while joint := self.parents[joint]:
            yield joint

    def summed(
        self, values: Sequence[Any], plus: Callable[[Any, Any], Any] = lambda a, b: a + b
    ) -> list[Any]:
        """For each joint the sum of what it moves, the universe first.

        Args:
            values: A value for each joint but the universe.
            plus: How two of them are added.

        Returns:
            The sums.
        """
        sums = [None, *values]
        for i in range(len(values), 0, -1):
            p = self.parents[i]
            sums[p] = sums[i] if sums[p] is None else plus(sums[p], sums[i])
        return sums


def _bodies(fields: dict[str, Array]) -> list[MassMoments]:
    """The inertia of the body of each joint but the universe, about the world's origin."""
    poses, inertias = fields["oMi"][1:], fields["inertias"][1:]
    return [
        MassMoments.of_body(body(row)).to_outer_frame(pose(T)) for T, row in zip(poses, inertias, strict=True)
    ]


def _in_world(fields: dict[str, Array], name: str) -> list[Motion]:
    """`ov` or `oa` of all joints but the universe: of the field, where it was read, else of `v` or `a`."""
    if "o" + name in fields:
        return [as_motion(row) for row in fields["o" + name][1:]]
    moved = zip(fields["oMi"][1:], fields[name][1:], strict=True)
    return [pose(T).act(as_motion(row)) for T, row in moved]


_CORIOLIS_READS = ("oMi", "J", "dJ", "v", "derivatives q", "derivatives v")


def _coriolis(core: CoreModel, taken: tuple[str, ...]) -> Any:
    tree = Tree.of(core)

    def run(*args: Array) -> tuple[Array]:
        x = inputs_by_name((*_CORIOLIS_READS, *taken), args)
        bodies, twists = _bodies(x), _in_world(x, "v")
        momenta = [as_force(row) for row in x["oh"][1:]] if "oh" in x else [None] * len(bodies)
        rates = [Rates.of_body(*one) for one in zip(bodies, twists, momenta, strict=True)]
        Y, B = tree.summed(bodies), tree.summed(rates, Rates.plus)
        J, dJ = ([as_motion(x[name][:, k]) for k in range(core.nv)] for name in ("J", "dJ"))
        C = batch_zeros((core.nv, core.nv), x["J"][0])
        for joint in range(1, len(Y)):
            before = [i for other in tree.ancestors(joint) for i in tree.entries[other]]
            for k in tree.entries[joint]:
                column = B[joint].apply(J[k]) + Y[joint].apply(dJ[k])
                row, back = Y[joint].apply(J[k]), B[joint].transposed(J[k])
                for i in (*tree.entries[joint], *before):
                    C[i, k] = column.dot(J[i])
                for i in before:
                    C[k, i] = row.dot(dJ[i]) + back.dot(J[i])
        return (C,)

    return run


_OF_DERIVATIVES = (
    *((f"placements {x}", f"derivatives {x}") for x in "q"),
    *((f"jacobians {x}", f"derivatives {x}") for x in "q"),
    *((f"velocities {x}", f"derivatives {x}") for x in "qv"),
    *((f"jacobian_rates {x}", f"derivatives {x}") for x in "qv"),
)
CORIOLIS = OfFields(
    "Coriolis matrix of fields",
    _CORIOLIS_READS,
    ("C",),
    _coriolis,
    if_read=("ov", "oh"),
    unless=(("oh", "subtree momenta"),),
    same=_OF_DERIVATIVES,
    leaves=(("computeCoriolisMatrix", ("B", "Ag")), ("coriolis_after_derivatives", ("dFdv",))),
    state="derivatives",
)

_CENTROIDAL_READS = ("oMi", "J", "dJ", "v", "a", *(f"derivatives {x}" for x in "qva"))


def _centroidal(core: CoreModel, taken: tuple[str, ...]) -> Any:
    tree = Tree.of(core)

    def run(*args: Array) -> tuple[Array, ...]:
        x = inputs_by_name((*_CENTROIDAL_READS, *taken), args)
        return _centroidal_results(core, tree, x)

    return run


class _Whole(NamedTuple):
    """Sums over what each joint moves, the whole robot first: inertias, rates, momenta, forces without weights."""

    Y: list[MassMoments]
    B: list[Rates]
    h: list[Force]
    F: list[Force]
    V: list[Motion]
    A: list[Motion]

    @classmethod
    def of(cls, tree: Tree, x: dict[str, Array]) -> _Whole:
        """Those of fields by their names (...)."""
        bodies, V, A = _bodies(x), _in_world(x, "v"), _in_world(x, "a")
        own = [Y.apply(twist) for Y, twist in zip(bodies, V, strict=True)]
        gains = [Y.apply(a) + v.cross(h) for Y, v, a, h in zip(bodies, V, A, own, strict=True)]
        rates = [Rates.of_body(Y, twist, None) for Y, twist in zip(bodies, V, strict=True)]
        momenta = [as_force(row) for row in x["oh"][1:]] if "oh" in x else own
        sums = tree.summed(bodies), tree.summed(rates, Rates.plus), tree.summed(momenta), tree.summed(gains)
        rest = Motion.zero()
        return cls(*sums, [rest, *V], [rest, *A])


def _centroidal_results(core: CoreModel, tree: Tree, x: dict[str, Array]) -> tuple[Array, ...]:
    """Derivatives about the centre of mass, momentum and rate there and about the origin, inertia, centre."""
    sums = _Whole.of(tree, x)
    whole, h, F = sums.Y[0], sums.h[0], sums.F[0]
    center, gravity = whole.first / whole.mass, x["gravity"]
    weight = Force(whole.mass * gravity, cross(whole.first, gravity))
    through = F - weight
    if "of" in x:
        on_base = [as_force(x["of"][i]) for i, parent in enumerate(tree.parents) if i and not parent]
        through = sum(on_base, Force.zero())
    drift, pull = h.linear / whole.mass, through.linear / whole.mass
    results = [batch_zeros((6, core.nv), x["J"][0]) for _ in range(4)]
    for joint, entries in enumerate(tree.entries):
        for k in entries:
            dh, dF, dF_v, r = _column_changes(sums, tree.parents[joint], joint, k, x)
            dh = Force(dh.linear, dh.angular - cross(r.linear, drift))
            dF = Force(dF.linear, dF.angular - cross(r.linear, pull))
            for matrix, one in zip(results, (dh, dF, dF_v, r), strict=True):
                matrix[:, k] = _about(center, one).vector()
    f = through + weight
    moments = np.reshape(whole.second - whole.mass * spread(center), 9)
    one_body = np.concatenate([[whole.mass, 0.0, 0.0, 0.0], moments])
    about = [_about(center, one).vector() for one in (h, f)]
    return *results, results[3], *about, h.vector(), f.vector(), one_body, center


def _column_changes(sums: _Whole, before: int, joint: int, k: int, x: dict[str, Array]) -> tuple[Force, ...]:
    """dh/dq, dF/dq with weights, dF/dv and dF/da of column k, about the world's origin, or fields that were read."""
    Y, B, V, A = sums.Y[joint], sums.B[joint], sums.V[before], sums.A[before]
    s, ds = (as_motion(x[name][:, k]) for name in ("J", "dJ"))
    psi = V.cross(s)
    r = as_force(x["dFda"][:, k]) if "dFda" in x else Y.apply(s)
    if "dFdq" in x:
        dF = as_force(x["dFdq"][:, k])
    else:
        half = B.apply(psi)
        dF = half + half + Y.apply(A.cross(s) + V.cross(psi)) + s.cross(sums.F[joint])
        dF = Force(dF.linear, dF.angular - cross(r.linear, x["gravity"]))
    if "dFdv" in x:
        dF_v = as_force(x["dFdv"][:, k])
    else:
        half = B.apply(s)
        dF_v = half + half + Y.apply(ds + psi)
    return Y.apply(psi) + s.cross(sums.h[joint]), dF, dF_v, r


def _about(point: Array, total: Force) -> Force:
    """A force or a momentum about a point, in place of the origin."""
    return Force(total.linear, total.angular - cross(point, total.linear))


CENTROIDAL = OfFields(
    "centroidal derivatives of fields",
    _CENTROIDAL_READS,
    ("dHdq", "dFdq", "dFdv", "dFda", "Ag", "hg", "dhg", "oh[0]", "of[0]", "Ig", "com[0]"),
    _centroidal,
    returns=(0, 1, 2, 3),
    if_read=("ov", "oa", "oh", "of", "dFda", "dFdq", "dFdv"),
    unless=(
        *((field, "subtree momenta") for field in ("oh", "of")),
        *((field, "center_columns q") for field in ("dFda", "dFdq", "dFdv")),
    ),
    stores=(("center_columns q", "derivatives q"),),
    same=(*_OF_DERIVATIVES, *((f"accelerations {x}", f"derivatives {x}") for x in "qva")),
    leaves=(
        ("computeCentroidalDynamicsDerivatives", ("oh", "com", "mass", "dAdq", "dAdv", "tau")),
        ("centroidal_derivatives_after_rnea", ("of",)),
    ),
    state="derivatives",
)
