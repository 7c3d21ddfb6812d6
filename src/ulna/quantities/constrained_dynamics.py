"""A robot that contacts and closed loops constrain: its motion, constraint forces, and impacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, final

import numpy as np

from ulna.algorithms import Proximal
from ulna.algorithms.multibody.references import Reference, check_reference
from ulna.errors import InputError, ShapeError
from ulna.model import Constraint
from ulna.model.constraint import listed
from ulna.numeric import is_symbolic
from ulna.quantities import _constraint_kernels as kernels
from ulna.quantities.constraint_arguments import anchor_poses, checked_solver, one_each, stabilisation_arrays
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.forces import FORCE_OPTIONS, Forces, checked_forces, stacked_wrenches
from ulna.quantities.part import Part
from ulna.quantities.quantity import quantity
from ulna.typing import ArrayLike, Floats

if TYPE_CHECKING:
    from ulna.algorithms import ConstrainedDerivatives, ConstrainedMotion, Friction, Impact

AnyConstraints = Sequence[Constraint] | Constraint
"""What constrains the robot: a list of constraints, or one."""

_DEFAULT = Proximal()
_OF: dict[str, Any] = {"constraints": ()}


@final
class Constraints(Part):
    """Motion of a robot whose frames are constrained.

    Constraints are a list of `ulna.model.PointContact`, `FrameContact`, `PointLoop` and `FrameLoop`. They have m rows,
    constraint after constraint, linear part first: three for a point, six for a frame. Forces of constraints
    come in these rows: what is exerted on the first frame of each, at its origin, along the world's axes unless the
    constraint says axes="local".

    `solver` is an `ulna.algorithms.Proximal`. The default returns the right acceleration also when constraints depend
    on each other (four flat feet, a planar linkage closed in space); of all forces that do, those of least sum of
    squares.
    """

    __slots__ = ()

    @quantity(
        kernels.constrained_dynamics,
        "(nv,), (m,), (), ()",
        options={**_OF, **FORCE_OPTIONS, "friction": False, "stabilised": False, "solver": _DEFAULT},
        more=kernels.motion_arguments,
        nodes=(148, 40, 1),
        inverts_mass=True,
        stages=kernels.stages_of_motion,
    )
    def forward_dynamics(
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
        """The joint accelerations that the torques `tau` produce under constraints, and the forces of these.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv) [rad/s or m/s].
            tau: Joint torques, (..., nv) [N m or N].
            constraints: The constraints.
            forces: External forces: frame name -> wrench (..., 6) [N, N m].
            reference: How those wrenches are written.
            friction: Whether friction brakes the motion.
            anchors: Where the contacts hold, one for each in their order: points (..., 3) [m] of point contacts, poses
                (..., 4, 4); such as `robot.fk(q0, names)` returns, or `anchors`.
            kp: Gains [1/s^2] that pull constraints together that have drifted apart, one number or (..., count), for
                each; None for 0.
            kd: Gains [1/s] that brake their drift, one number or (..., count); None for critical damping, 2 sqrt(kp),
                which is 0 for kp = 0.
            solver: The method that computes the forces.

        Returns:
            `a` (..., nv), `forces` (..., m), `residual` (...) and `iterations` (...). The residual is the largest entry
            of J a + bias + kd velocity + kp error: near zero, or the constraints contradict each other and are kept in
            the sense of least squares.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an array has another shape or type, or is not finite.
            UnknownName: If there is no such frame or reference.
            InputError: If a constraint binds nothing, a gain is negative, or kp has contacts without anchors.

        Reference: Featherstone 2008, section 8.4; Carpentier, Budhiraja & Mansard 2021; Baumgarte 1972.
        """
        listing, arrays, frames = listed(constraints), [q, v, tau], ()
        forces = checked_forces(forces)
        check_reference(reference)
        if forces:
            frames = tuple(forces)
            arrays.append(stacked_wrenches(forces))
        stabilised = kp is not None or kd is not None
        if stabilised:
            arrays += stabilisation_arrays(listing, anchors, kp, kd)
        elif anchors is not None:
            raise InputError(
                "`anchors` pull nothing without a gain; give `kp` too, such as kp=100.0 [1/s^2]."
            )
        written = reference if forces else FORCE_OPTIONS["reference"]
        options = (frames, written, friction, stabilised, checked_solver(solver))
        return algorithms.ConstrainedMotion(*self._kernel("constrained_dynamics", listing, *options)(*arrays))

    @quantity(
        kernels.of_frame_pairs(algorithms.constrained_dynamics_derivatives),
        "(nv+m, nv), (nv+m, nv), (nv+m, nv)",
        options=_OF,
        nodes=(900, 400, 30),
        inverts_mass=True,
        columns=kernels.of_frame_pairs(algorithms.columns_of_constrained_derivatives),
        stages=kernels.of_frame_pairs(algorithms.stages_of_constrained_derivatives),
        stages_from=6,
        batches_from=12,
    )
    def forward_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, constraints: AnyConstraints
    ) -> ConstrainedDerivatives:
        """Derivatives of the accelerations and constraint forces of `forward_dynamics` by `q`, `v` and `tau`.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv) [rad/s or m/s].
            tau: Joint torques, (..., nv) [N m or N].
            constraints: The constraints. Where one depends on others, forces are not unique, and all that depends on
                them is nan. Entries that no force changes hold, such as those of another arm on a fixed base.

        Returns:
            `a_q`, `a_v` and `a_tau` (..., nv, nv), `forces_q`, `forces_v` and `forces_tau` (..., m, nv); those by `q`
            along its tangent space. The constraints are kept as by the exact solver, `Proximal(mu=0.0)`.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an array has another shape or type, or is not finite.
            UnknownName: If there is no such frame.
            InputError: If a constraint binds nothing, or is a FrameLoop.

        Reference: Carpentier & Mansard 2018, section III.
        """
        kernel = self._kernel("constrained_dynamics_derivatives", listed(constraints))
        matrices, n = kernel(q, v, tau), self.model.nv
        return algorithms.ConstrainedDerivatives(
            *(x[..., :n, :] for x in matrices), *(x[..., n:, :] for x in matrices)
        )

    @quantity(
        kernels.forward_dynamics_with_jacobian,
        "(nv,), (m,), (), ()",
        arrays=("q", "v", "tau"),
        options={"rows": 1, "compliant": False, "solver": _DEFAULT},
        more=kernels.jacobian_arguments,
        nodes=(148, 40, 1),
        inverts_mass=True,
    )
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
        """The joint accelerations under your own constraints, J a + drift + compliance forces = 0, and their forces.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv) [rad/s or m/s].
            tau: Joint torques, (..., nv) [N m or N].
            J: Constraint Jacobian, (..., m, nv).
            drift: dJ/dt v and whatever stabilises, (..., m).
            compliance: How far forces make the constraints yield, (...) [1/kg]; None for not at all.
            solver: The method that computes the forces.

        Returns:
            `a`, `forces`, `residual` and `iterations`, as from `forward_dynamics`.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an array has another shape or type, or is not finite.
        """
        shape = np.shape(J)
        if len(shape) < 2 or 0 in shape[-2:]:
            raise ShapeError("J", shape, f"(..., m, {self.model.nv}) with m from 1")
        soft = () if compliance is None else (compliance,)
        options = (shape[-2], compliance is not None, checked_solver(solver))
        return algorithms.ConstrainedMotion(
            *self._kernel("forward_dynamics_with_jacobian", *options)(q, v, tau, J, drift, *soft)
        )

    @quantity(
        kernels.impulse_dynamics,
        "(nv,), (m,), (), ()",
        options={**_OF, "elastic": False, "solver": _DEFAULT},
        more=kernels.impact_arguments,
        nodes=(100, 40, 1),
        inverts_mass=True,
        stages=kernels.stages_of_impact,
    )
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
            restitution: Coefficient of restitution in [0, 1]; one number, or (..., count) for each constraint.
            solver: The method that computes the impulses.

        Returns:
            `v` (..., nv), `impulses` (..., m) [N s, N m s], `residual` (...) [m/s, rad/s] and `iterations` (...).

        Raises:
            ShapeError, DtypeError, NonFiniteError, UnknownName, InputError: As for `forward_dynamics`.

        Reference: Featherstone 2008, section 11.7.
        """
        listing, checked = listed(constraints), checked_solver(solver)
        if isinstance(restitution, (int, float)) and restitution == 0.0:
            return algorithms.Impact(*self._kernel("impulse_dynamics", listing, False, checked)(q, v))
        back = one_each("restitution", restitution, len(listing))
        if not is_symbolic(back) and not ((back >= 0.0) & (back <= 1.0)).all():
            raise InputError(f"`restitution` is {restitution}; expected numbers in [0, 1].")
        return algorithms.Impact(*self._kernel("impulse_dynamics", listing, True, checked)(q, v, back))

    @quantity(
        kernels.of_frame_pairs(algorithms.delassus_matrix),
        "(m, m) [1/kg, 1/(kg m), 1/(kg m^2)]",
        options=_OF,
        nodes=(60, 40, 1),
        inverts_mass=True,
    )
    def delassus_matrix(self, q: ArrayLike, constraints: AnyConstraints) -> Floats:
        """The matrix that maps constraint forces to constraint accelerations, J M^-1 J^T
        [Featherstone 2008, section 8.4].
        """
        return self._kernel("delassus_matrix", listed(constraints))(q)

    @quantity(
        kernels.of_frame_pairs(algorithms.constraint_jacobian),
        "(m, nv) [m/rad or 1, 1 or rad/m]",
        options=_OF,
    )
    def jacobian(self, q: ArrayLike, constraints: AnyConstraints) -> Floats:
        """The matrix that maps `v` to the constraint velocity."""
        return self._kernel("constraint_jacobian", listed(constraints))(q)

    @quantity(kernels.of_frame_pairs(algorithms.constraint_velocity), "(m,) [m/s, rad/s]", options=_OF)
    def velocity(self, q: ArrayLike, v: ArrayLike, constraints: AnyConstraints) -> Floats:
        """The constraint velocity: that of the first frames relative to the second ones, or to the world."""
        return self._kernel("constraint_velocity", listed(constraints))(q, v)

    @quantity(kernels.of_frame_pairs(algorithms.constraint_bias), "(m,) [m/s^2, rad/s^2]", options=_OF)
    def bias(self, q: ArrayLike, v: ArrayLike, constraints: AnyConstraints) -> Floats:
        """The rate of the constraint velocity when the joints do not accelerate, dJ/dt v."""
        return self._kernel("constraint_bias", listed(constraints))(q, v)

    @quantity(kernels.constraint_error, "(m,) [m, rad]", options=_OF, more=kernels.anchor_arguments)
    def error(
        self,
        q: ArrayLike,
        constraints: AnyConstraints,
        anchors: ArrayLike | Sequence[ArrayLike] | None = None,
    ) -> Floats:
        """How far the first frames are from where they are held: positions, then rotation vectors.

        Args:
            q: Configuration, (..., nq) [rad or m].
            constraints: The constraints.
            anchors: Where the contacts hold, (..., contacts, 4, 4), as for `forward_dynamics`; loops have none.

        Returns:
            Errors, (..., m) [m, rad].

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an array has another shape or type, or is not finite.
            InputError: If there are contacts without anchors.
        """
        listing = listed(constraints)
        contacts = [constraint for constraint in listing if constraint.is_contact]
        if contacts and anchors is None:
            raise InputError(
                "Contacts have an error only against anchors; give anchors=robot.constraints.anchors(q0, constraints)."
            )
        poses = (anchor_poses(anchors, contacts),) if contacts else ()
        return self._kernel("constraint_error", listing)(q, *poses)

    def anchors(self, q: ArrayLike, constraints: AnyConstraints) -> Floats:
        """Where the contacts among the constraints are, as poses in the world.

        Taken where contacts take hold, they are the `anchors` that keep them there.

        Args:
            q: Configuration, (..., nq) [rad or m].
            constraints: The constraints.

        Returns:
            Poses, (..., contacts, 4, 4) [m].

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` has another shape or type, or is not finite.
            InputError: If there is no contact among the constraints.
        """
        poses = [
            self._kernel("fk", name)(q) @ placement.matrix()
            for constraint in listed(constraints)
            if constraint.is_contact
            for name, placement in constraint.ends()
        ]
        if not poses:
            raise InputError("There is no contact among the constraints; loops need no anchors.")
        return np.stack(poses, axis=-3)
