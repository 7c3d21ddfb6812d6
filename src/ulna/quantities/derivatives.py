"""How quantities of a robot change with its state: derivatives in closed form, on tangent spaces."""

from __future__ import annotations

from typing import Any, final

from ulna.algorithms.multibody.references import Reference, check_reference
from ulna.errors import InputError
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.forces import (
    Forces,
    checked_forces,
    stacked_wrenches,
    with_external_forces,
    wrench_arguments,
)
from ulna.quantities.part import Part
from ulna.quantities.quantity import of_frame, quantity
from ulna.typing import ArrayLike, Floats

_FIXED: dict[str, Any] = {
    "options": {"forces": ()},
    "direct": True,
    "more": wrench_arguments,
    "forces": "External forces that turn with their frames: frame name -> wrench (..., 6) [N, N m] in its axes.",
    "reference": '"local" where there are forces, to say so; InputError otherwise.',
}


@final
class Derivatives(Part):
    """Derivatives by configuration, velocity, acceleration and torques, under the names of what is differentiated.

    Those by a configuration are along its tangent space, (..., nv): by the step of `robot.integrate`.
    """

    __slots__ = ()

    @quantity(
        with_external_forces(algorithms.inverse_dynamics_derivatives),
        "(nv, nv), (nv, nv), (nv, nv)",
        returns="By q, v and a",
        nodes=(280, 129, 0),
        stages=algorithms.stages_of_inverse_dynamics_derivatives,
        stages_from=7,
        **_FIXED,
    )
    def inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        forces: Forces = None,
        reference: Reference | None = None,
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the torques of inverse dynamics by `q`, `v` and `a`; the last is the mass matrix.

        Forces of the default `reference` of `robot.inverse_dynamics` do not turn with the robot: they would be others
        [Carpentier & Mansard 2018; Singh, Russell & Wensing 2022].
        """
        return _under_fixed_forces(self, "inverse_dynamics_derivatives", (q, v, a), forces, reference)

    @quantity(
        with_external_forces(algorithms.forward_dynamics_derivatives),
        "(nv, nv), (nv, nv), (nv, nv)",
        returns="By q, v and tau",
        nodes=(330, 138, 18),
        inverts_mass=True,
        columns=with_external_forces(algorithms.columns_of_derivatives),
        columns_from=6,
        stages=algorithms.stages_of_forward_dynamics_derivatives,
        stages_from=7,
        **_FIXED,
    )
    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        forces: Forces = None,
        reference: Reference | None = None,
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the accelerations of forward dynamics by `q`, `v` and `tau`; the last is the inverse of M
        [Carpentier & Mansard 2018, section V].
        """
        return _under_fixed_forces(self, "forward_dynamics_derivatives", (q, v, tau), forces, reference)

    @quantity(
        algorithms.centroidal_derivatives,
        "(6, nv), (6, nv), (6, nv), (6, nv)",
        returns="Momentum by q; its rate by q, v and a",
        nodes=850,
        stages=algorithms.stages_of_centroidal_derivatives,
        stages_from=7,
    )
    def centroidal_momentum(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives of the centroidal momentum by `q`, and of its rate by `q`, `v` and `a`.

        As in `robot.centroidal`, linear part first. The last is also the centroidal momentum matrix
        [Carpentier & Mansard 2018].
        """
        ...

    @quantity(algorithms.com_velocity_derivatives, "(3, nv), (3, nv)", returns="By q and v", nodes=550)
    def center_of_mass_velocity(self, q: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of the velocity of the centre of mass in the world by `q` and `v`."""
        ...

    @quantity(
        of_frame(algorithms.frame_velocity_derivatives), "(6, nv), (6, nv)", returns="By q and v", nodes=108
    )
    def frame_velocity(self, q: ArrayLike, v: ArrayLike, frame: str | None = None) -> tuple[Floats, Floats]:
        """Derivatives of the twist of a frame, in "local", by `q` and `v` [Carpentier & Mansard 2018]."""
        ...

    @quantity(
        of_frame(algorithms.frame_acceleration_derivatives),
        "(6, nv), (6, nv), (6, nv)",
        returns="By q, v and a",
        nodes=254,
    )
    def frame_acceleration(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, frame: str | None = None
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the spatial acceleration of a frame, in "local", by `q`, `v` and `a`
        [Carpentier & Mansard 2018].
        """
        ...

    @quantity(
        of_frame(algorithms.frame_hessian),
        "(nv, 6, nv)",
        name="hessian",
        returns="[k, :, j], the derivative of column j by coordinate k",
        nodes=(36, 19, 0),
    )
    def jacobian(
        self, q: ArrayLike, frame: str | None = None, reference: Reference = "local_world_aligned"
    ) -> Floats:
        """Derivative of the Jacobian of a frame by `q`: the kinematic Hessian [Haviland & Corke 2023]."""
        ...

    @quantity(of_frame(algorithms.manipulability_gradient), "(nv,)", nodes=234)
    def manipulability(self, q: ArrayLike, axes: Any = "all", frame: str | None = None) -> Floats:
        """Gradient of Yoshikawa's manipulability by `q`."""
        ...

    @quantity(
        algorithms.integrate_derivatives,
        "(nv, nv), (nv, nv) [1]",
        returns="By q and v",
        v="Step, velocity times time, (..., nv) [rad or m].",
    )
    def integrate(self, q: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of `robot.integrate` by `q` and `v`."""
        ...

    @quantity(algorithms.difference_derivatives, "(nv, nv), (nv, nv) [1]", returns="By q0 and q1")
    def difference(self, q0: ArrayLike, q1: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of `robot.difference` by `q0` and `q1`."""
        ...


def _under_fixed_forces(
    part: Part, name: str, arrays: tuple[ArrayLike, ...], forces: Forces, reference: Reference | None
) -> Any:
    """The derivatives under forces that turn with their frames."""
    if forces is not None:
        forces = checked_forces(forces)
    if not forces:
        if reference is not None:
            check_reference(reference)  # of no forces, but a mistake nevertheless
        return part._kernel(name)(*arrays)
    if not isinstance(reference, str) or reference != "local":
        raise InputError(
            f"`reference` is {reference!r}; expected 'local' where there are forces: derivatives are those under "
            "wrenches in the axes of their frames, which turn with them. Give the dynamics reference='local', too."
        )
    return part._kernel(name, tuple(forces))(*arrays, stacked_wrenches(forces))
