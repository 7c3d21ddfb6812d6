"""A robot that contacts and closed loops bind: its motion, the forces that bind it, and impacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ulna.algorithms import ConstrainedMotion, Friction, Impact, Proximal
from ulna.algorithms.multibody.references import Reference
from ulna.checks.arrays import batched_array
from ulna.errors import InputError, ShapeError
from ulna.methods.base import Part
from ulna.methods.dynamics import Forces, stacked
from ulna.model import Constraint
from ulna.model.constraint import listed
from ulna.numeric import is_symbolic
from ulna.typing import Array, ArrayLike

AnyConstraints = Sequence[Constraint] | Constraint
"""What binds the robot: a list of constraints, or one."""

_IDENTITY = np.eye(4)
_DEFAULT = Proximal()


class Constraints(Part):
    """Motion of a robot whose frames are constrained.

    Constraints are a list of `ulna.model.PointContact`, `FrameContact`, `PointLoop` and `FrameLoop`. They bind m rows,
    constraint after constraint, linear part first: three for a point, six for a frame. Forces of constraints
    come in these rows: what is exerted on the first frame of each, at its origin, along the world's axes unless the
    constraint says axes="local".

    `solver` is an `ulna.algorithms.Proximal`. The default returns the right acceleration also when constraints depend
    on each other (four flat feet, a planar linkage closed in space); of all forces that do, those of least sum of
    squares.
    """

    __slots__ = ()

    def constrained_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        constraints: AnyConstraints,
        forces: Forces = None,
        reference: Reference = "local_world_aligned",
        friction: bool | Friction = False,
        *,
        anchors: ArrayLike | Sequence[ArrayLike] | None = None,
        kp: ArrayLike | None = None,
        kd: ArrayLike | None = None,
        solver: Proximal = _DEFAULT,
    ) -> ConstrainedMotion:
        """The joint accelerations that the torques `tau` give under constraints, and the forces of these.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv) [rad/s or m/s].
            tau: Joint torques, (..., nv) [N m or N].
            constraints: The constraints.
            forces: External forces: frame name -> wrench (..., 6) [N, N m].
            reference: How those wrenches are written.
            friction: Whether friction brakes the motion.
            anchors: Where the contacts hold, one for each in their order: points (..., 3) [m] of point contacts, poses
                (..., 4, 4); such as `robot.fk(q0, names)` returns, or `constraint_anchors`.
            kp: Gain [1/s^2] that pulls constraints together that have drifted apart; one number, or one for each;
                None for 0.
            kd: Gain [1/s] that brakes their drift; None for critical damping, 2 sqrt(kp), which is 0 for kp = 0.
            solver: The method that computes the forces.

        Returns:
            `a` (..., nv), `forces` (..., m), `residual` (...) and `iterations` (...). The residual is the largest entry
            of J a + bias + kd velocity + kp error: near zero, or the constraints contradict each other and are kept in
            the sense of least squares.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be what it stands for.
            UnknownName: If there is no such frame or reference.
            InputError: If a constraint binds nothing, a gain is negative, or kp has contacts without anchors.

        Reference: Featherstone 2008, section 8.4; Carpentier, Budhiraja & Mansard 2021; Baumgarte 1972.
        """
        options: dict[str, Any] = {"constraints": listed(constraints)}
        arrays: list[Any] = [q, v, tau]
        if forces:
            options |= {"forces": tuple(forces), "reference": reference}
            arrays.append(stacked(forces))
        stabilised = kp is not None or kd is not None
        options |= {"friction": friction, "stabilised": stabilised}
        if stabilised:
            arrays += _pull(options["constraints"], anchors, kp, kd)
        elif anchors is not None:
            raise InputError(
                "`anchors` pull nothing without a gain; give `kp` too, such as kp=100.0 [1/s^2]."
            )
        if solver is not _DEFAULT:
            options["solver"] = _solver(solver)
        return ConstrainedMotion(*self._checked("constrained_dynamics", **options)(*arrays))

    def forward_dynamics_with_jacobian(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        J: ArrayLike,
        drift: ArrayLike,
        compliance: ArrayLike | None = None,
        solver: Proximal = _DEFAULT,
    ) -> ConstrainedMotion:
        """The same for constraints of your own: J a + drift + compliance forces = 0.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv) [rad/s or m/s].
            tau: Joint torques, (..., nv) [N m or N].
            J: Constraint Jacobian, (..., m, nv).
            drift: dJ/dt v and whatever stabilises, (..., m).
            compliance: How far forces make the constraints yield, (...) [1/kg]; None for not at all.
            solver: The method that computes the forces.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be what it stands for.
        """
        shape = np.shape(J)
        if len(shape) < 2 or 0 in shape[-2:]:
            raise ShapeError("J", shape, f"(..., m, {self.model.nv}) with m from 1")
        options = {"rows": shape[-2], "compliant": compliance is not None, "solver": _solver(solver)}
        soft = () if compliance is None else (compliance,)
        kernel = self._checked("forward_dynamics_with_jacobian", **options)
        return ConstrainedMotion(*kernel(q, v, tau, J, drift, *soft))

    def impulse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        constraints: AnyConstraints,
        restitution: ArrayLike = 0.0,
        solver: Proximal = _DEFAULT,
    ) -> Impact:
        """The velocity after constraints have taken hold at once, as at a touch-down, and their impulses.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity before, (..., nv) [rad/s or m/s].
            constraints: The constraints from now on.
            restitution: Coefficient of restitution of a constraint, in [0, 1]; one number, or one for each.
            solver: The method that computes the impulses.

        Returns:
            `v` (..., nv), `impulses` (..., m) [N s, N m s], `residual` (...) [m/s, rad/s] and `iterations` (...).

        Raises:
            ShapeError, DtypeError, NonFiniteError, UnknownName, InputError: As for `constrained_dynamics`.

        Reference: Featherstone 2008, section 11.7.
        """
        listing = listed(constraints)
        options: dict[str, Any] = {"constraints": listing, "solver": _solver(solver)}
        if isinstance(restitution, (int, float)) and restitution == 0.0:
            return Impact(*self._checked("impulse_dynamics", **options)(q, v))
        back = _one_each("restitution", restitution, len(listing))
        if not is_symbolic(back) and not ((back >= 0.0) & (back <= 1.0)).all():
            raise InputError(f"`restitution` is {restitution}; expected numbers in [0, 1].")
        return Impact(*self._checked("impulse_dynamics", **options, elastic=True)(q, v, back))

    def delassus_matrix(self, q: ArrayLike, constraints: AnyConstraints) -> Any:
        """What forces do to the constraint acceleration, J M^-1 J^T, (..., m, m) [1/kg, 1/(kg m), 1/(kg m^2)]."""
        return self._checked("delassus_matrix", constraints=listed(constraints))(q)

    def constraint_jacobian(self, q: ArrayLike, constraints: AnyConstraints) -> Any:
        """The matrix that makes the constraint velocity out of `v`, (..., m, nv)."""
        return self._checked("constraint_jacobian", constraints=listed(constraints))(q)

    def constraint_velocity(self, q: ArrayLike, v: ArrayLike, constraints: AnyConstraints) -> Any:
        """How the first frames move as the second ones, or the world, see it, (..., m) [m/s, rad/s]."""
        return self._checked("constraint_velocity", constraints=listed(constraints))(q, v)

    def constraint_bias(self, q: ArrayLike, v: ArrayLike, constraints: AnyConstraints) -> Any:
        """The rate of that velocity when the joints do not accelerate, dJ/dt v, (..., m) [m/s^2, rad/s^2]."""
        return self._checked("constraint_bias", constraints=listed(constraints))(q, v)

    def constraint_error(
        self,
        q: ArrayLike,
        constraints: AnyConstraints,
        anchors: ArrayLike | Sequence[ArrayLike] | None = None,
    ) -> Any:
        """How far the first frames are from where they are held, (..., m) [m, rad]: places, then rotation vectors.

        Contacts need `anchors`, as in `constrained_dynamics`; loops have none.
        """
        checked = listed(constraints)
        contacts = [constraint for constraint in checked if constraint.is_contact]
        if contacts and anchors is None:
            raise InputError(
                "Contacts have an error only against anchors; give anchors=robot.constraint_anchors(q0, constraints)."
            )
        poses = (_poses(anchors, contacts),) if contacts else ()
        return self._checked("constraint_error", constraints=checked)(q, *poses)

    def constraint_anchors(self, q: ArrayLike, constraints: AnyConstraints) -> Any:
        """Where the contacts among the constraints are, as poses in the world, (..., contacts, 4, 4).

        Taken where contacts take hold, they are the `anchors` that keep them there.
        """
        poses = [
            self._checked("fk", frame=name)(q) @ placement.matrix()
            for constraint in listed(constraints)
            if constraint.is_contact
            for name, placement in constraint.ends()
        ]
        if not poses:
            raise InputError("There is no contact among the constraints; loops need no anchors.")
        return np.stack(poses, axis=-3)


def _solver(value: Any) -> Proximal:
    if not isinstance(value, Proximal):
        raise InputError(
            f"`solver` is {value!r}; expected an ulna.algorithms.Proximal, such as Proximal(mu=0.0)."
        )
    return value


def _pull(constraints: Sequence[Constraint], anchors: Any, kp: Any, kd: Any) -> list[Array]:
    """The further arguments of the kernel: anchors, if there are contacts, and kp and kd of each, (..., count, 2)."""
    count = len(constraints)
    stiff = _gains("kp", 0.0 if kp is None else kp, count)
    if kd is None and is_symbolic(stiff):
        raise InputError("`kd` is not given; expected it where `kp` is an input of your own function.")
    brake = 2.0 * np.sqrt(stiff) if kd is None else _gains("kd", kd, count)
    gains = np.stack(np.broadcast_arrays(stiff, brake), axis=-1)
    contacts = [constraint for constraint in constraints if constraint.is_contact]
    if not contacts:
        return [gains]
    if anchors is None and kp is not None:
        raise InputError(
            "`kp` pulls contacts to their anchors, and there are none; give "
            "anchors=robot.constraint_anchors(q0, constraints) of the configuration where they took hold."
        )
    return [_poses(anchors, contacts), gains]


def _gains(name: str, value: ArrayLike, count: int) -> Array:
    gains = _one_each(name, value, count)
    if not is_symbolic(gains) and not (gains >= 0.0).all():
        raise InputError(f"`{name}` is {value}; expected gains that are not below zero.")
    return gains


def _one_each(name: str, numbers: ArrayLike, count: int) -> Array:
    """One number for all, or one for each constraint, as (..., count)."""
    value = batched_array(name, numbers, ())
    if value.ndim == 0:
        return np.broadcast_to(value, (count,))
    if value.shape[-1] != count:
        raise ShapeError(name, value.shape, f"one number, or one for each of {count} constraints")
    return value


def _poses(anchors: Any, contacts: Sequence[Constraint]) -> Array:
    """Anchors as poses, (..., contacts, 4, 4); of none as many identities."""
    count = len(contacts)
    if anchors is None:
        return np.broadcast_to(_IDENTITY, (count, 4, 4))
    if isinstance(anchors, Mapping):
        raise InputError("`anchors` is a dictionary; expected one anchor for each contact, in their order.")
    expected = f"one for each of {count} contacts: (..., {count}, 4, 4), or (..., {count}, 3) for points"
    if isinstance(anchors, np.ndarray):
        if anchors.shape[-3:] == (count, 4, 4):
            return anchors
        if anchors.shape[-2:] != (count, 3):
            raise ShapeError("anchors", anchors.shape, expected)
        anchors = [anchors[..., i, :] for i in range(count)]
    if len(anchors) != count:
        raise ShapeError("anchors", (len(anchors),), expected)
    poses = [_pose(np.asarray(a), i, c) for i, (a, c) in enumerate(zip(anchors, contacts, strict=True))]
    return np.stack(np.broadcast_arrays(*poses), axis=-3)


def _pose(anchor: Array, index: int, contact: Constraint) -> Array:
    if anchor.shape[-2:] == (4, 4):
        return anchor
    if contact.size == 3 and anchor.shape[-1:] == (3,):
        pose = np.zeros((*anchor.shape[:-1], 4, 4), dtype=anchor.dtype) + _IDENTITY
        pose[..., :3, 3] = anchor
        return pose
    expected = "(..., 3) [m] or (..., 4, 4)" if contact.size == 3 else "(..., 4, 4)"
    raise ShapeError(f"anchors[{index}]", anchor.shape, expected)
