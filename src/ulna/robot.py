"""What users hold: a model with its kernels, asked by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, final

import numpy as np

from ulna import algorithms, kernels
from ulna import model as models
from ulna.algorithms.references import Reference
from ulna.errors import InputError, UnknownName
from ulna.methods.base import Plain
from ulna.methods.branches import Branching
from ulna.methods.constraints import Constraints
from ulna.methods.derivatives import Derivatives
from ulna.methods.dynamics import Dynamics
from ulna.methods.free import FreeInverseKinematics
from ulna.methods.operational import Operational
from ulna.methods.regressors import Regressors
from ulna.model import Model
from ulna.spatial import SE3
from ulna.trace import Function, trace
from ulna.trace import compile as compile_function
from ulna.typing import ArrayLike, Floats

FrameName = str | Sequence[str] | None


@dataclass(frozen=True)
class Limits:
    """The limits of a robot, as read-only arrays; infinite where there is none."""

    lower: Floats
    """Least positions, (nq,) [rad or m]."""
    upper: Floats
    """Greatest positions, (nq,) [rad or m]."""
    velocity: Floats
    """Greatest speeds, (nv,) [rad/s or m/s]."""
    effort: Floats
    """Greatest joint torques or forces, (nv,) [N m or N]."""

    def contains(self, q: ArrayLike, tolerance: float = 0.0) -> Any:
        """Whether configurations `q`, (..., nq), lie within the position limits."""
        q = np.asarray(q, dtype=float)
        return ((q >= self.lower - tolerance) & (q <= self.upper + tolerance)).all(axis=-1)

    def clip(self, q: ArrayLike) -> Floats:
        """Configurations `q`, (..., nq), moved into the position limits."""
        return np.clip(np.asarray(q, dtype=float), self.lower, self.upper)


@final
class Robot(Dynamics, Operational, Constraints, Derivatives, FreeInverseKinematics, Branching, Regressors):
    """A robot: its model, and its kernels compiled when first used.

    Every method takes configurations of shape (..., nq) and velocities of shape (..., nv), with any leading batch
    axes, and returns NumPy arrays. Inputs are checked: a wrong shape, a name that does not exist, nan or inf raise an
    error that says what mends it. For hot loops take the bare kernel with `kernel`.

    Frames are named; the default is the tool. References of velocities and Jacobians, with the twist's linear part
    first: "world" (of the point at the world's origin, world axes), "local" (frame's origin and axes),
    "local_world_aligned" (frame's origin, world axes; the default).
    """

    __slots__ = ("_fk", "_jacobian", "_kernels", "_plain", "_solvers", "limits", "model")

    def __init__(self, model: Model) -> None:
        self.model = model
        self.limits = Limits(
            model.lower_position, model.upper_position, model.velocity_limit, model.effort_limit
        )
        self._kernels: dict[Any, Any] = {}
        self._plain = Plain(model)
        self._fk: dict[Any, Any] = {}
        self._jacobian: dict[Any, Any] = {}
        self._solvers: dict[Any, Any] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        return Robot, (self.model,)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Robot) and self.model == other.model

    def __hash__(self) -> int:
        return hash(self.model)

    def __repr__(self) -> str:
        m = self.model
        return f"<robot {m.name!r}: {len(m.joints)} joints, nq={m.nq}, nv={m.nv}, tool {m.tool!r}>"

    def __str__(self) -> str:
        return self.model.table()

    @property
    def name(self) -> str:
        """The robot's name."""
        return self.model.name

    @property
    def nq(self) -> int:
        """How many numbers a configuration has."""
        return self.model.nq

    @property
    def nv(self) -> int:
        """How many numbers a velocity has."""
        return self.model.nv

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the movable joints, in the order of `q`."""
        return tuple(self.model.joint_names)

    @property
    def link_names(self) -> tuple[str, ...]:
        """Names of the links."""
        return tuple(self.model.link_names)

    @property
    def frame_names(self) -> tuple[str, ...]:
        """Names of all frames: links, joints, tools."""
        return tuple(self.model.frame_names)

    @property
    def tool(self) -> str:
        """Name of the default frame."""
        return self.model.tool

    @property
    def configurations(self) -> Mapping[str, Floats]:
        """Named configurations, such as "qr" or "home"."""
        return self.model.configurations

    @property
    def neutral(self) -> Floats:
        """The neutral configuration, (nq,): zeros, and unit quaternions."""
        return self.model.neutral

    def fk(
        self, q: ArrayLike, frame: FrameName = None, *, out: Any = None, threads: int | None = None
    ) -> Any:
        """Forward kinematics: the pose of a frame in the world.

        Args:
            q: Configuration, (..., nq) [rad or m].
            frame: Name; None for the tool, a list of names for several, "all" for every frame.
            out: Array to write into.
            threads: How many threads a large batch may use.

        Returns:
            T_world_frame, (..., 4, 4), which maps coordinates of the frame to the world; (..., k, 4, 4) for several.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` cannot be a configuration.
            UnknownName: If there is no such frame.

        Reference: Featherstone 2008, section 4.1.
        """
        try:
            kernel = self._fk[frame]
        except (KeyError, TypeError):
            kernel = self._fk[_key(frame)] = self._checked("fk", frame=frame)
        if out is None and threads is None:
            return kernel(q)
        return kernel(q, out=out, threads=threads)

    def link_poses(self, q: ArrayLike) -> Any:
        """Poses of all links in the world, T_world_link, (..., nlinks, 4, 4), in the order of `link_names`."""
        return self._plain["link_poses"](q)

    def jacobian(
        self,
        q: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        *,
        out: Any = None,
        threads: int | None = None,
    ) -> Any:
        """The Jacobian of a frame, (..., 6, nv): maps joint velocities to the frame's twist, linear part first.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` cannot be a configuration.
            UnknownName: If there is no such frame or reference.

        Reference: Featherstone 2008, section 4.1; Siciliano et al. 2009, section 3.1.
        """
        try:
            kernel = self._jacobian[reference][frame]
        except (KeyError, TypeError):
            kernel = self._checked("jacobian", frame=frame, reference=reference)
            self._jacobian.setdefault(reference, {})[frame] = kernel
        if out is None and threads is None:
            return kernel(q)
        return kernel(q, out=out, threads=threads)

    def jacobian_dot(
        self,
        q: ArrayLike,
        v: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
    ) -> Any:
        """Time derivative of the Jacobian along the velocity `v`, (..., 6, nv)."""
        return self._checked("jacobian_dot", frame=frame, reference=reference)(q, v)

    def hessian(
        self, q: ArrayLike, frame: str | None = None, reference: Reference = "local_world_aligned"
    ) -> Any:
        """Kinematic Hessian, (..., nv, 6, nv): entry [k, :, j] is the derivative of Jacobian column j by joint k."""
        return self._checked("hessian", frame=frame, reference=reference)(q)

    def frame_velocity(
        self,
        q: ArrayLike,
        v: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
    ) -> Any:
        """Twist of a frame, (..., 6) [m/s, rad/s]."""
        return self._checked("frame_velocity", frame=frame, reference=reference)(q, v)

    def frame_acceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        classical: bool = False,
    ) -> Any:
        """Acceleration of a frame, (..., 6) [m/s^2, rad/s^2]: the spatial one, or the classical one of its origin."""
        options = {"frame": frame, "reference": reference, "classical": classical}
        return self._checked("frame_acceleration", **options)(q, v, a)

    def analytical_jacobian(
        self, q: ArrayLike, representation: str = "rpy/xyz", frame: str | None = None
    ) -> Any:
        """Jacobian whose lower rows give rates of angles, (..., 6, nv).

        `representation` is "rpy/xyz", "rpy/zyx", "eul" or "exp".
        """
        return self._checked("analytical_jacobian", frame=frame, representation=representation)(q)

    def manipulability(
        self,
        q: ArrayLike,
        measure: Literal["yoshikawa", "inverse_condition", "minimum_singular_value", "asada"] = "yoshikawa",
        axes: Any = "all",
        frame: str | None = None,
    ) -> Any:
        """How far the Jacobian is from losing rank, (...): see `ulna.algorithms.manipulability`.

        `axes` is "all", "trans", "rot", or six truth values. Yoshikawa's measure is a compiled kernel; the others take
        singular values of the compiled Jacobian, or, for "asada", eigenvalues of the inertia felt at the frame.
        """
        if measure == "yoshikawa":
            return self._checked("manipulability", frame=frame, axes=axes)(q)
        if measure == "asada":
            return algorithms.asada(self.jacobian(q, frame), self.mass_matrix(q), axes)
        return algorithms.measure_of(self.jacobian(q, frame), measure, axes)

    def manipulability_gradient(self, q: ArrayLike, axes: Any = "all", frame: str | None = None) -> Any:
        """Gradient of Yoshikawa's manipulability by the configuration, (..., nv)."""
        return self._checked("manipulability_gradient", frame=frame, axes=axes)(q)

    def integrate(self, q: ArrayLike, v: ArrayLike) -> Any:
        """The configuration reached from `q` by the step `v` (velocity times time), (..., nq)."""
        return self._plain["integrate"](q, v)

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Any:
        """The step that leads from `q0` to `q1`, (..., nv): `integrate(q0, difference(q0, q1))` is `q1`."""
        return self._plain["difference"](q0, q1)

    def interpolate(self, q0: ArrayLike, q1: ArrayLike, t: ArrayLike) -> Any:
        """The point at `t` in [0, 1] on the way from `q0` to `q1`, (..., nq); batches of `t` broadcast."""
        return self._plain["interpolate"](q0, q1, t)

    def normalize(self, q: ArrayLike) -> Any:
        """`q` with its quaternions made unit, (..., nq)."""
        out = self._plain["normalize"](q)
        if np.isnan(out).any():
            raise InputError(
                "`q` holds a quaternion of length 0, which is no rotation and cannot be normalised."
            )
        return out

    def configuration_distance(self, q0: ArrayLike, q1: ArrayLike) -> Any:
        """Length of the difference of two configurations, (...)."""
        return self._plain["distance"](q0, q1)

    def squared_distance(self, q0: ArrayLike, q1: ArrayLike) -> Any:
        """Square of the distance of two configurations, (...)."""
        return self._plain["squared_distance"](q0, q1)

    def is_same_configuration(self, q0: ArrayLike, q1: ArrayLike, tolerance: float = 1e-9) -> Any:
        """Whether two configurations place the robot alike, (...): no entry of their difference is larger."""
        return (np.abs(self.difference(q0, q1)) <= tolerance).all(axis=-1)

    def integrate_derivatives(self, q: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of `integrate` by `q` and by `v` on the tangent spaces, (..., nv, nv) each."""
        return self._plain["integrate_derivatives"](q, v)

    def difference_derivatives(self, q0: ArrayLike, q1: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of `difference` by `q0` and by `q1` on the tangent spaces, (..., nv, nv) each."""
        return self._plain["difference_derivatives"](q0, q1)

    def random_configuration(self, size: int | tuple[int, ...] = (), seed: Any = None) -> Floats:
        """Random configurations within the limits, (*size, nq).

        `seed` is a number or a `numpy.random.Generator`. Coordinates without limits are drawn as the joint kind says:
        angles from [-pi, pi], lengths from [-1, 1] m, rotations uniformly.
        """
        shape = tuple(np.atleast_1d(np.asarray(size)).tolist()) if np.size(size) else ()
        if not all(isinstance(n, int) and n >= 0 for n in shape):
            raise InputError(f"`size` is {size!r}; expected a count or a tuple of counts.")
        return algorithms.random(self.model, np.random.default_rng(seed), shape)

    def lock(self, joints: Mapping[str, Any] | Sequence[str], q: Any = None) -> Robot:
        """The robot with some joints held still; see `ulna.model.lock_joints`."""
        return Robot(models.lock_joints(self.model, joints, q))

    def attach(
        self,
        other: Robot,
        frame: str | None = None,
        placement: SE3 | None = None,
        prefix: str = "",
        **options: Any,
    ) -> Robot:
        """This robot carrying another: a gripper on an arm, an arm on a base; see `ulna.model.attach`."""
        if not isinstance(other, Robot):
            raise InputError(f"`other` is {other!r}; expected a Robot, such as ulna.load(...) gives.")
        return Robot(models.attach(self.model, other.model, frame, placement, prefix, **options))

    def with_tool(self, frame: str, placement: SE3 | None = None, name: str = "tool") -> Robot:
        """The robot with another tool: a frame, or a new one at `placement` (T_frame_tool) in it."""
        return Robot(models.with_tool(self.model, frame, placement, name))

    @property
    def dynamic_parameters(self) -> Floats:
        """Mass, first moments and inertia of each joint's body, (10 nbodies,); see `ulna.model.dynamic_parameters`."""
        return models.dynamic_parameters(self.model)

    def with_dynamic_parameters(self, parameters: ArrayLike, *, check: bool = True) -> Robot:
        """The robot with other masses and inertias; see `ulna.model.with_dynamic_parameters`."""
        return Robot(models.with_dynamic_parameters(self.model, parameters, check=check))

    def parameters(self, name: str) -> Floats:
        """What the model has for one of the `parameters` of a kernel; see `ulna.model.parameters` for their names."""
        return models.parameters(self.model, name)

    def with_parameters(self, values: Mapping[str, Any], *, check: bool = True) -> Robot:
        """The robot with other inertias, placements, offsets, gravity ...; see `ulna.model.with_parameters`."""
        return Robot(models.with_parameters(self.model, values, check=check))

    def with_payload(
        self,
        frame: str | None = None,
        mass: float = 1.0,
        com: ArrayLike = (0.0, 0.0, 0.0),
        inertia: ArrayLike | None = None,
        *,
        name: str = "payload",
    ) -> Robot:
        """The robot carrying a body at a frame, the tool for None; see `ulna.model.with_payload`."""
        return Robot(models.with_payload(self.model, frame, mass, com, inertia, name=name))

    def perturbed(self, fraction: float = 0.1, seed: Any = None, com: float = 0.0) -> Robot:
        """A robot like this one, with masses and inertias off at random; see `ulna.model.perturbed`."""
        return Robot(models.perturbed(self.model, fraction, seed, com))

    def with_configuration(self, name: str, q: Any) -> Robot:
        """The robot with a named configuration: numbers (nq,), or a dictionary from joint names to positions."""
        return Robot(models.with_configuration(self.model, name, q))

    def kernel(self, name: str, *, dtype: Any = np.float64, checked: bool = False, **options: Any) -> Any:
        """The bare compiled kernel of a quantity, for hot loops: `fk = robot.kernel("fk", frame="panda_hand")`.

        Called with a contiguous array of the exact shape and type it costs about 100 ns. It lets nan through unless
        `checked`. It has `.operations`, `.graph`, `.ir()`, `.asm()`, `.jacobian()` and `.gufunc`.

        With `parameters=("inertia", "placement")` those numbers of the model are further arguments at the end, so that
        one kernel serves a batch of robots; `robot.parameters("inertia")` is what this robot has for them.

        Raises:
            UnknownName: If there is no such kernel, option or frame.
        """
        return kernels.kernel(self.model, name, dtype=dtype, checked=checked, **options)

    def function(self, name: str, **options: Any) -> Function:
        """The traced function of a quantity, before compilation."""
        return kernels.function(self.model, name, **options)

    def _checked(self, name: str, **options: Any) -> Any:
        key = (name, *options, *(_key(v) for v in options.values()))
        kernel = self._kernels.get(key)
        if kernel is None:
            kernel = self._kernels[key] = self.kernel(name, checked=True, **options)
        return kernel


def compile(
    f: Callable[..., Any],
    robot: Robot | None = None,
    *,
    dtype: Any = np.float64,
    checked: bool = False,
    **shapes: Any,
) -> Any:
    """Compiles your own function of arrays, alone or for a robot.

    Args:
        f: Function of arrays that uses NumPy arithmetic, `ulna.numeric`, and, if you like, methods of robots.
        robot: Gives the shapes of arguments called q, q0, q1 (nq,) and v, a, tau, qd, qdd (nv,).
        dtype: The type to compute in: float64 or float32.
        checked: Whether nan and inf in the inputs raise NonFiniteError.
        **shapes: Shapes of the other arguments: `target=(3,)`, `()` for a number. Arguments with a default value keep
            it unless their shape is given.

    Returns:
        A kernel, called as `f` is, with any leading batch axes; `.jacobian()` is its derivative, compiled too.

    Raises:
        UnknownName: If the shape of an argument is not known.
        TraceError: If `f` branches on a traced value.
    """
    if robot is not None and not isinstance(robot, Robot):
        raise InputError(f"`robot` is {robot!r}; expected a Robot, such as ulna.load(...) gives.")
    names = [n for n, p in inspect.signature(f).parameters.items() if n in shapes or p.default is p.empty]
    if robot is not None:
        shapes = kernels.shapes_for(robot.model, names, shapes)
    missing = [name for name in names if name not in shapes]
    if missing:
        raise UnknownName(
            "shape of argument",
            missing[0],
            shapes,
            f"Give it: compile(f, {missing[0]}=(3,)), or pass the robot.",
        )
    return compile_function(trace(f, **{name: shapes[name] for name in names}), dtype=dtype, checked=checked)


def _key(value: Any) -> Any:
    return tuple(value) if isinstance(value, (list, np.ndarray)) else value
