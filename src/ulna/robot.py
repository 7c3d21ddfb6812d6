"""`Robot`: a model with its compiled kernels, by name."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, final

import numpy as np

from ulna import compiler, kernels
from ulna.checks.arrays import check_core_shape, check_finite, real_array
from ulna.checks.values import number, short_repr
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.idioms import Explained, explained
from ulna.lazy import Slot, apply, is_deferred
from ulna.methods.branches import Branching
from ulna.methods.collision import Collision
from ulna.methods.former_names import FormerNames
from ulna.methods.free import FreeInverseKinematics
from ulna.methods.pages import Pages
from ulna.methods.parameters import Parameters
from ulna.methods.planning import MotionPlanning
from ulna.methods.prepare_method import Preparing
from ulna.methods.variants import Variants
from ulna.model import Model
from ulna.quantities.centroidal import Centroidal
from ulna.quantities.configurations import Configurations, ConfigurationSpace
from ulna.quantities.constrained_dynamics import Constraints
from ulna.quantities.derivatives import Derivatives
from ulna.quantities.dynamics import Dynamics
from ulna.quantities.kinematics import Kinematics
from ulna.quantities.operational_space import OperationalSpace
from ulna.quantities.regressors import Regressors
from ulna.typing import ArrayLike, Floats

if TYPE_CHECKING:
    from ulna.compiler import Function

_notebook_display: Callable[[Any], str] | None = None


def set_notebook_display(function: Callable[[Any], str]) -> None:
    """Have notebooks display robots by a function that returns HTML; the viewer, a layer above, has one."""
    global _notebook_display
    _notebook_display = function


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
    position_names: tuple[str, ...] | None = None
    """What the positions are called, (nq,): labels of xarray are put into this order; None where they have no names."""

    def contains(self, q: ArrayLike, tolerance: float = 0.0) -> Any:
        """Whether configurations lie within the position limits; nan does not.

        Args:
            q: Configurations, (..., nq) [rad or m].
            tolerance: How far outside still counts as within [rad or m].

        Returns:
            Truth values, (...).

        Raises:
            ShapeError, DtypeError, InputError: An argument is invalid.
        """
        slack = number("tolerance", tolerance)
        return self._call(partial(_are_within, self.lower - slack, self.upper + slack), q, Slot("", (), bool))

    def clip(self, q: ArrayLike) -> Floats:
        """Configurations `q`, (..., nq), moved into the position limits.

        Raises:
            NonFiniteError: nan, or an infinite position of a joint without that limit.
            ShapeError, DtypeError, InputError: `q` holds no configurations.
        """
        return self._call(partial(_moved_within, self.lower, self.upper), q, Slot("q", self.lower.shape))

    def _call(self, function: Callable[[Floats], Any], q: Any, result: Slot) -> Any:
        """A function of configurations (..., nq), which may be lazy or labelled."""
        if is_deferred(q):
            return apply(function, [q], [Slot("q", self.lower.shape, labels=self.position_names)], [result])
        x = real_array("q", q)
        check_core_shape("q", x, self.lower.shape)
        return function(x)


def _are_within(lower: Floats, upper: Floats, q: Floats) -> Any:
    return ((q >= lower) & (q <= upper)).all(axis=-1)


def _moved_within(lower: Floats, upper: Floats, q: Floats) -> Floats:
    out = np.clip(q, lower, upper)
    check_finite("q", out, "Look where it comes from.")
    return out


@final
@explained("robot", unlisted=[name for name in vars(FormerNames) if not name.startswith("_")])
class Robot(
    Kinematics,
    Configurations,
    Dynamics,
    FreeInverseKinematics,
    MotionPlanning,
    Branching,
    Preparing,
    Variants,
    Pages,
    FormerNames,
    metaclass=Explained,
):
    """A robot: its model, and its kernels compiled when first used.

    Every method takes configurations of shape (..., nq) and velocities of shape (..., nv), with any leading batch
    axes, and returns NumPy arrays; of Dask arrays it returns lazy Dask arrays, of xarray those of xarray. Inputs are
    checked: a wrong shape, a name that does not exist, nan or inf raise an error that says how to fix it. For hot loops
    take the bare kernel with `kernel`.

    What is used less often is in groups: `centroidal`, `collision`, `configuration_space`, `constraints`,
    `derivatives`, `operational_space`, `parameters`, `regressors`.

    Frames are named; the default is the tool. References of velocities and Jacobians, with the twist's linear part
    first: "world" (of the point at the world's origin, world axes), "local" (frame's origin and axes),
    "local_world_aligned" (frame's origin, world axes; the default).

    Example:
        >>> robot = ulna.load("ur5")
        >>> robot.nq, robot.tool, robot.joint_names[0]
        (6, 'tool0', 'shoulder_pan_joint')
        >>> robot.fk(np.zeros((100, 6))).shape
        (100, 4, 4)
    """

    __slots__ = {
        "centroidal": "Motion of the centre of mass, momentum about it, such as `robot.centroidal.momentum`.",
        "collision": "Collision checkers, first contacts, covering spheres, such as `robot.collision.checker`.",
        "configuration_space": "Distances of configurations, such as `robot.configuration_space.distance`.",
        "constraints": "Contacts, closed loops, impacts, such as `robot.constraints.forward_dynamics`.",
        "derivatives": "Derivatives by state, acceleration and torques, such as `robot.derivatives.inverse_dynamics`.",
        "limits": "Limits of positions, speeds and torques: `.lower`, `.upper`, `.velocity`, `.effort`.",
        "operational_space": "Dynamics at a frame, such as `robot.operational_space.inertia`.",
        "parameters": "Numbers of the model that can be inputs of kernels, such as `robot.parameters.dynamic`.",
        "regressors": "Matrices from dynamic parameters to torques, such as `robot.regressors.joint_torque`.",
    }

    def __init__(self, model: Model) -> None:
        if not isinstance(model, Model):
            raise InputError(
                f"`model` is of type {type(model).__name__}; expected a Model. ulna.load(name_or_path) makes a "
                "Robot of a name or a file; a Robot needs no other."
            )
        importlib.import_module("ulna.compiler.runtime.kernel")  # now, so that the first call waits less
        shared = model, kernels.CheckedKernels(model), {}
        super().__init__(*shared)
        self.limits = Limits(
            model.lower_position,
            model.upper_position,
            model.velocity_limit,
            model.effort_limit,
            model.position_names,
        )
        self.centroidal = Centroidal(*shared)
        self.collision = Collision(*shared)
        self.configuration_space = ConfigurationSpace(*shared)
        self.constraints = Constraints(*shared)
        self.derivatives = Derivatives(*shared)
        self.operational_space = OperationalSpace(*shared)
        self.parameters = Parameters(*shared)
        self.regressors = Regressors(*shared)

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

    def _repr_html_(self) -> str | None:
        return None if _notebook_display is None else _notebook_display(self)

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
        """Names of all frames (links, joints, tools), in the order of `fk(q, "all")`; see `ulna.model.Model`."""
        return tuple(self.model.frame_names)

    @property
    def tool(self) -> str:
        """Name of the default frame."""
        return self.model.tool

    @property
    def configurations(self) -> Mapping[str, Floats]:
        """Named configurations, such as "qr" or "home".

        Example:
            >>> robot = ulna.load("panda")
            >>> list(robot.configurations)
            ['qr', 'qz', 'ready']
            >>> robot.configurations["ready"].round(2)
            array([ 0.  , -0.79,  0.  , -2.36,  0.  ,  1.57,  0.79])
        """
        return self.model.configurations

    @property
    def neutral(self) -> Floats:
        """The neutral configuration, (nq,): zeros, and unit quaternions."""
        return self.model.neutral

    def kernel(
        self,
        name: str,
        *,
        dtype: Any = np.float64,
        checked: bool = False,
        device: str = "cpu",
        **options: Any,
    ) -> Any:
        """The bare compiled kernel of a quantity, for hot loops: `fk = robot.kernel("fk", frame="panda_hand")`.

        Called with a contiguous array of the exact shape and type it costs about 100 ns. It lets nan through unless
        `checked`. It has `.operations`, `.graph`, `.ir()`, `.asm()`, `.jacobian()` and `.gufunc`.
        The first call compiles it, and so does the first batch: call it once before a loop that must not wait.

        With `parameters=("inertia", "placement")` those numbers of the model are further arguments at the end, so that
        one kernel serves a batch of robots; `robot.parameters["inertia"]` is what this robot has for them.

        Args:
            name: The quantity; `docs/quantities.md` lists them, `ulna.kernels.QUANTITIES` is their table. On a GPU also
                "ik" (`ulna.ik.thread_search`).
            dtype: The type to compute in: float64 or float32.
            checked: Whether nan and inf in the inputs raise NonFiniteError.
            device: "cpu", or "cuda" for arrays on an NVIDIA GPU (experimental; docs/gpu.md).
            **options: Options of the quantity, such as `frame` and `reference`; `parameters`.

        Returns:
            The kernel; see `ulna.compiler.compile`.

        Raises:
            UnknownName: If there is no such kernel, option, device or frame.

        Example:
            >>> robot = ulna.load("panda")
            >>> fk = robot.kernel("fk", frame="panda_hand")
            >>> fk(robot.configurations["ready"])[:3, 3].round(3)
            array([0.307, 0.   , 0.59 ])
        """
        if isinstance(name, str) and isinstance(device, str) and (name, device) == ("ik", "cuda"):
            from ulna.ik.thread_search import search_kernel

            kernels.check_device(device, checked)
            return search_kernel(self.model, dtype, options)
        return kernels.kernel(self.model, name, dtype=dtype, checked=checked, device=device, **options)

    def function(self, name: str, **options: Any) -> Function:
        """The traced function of a quantity, before compilation.

        Args:
            name: As for `kernel`.
            **options: As for `kernel`.

        Returns:
            The function, which knows its graph and its operations.

        Raises:
            UnknownName: As from `kernel`.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot.function("fk").operations
            147
        """
        return kernels.function(self.model, name, **options)


_OWN_ARGUMENTS = frozenset({"f", "robot", "dtype", "checked", "device"})


def compile(
    f: Callable[..., Any],
    robot: Robot | None = None,
    *,
    dtype: Any = np.float64,
    checked: bool = False,
    device: str = "cpu",
    **shapes: Any,
) -> Any:
    """Compiles your own function of arrays, alone or for a robot.

    Args:
        f: Function of arrays that uses NumPy arithmetic, `ulna.numeric`, and, if you like, methods of robots.
        robot: Gives the shapes of arguments called q, q0, q1 (nq,) and v, a, tau, qd, qdd (nv,).
        dtype: The type to compute in: float64 or float32.
        checked: Whether nan and inf in the inputs raise NonFiniteError.
        device: "cpu", or "cuda" for arrays on an NVIDIA GPU (experimental; docs/gpu.md).
        **shapes: Shapes of the other arguments: `target=(3,)`, `()` for a number. Arguments with a default value keep
            it unless their shape is given.

    Returns:
        A kernel of the arguments that have a shape, in their order in `f`, with any leading batch axes; `.jacobian()`
        is its derivative, compiled too.

    Raises:
        UnknownName: If the shape of an argument or the device is not known.
        TraceError: If `f` branches on a traced value.
        InputError: If `f` is no function, `robot` no Robot, or an argument of `f` has the name of one of these.

    Example:
        >>> f = ulna.compile(lambda x: x @ x, x=(3,))
        >>> f([1.0, 2.0, 3.0]), f.jacobian()([1.0, 2.0, 3.0])
        (np.float64(14.0), array([2., 4., 6.]))
    """
    from ulna.checks.parameters import function_of

    if robot is not None and not isinstance(robot, Robot):
        raise InputError(f"`robot` is {robot!r}; expected a Robot, such as ulna.load(...) returns.")
    if not callable(f):
        raise InputError(
            f"`f` is {short_repr(f)}; expected a function of arrays. Kernels with names come from "
            'robot.kernel("fk").'
        )
    kernels.check_device(device, checked)
    names = _argument_names(f, shapes)
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
    _warn_of_frozen_calls(f)
    traced = compiler.trace(function_of(f, names), **{name: shapes[name] for name in names})
    if device == "cuda":
        from ulna.compiler.runtime.cuda_kernel import CudaKernel

        return CudaKernel(traced, dtype)
    labels = {} if robot is None else kernels.labels(robot.model, traced)
    return compiler.compile(traced, dtype, checked, labels=labels)


def _warn_of_frozen_calls(f: Callable[..., Any]) -> None:
    """Warns of clocks and random numbers in functions of users; importing what finds them takes 2 ms."""
    if not (getattr(f, "__module__", None) or "").startswith("ulna."):
        from ulna.checks.frozen_calls import warn_of_frozen_calls

        warn_of_frozen_calls(f, stacklevel=4)


def _argument_names(f: Callable[..., Any], shapes: Mapping[str, Any]) -> list[str]:
    """The arguments of a function that are those of its kernel: with a shape, or without a default value."""
    from ulna.checks.parameters import names_to_pass, parameters_of

    parameters = parameters_of(f)
    for name in shapes.keys() - parameters.keys():
        raise UnknownName("argument of the function", name, parameters, "Shapes are given by its names.")
    names = names_to_pass(f, shapes)
    if own := _OWN_ARGUMENTS.intersection(names):
        raise InputError(
            f"`f` has an argument {min(own)!r}, as compile itself has; rename it, so that its shape can be given."
        )
    return names
