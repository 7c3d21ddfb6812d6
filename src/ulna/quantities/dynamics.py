"""Torques, accelerations, inertia and energy of a robot, and where its mass is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ulna.algorithms.multibody.references import Reference, check_reference
from ulna.checks.arrays import (
    batched_array,
    check_core_shape,
    check_finite,
    check_not_negative,
    known_limits,
    real_array,
)
from ulna.checks.labels import in_order
from ulna.model import Model
from ulna.numeric import vector, where
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.forces import (
    FORCE_OPTIONS,
    Forces,
    checked_forces,
    friction_law,
    stacked_wrenches,
    with_external_forces,
    wrench_arguments,
)
from ulna.quantities.part import Part
from ulna.quantities.quantity import of_frame, quantity
from ulna.typing import Array, ArrayLike, Floats, Numbers

if TYPE_CHECKING:
    from ulna.algorithms import Friction

_LOADED: dict[str, Any] = {
    "options": FORCE_OPTIONS,
    "direct": True,
    "more": wrench_arguments,
    "reference": 'How the wrenches are written: "local_world_aligned", "local" or "world".',
}
_WITH_FRICTION: dict[str, Any] = {**_LOADED, "options": {**FORCE_OPTIONS, "friction": False}}


def _inverse_dynamics(
    model: Model, q: Array, v: Array, *rest: Array, friction: bool | Friction, **options: Any
) -> Array:
    tau = with_external_forces(algorithms.inverse_dynamics)(model, q, v, *rest, **options)
    law = friction_law(model, friction)
    return tau if law is None else tau - algorithms.friction_torque(v, law)


def _forward_dynamics(
    model: Model, q: Array, v: Array, tau: Array, *rest: Array, friction: Any, **options: Any
) -> Array:
    law = friction_law(model, friction)
    total = tau if law is None else tau + algorithms.friction_torque(v, law)
    return with_external_forces(algorithms.forward_dynamics)(model, q, v, total, *rest, **options)


def _stages_of_inverse_dynamics(model: Model, forces: Any, reference: Any, friction: Any) -> Any:
    """The form of stages; None under forces, or under friction."""
    if forces or friction_law(model, friction) is not None:
        return None
    return algorithms.stages_of_inverse_dynamics(model)


def _stages_of_bias_forces(model: Model, forces: Any, reference: Any) -> Any:
    """The form of stages; None under forces."""
    return None if forces else algorithms.stages_of_bias_forces(model)


def _stages_of_kinetic_energy(model: Model) -> Any:
    """The form of stages."""
    return algorithms.stages_of_mechanical_energy(model, potential=False)


class Dynamics(Part):
    """How a robot moves under torques and forces, and what it weighs.

    External forces are a dictionary from frame names to wrenches, `forces={"panda_hand": [0, 0, -9.81, 0, 0, 0]}`:
    what the surroundings exert on the body of that frame. `reference` says how the wrenches are written:
    "local_world_aligned" (about the frame's origin along the world's axes; the default), "local" (about its origin
    along its own axes), or "world" (about the world's origin).

    Friction is left out unless asked for: `friction=True` takes the damping and Coulomb friction of the model, and an
    `ulna.algorithms.Friction` is any other law. The armature of the joints always counts.
    """

    __slots__ = ()

    @quantity(
        _inverse_dynamics,
        "(nv,) [N m or N]",
        nodes=165,
        stages=_stages_of_inverse_dynamics,
        scans=True,
        **_WITH_FRICTION,
    )
    def inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        forces: Forces = None,
        reference: Reference = "local_world_aligned",
        friction: bool | Friction = False,
    ) -> Floats:
        """The joint torques that produce the acceleration `a`
        [Luh, Walker & Paul 1980; Featherstone 2008, section 5.3].

        Example:
            >>> robot = ulna.load("panda")
            >>> q, v, a = robot.configurations["qr"], np.zeros(7), np.zeros(7)
            >>> tau = robot.inverse_dynamics(q, v, a)
            >>> np.allclose(tau, robot.gravity_forces(q))
            True
            >>> held = robot.inverse_dynamics(q, v, a, {"panda_hand": [0, 0, -9.81, 0, 0, 0]})
        """
        return _under(self, "inverse_dynamics", (q, v, a), forces, reference, friction)

    @quantity(_forward_dynamics, "(nv,) [rad/s^2 or m/s^2]", nodes=400, inverts_mass=True, **_WITH_FRICTION)
    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        forces: Forces = None,
        reference: Reference = "local_world_aligned",
        friction: bool | Friction = False,
    ) -> Floats:
        """The joint accelerations that the torques `tau` produce.

        `ulna.algorithms.dynamics.forward_dynamics` chooses the algorithm that takes fewer operations
        [Featherstone 2008, sections 6.5 and 7.3].

        Example:
            >>> robot = ulna.load("panda")
            >>> q, v = robot.configurations["qr"], np.zeros(7)
            >>> a = robot.forward_dynamics(q, v, robot.gravity_forces(q))
            >>> np.allclose(a, 0.0)
            True
        """
        return _under(self, "forward_dynamics", (q, v, tau), forces, reference, friction)

    @quantity(
        with_external_forces(algorithms.bias_forces),
        "(nv,) [N m or N]",
        nodes=160,
        stages=_stages_of_bias_forces,
        scans=True,
        **_LOADED,
    )
    def bias_forces(
        self, q: ArrayLike, v: ArrayLike, forces: Forces = None, reference: Reference = "local_world_aligned"
    ) -> Floats:
        """The torques that produce no acceleration: Coriolis, centrifugal and gravity, less external forces
        [Featherstone 2008, section 5.3].

        Example:
            >>> robot = ulna.load("panda")
            >>> q, v, a = robot.configurations["qr"], np.full(7, 0.1), np.ones(7)
            >>> tau = robot.mass_matrix(q) @ a + robot.bias_forces(q, v)
            >>> np.allclose(tau, robot.inverse_dynamics(q, v, a))
            True
        """
        return _under(self, "bias_forces", (q, v), forces, reference)

    @quantity(algorithms.gravity_forces, "(nv,) [N m or N]", nodes=35)
    def gravity_forces(self, q: ArrayLike) -> Floats:
        """The torques that hold the robot against gravity [Featherstone 2008, section 5.3].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.gravity_forces(q).round(1)
            array([ 0. , -4. , -0.6, 22. ,  0.6,  2.3,  0. ])
        """
        ...

    @quantity(with_external_forces(algorithms.static_torque), "(nv,) [N m or N]", nodes=35, **_LOADED)
    def static_torque(
        self, q: ArrayLike, forces: Forces = None, reference: Reference = "local_world_aligned"
    ) -> Floats:
        """The torques that hold the robot against gravity and external forces [Siciliano et al. 2009, section 3.8].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> weight = {"panda_hand": [0, 0, -9.81, 0, 0, 0]}  # of 1 kg
            >>> robot.static_torque(q, weight).round(1)
            array([ 0. , -7. , -0.6, 26.7,  0.6,  3.1,  0. ])
        """
        return _under(self, "static_torque", (q,), forces, reference)

    @quantity(
        algorithms.mass_matrix,
        "(nv, nv) [kg, kg m, kg m^2]",
        nodes=(28, 28, 0),
        stages=algorithms.stages_of_mass_matrix,
        stages_from=60,
        chains_from=24,
    )
    def mass_matrix(self, q: ArrayLike) -> Floats:
        """The joint-space mass matrix; armature counts [Featherstone 2008, section 6.2].

        Example:
            >>> robot = ulna.load("panda")
            >>> M = robot.mass_matrix(robot.configurations["qr"])
            >>> M.shape, np.allclose(M, M.T)
            ((7, 7), True)
        """
        ...

    @quantity(
        algorithms.inverse_mass_matrix,
        "(nv, nv) [1/kg, 1/(kg m), 1/(kg m^2)]",
        nodes=(31, 25, 3.5),
        inverts_mass=True,
        columns=algorithms.columns_of_inverse_mass_matrix,
        stages=algorithms.stages_of_inverse_mass_matrix,
    )
    def inverse_mass_matrix(self, q: ArrayLike) -> Floats:
        """The inverse of the mass matrix [Featherstone 2008, section 6.5].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> np.allclose(robot.inverse_mass_matrix(q) @ robot.mass_matrix(q), np.eye(7))
            True
        """
        ...

    @quantity(
        algorithms.coriolis_matrix,
        "(nv, nv) [N m s or N s]",
        nodes=(155, 77, 0),
        stages=algorithms.stages_of_coriolis_matrix,
        stages_from=8,
    )
    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> Floats:
        """The matrix C of the Christoffel symbols: `C @ v + gravity = bias`, and `dM/dt - 2 C` is skew
        [Echeandia & Wensing 2021].

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> v = np.full(7, 0.1)
            >>> np.allclose(robot.coriolis_matrix(q, v) @ v + robot.gravity_forces(q), robot.bias_forces(q, v))
            True
        """
        ...

    @quantity(algorithms.kinetic_energy, "() [J]", stages=_stages_of_kinetic_energy, scans=True)
    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> Numbers:
        """Kinetic energy, half of `v @ M @ v`; armature counts.

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> robot.kinetic_energy(q, np.full(7, 0.1)).round(4)
            np.float64(0.0199)
        """
        ...

    @quantity(algorithms.potential_energy, "() [J]")
    def potential_energy(self, q: ArrayLike) -> Numbers:
        """The energy of all that moves in the field of gravity; zero at the world's origin."""
        ...

    @quantity(
        algorithms.mechanical_energy, "() [J]", stages=algorithms.stages_of_mechanical_energy, scans=True
    )
    def mechanical_energy(self, q: ArrayLike, v: ArrayLike) -> Numbers:
        """The sum of kinetic and potential energy."""
        ...

    def total_mass(self, subtree: str | None = None) -> float:
        """The mass of all that moves, or of what the joint `subtree` moves [kg]; `model.mass` is that of all links.

        Args:
            subtree: Name of a joint, for what it moves; None for all that moves: links that are fixed to the base are
                left out.

        Returns:
            The mass [kg].

        Raises:
            UnknownName: There is no such joint.

        Example:
            >>> robot = ulna.load("panda")
            >>> round(robot.total_mass(), 3), round(robot.total_mass("panda_joint7"), 3), round(robot.model.mass, 3)
            (16.822, 1.496, 17.452)
        """
        return float(algorithms.total_mass(self.model, subtree))

    @quantity(algorithms.center_of_mass, "(3,) [m]")
    def center_of_mass(self, q: ArrayLike, subtree: str | None = None) -> Floats:
        """Where the centre of mass of all that moves is in the world; InputError if there is no mass.

        Its velocity, acceleration and Jacobian are in `robot.centroidal`.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot.center_of_mass(np.zeros((10, 7))).shape
            (10, 3)
        """
        ...

    @quantity(
        of_frame(algorithms.payload_multiples),
        "(nv,)",
        arrays=("q", "wrench", "limit"),
        options={"frame": None, "reference": "local_world_aligned"},
    )
    def payload_capacity(
        self,
        q: ArrayLike,
        frame: str | None = None,
        wrench: ArrayLike | None = None,
        effort: ArrayLike | None = None,
        reference: Reference = "local_world_aligned",
    ) -> Floats:
        """How many times a load each joint can hold at a frame, standing still; the least counts.

        Args:
            q: Configuration, (..., nq) [rad or m].
            frame: Where the load acts; None for the tool.
            wrench: What it exerts there, (..., 6) [N, N m]; None for the weight of 1 kg, so that the answer is in kg.
            effort: Greatest torques in both directions, (nv,) [N m or N]; None for the model's, of which 0 is no limit.
            reference: In whose axes, and about which point, the wrench is written.

        Returns:
            Multiples of the load, (..., nv); inf where it does not burden a joint, nan where a joint cannot even hold
            the robot.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an array has another shape or type, or is not finite.
            UnknownName: If there is no such `frame` or `reference`; names the nearest.
            InputError: If a greatest torque is negative.
        """
        weight = np.concatenate([self.model.gravity, np.zeros(3)])
        load = batched_array("wrench", weight if wrench is None else wrench, (6,))
        known = known_limits(self.model.effort_limit)
        limit = real_array(
            "effort", known if effort is None else in_order("effort", effort, self.model.velocity_names)
        )
        check_core_shape("effort", limit, (self.model.nv,))
        free = np.isinf(limit)  # a joint without a limit holds any load
        check_finite("effort", np.where(free, 0.0, limit))
        check_not_negative("effort", limit, "greatest torques")
        kernel = self._kernel("payload_multiples", frame, reference)
        load_limit = kernel(q, load, np.where(free, np.finfo(float).max, limit))
        if type(load_limit) is np.ndarray and load_limit.dtype == object:  # inside of a trace
            return vector(
                *(where(x <= np.inf, np.inf, x) if f else x for f, x in zip(free, load_limit, strict=True))
            )
        return np.where(free & ~np.isnan(load_limit), np.inf, load_limit)


def _under(
    part: Part,
    name: str,
    arrays: tuple[ArrayLike, ...],
    forces: Forces,
    reference: Reference,
    *friction: bool | Friction,
) -> Any:
    """The quantity under forces, and under friction where it knows of it."""
    if forces is not None:
        forces = checked_forces(forces)
    if not forces:
        check_reference(reference)  # of no forces, but a mistake nevertheless
        return part._kernel(name, (), FORCE_OPTIONS["reference"], *friction)(*arrays)
    return part._kernel(name, tuple(forces), reference, *friction)(*arrays, stacked_wrenches(forces))
