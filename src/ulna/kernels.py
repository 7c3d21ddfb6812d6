"""Where algorithms and the compiler meet: algorithm x model -> kernel, by name, each made once.

A recipe names its array arguments by their sizes and builds, for one model and its options, a plain function of arrays
out of `ulna.algorithms`; that function is traced and compiled. Kernels are shared between equal models.
"""

from __future__ import annotations

import weakref
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna import algorithms
from ulna import model as models
from ulna.algorithms.multibody.references import check_reference
from ulna.compiler import Function, compile, element_of, trace
from ulna.errors import InputError, UnknownName
from ulna.model import Frame, Model
from ulna.recipes import constraints, dynamics, operational
from ulna.recipes.base import FRAME, IN_FRAME, QQ, QV, QVA, Q, Recipe, Size, frame_of, on_model
from ulna.recipes.mass import MASS_PARAMETERS, WithMass, check_mass
from ulna.recipes.size import sized
from ulna.system import forks
from ulna.typing import Array


def _fk(model: Model, frame: Any) -> Callable[..., Any]:
    if frame == "all":
        frame = tuple(model.frame_names)
    if isinstance(frame, tuple):
        return _stacked_poses(model, [model.frame(name) for name in frame])
    one = frame_of(model, frame)
    return lambda q: algorithms.frame_pose(model, q, one).matrix()


def _stacked_poses(model: Model, frames: Sequence[Frame]) -> Callable[..., Any]:
    def poses(q: Array) -> Array:
        matrices = [T.matrix() for T in algorithms.frame_poses(model, q, frames)]
        return np.stack(matrices, axis=-3) if matrices else np.zeros((*q.shape[:-1], 0, 4, 4))

    return poses


def _link_poses(model: Model) -> Callable[..., Any]:
    return _stacked_poses(model, [model.frame(name) for name in model.link_names])


def _jacobian(model: Model, frame: Any, reference: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q: algorithms.frame_jacobian(model, q, one, reference)


def _jacobian_dot(model: Model, frame: Any, reference: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q, v: algorithms.frame_jacobian_dot(model, q, v, one, reference)


def _hessian(model: Model, frame: Any, reference: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q: algorithms.frame_hessian(model, q, one, reference)


def _velocity(model: Model, frame: Any, reference: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q, v: algorithms.frame_velocity(model, q, v, one, reference).vector()


def _acceleration(model: Model, frame: Any, reference: Any, classical: bool) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q, v, a: algorithms.frame_acceleration(
        model, q, v, a, one, reference, classical=classical
    ).vector()


def _analytical(model: Model, frame: Any, representation: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q: algorithms.analytical_jacobian(model, q, one, representation)


def _manipulability(model: Model, frame: Any, axes: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q: algorithms.manipulability(model, q, one, axes=axes)


def _manipulability_gradient(model: Model, frame: Any, axes: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q: algorithms.manipulability_gradient(model, q, one, axes=axes)


def _frame_regressor(model: Model, frame: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q, v, a: algorithms.frame_regressor(model, q, v, a, one)


def _payload_multiples(model: Model, frame: Any, reference: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q, wrench, limit: algorithms.payload_multiples(model, q, wrench, limit, one, reference)


def _velocity_derivatives(model: Model, frame: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q, v: algorithms.frame_velocity_derivatives(model, q, v, one)


def _acceleration_derivatives(model: Model, frame: Any) -> Callable[..., Any]:
    one = frame_of(model, frame)
    return lambda q, v, a: algorithms.frame_acceleration_derivatives(model, q, v, a, one)


RECIPES: dict[str, Recipe] = {
    "fk": Recipe(_fk, Q, FRAME, "Pose T_world_frame, (4, 4); of several frames, (k, 4, 4)."),
    "link_poses": Recipe(_link_poses, Q, {}, "Poses T_world_link of all links, (nlinks, 4, 4)."),
    "jacobian": Recipe(_jacobian, Q, IN_FRAME, "Jacobian of a frame, (6, nv), linear part first."),
    "jacobian_dot": Recipe(_jacobian_dot, QV, IN_FRAME, "Time derivative of the Jacobian, (6, nv)."),
    "hessian": Recipe(_hessian, Q, IN_FRAME, "Derivative of the Jacobian by q, (nv, 6, nv)."),
    "frame_velocity": Recipe(_velocity, QV, IN_FRAME, "Twist of a frame, (6,) [m/s, rad/s]."),
    "frame_acceleration": Recipe(
        _acceleration,
        QVA,
        {**IN_FRAME, "classical": False},
        "Acceleration of a frame, (6,) [m/s^2, rad/s^2].",
    ),
    "analytical_jacobian": Recipe(
        _analytical, Q, {**FRAME, "representation": "rpy/xyz"}, "Jacobian with angle rates, (6, nv)."
    ),
    "manipulability": Recipe(_manipulability, Q, {**FRAME, "axes": "all"}, "Yoshikawa's manipulability, ()."),
    "manipulability_gradient": Recipe(
        _manipulability_gradient, Q, {**FRAME, "axes": "all"}, "Gradient of the manipulability by q, (nv,)."
    ),
    "joint_torque_regressor": Recipe(
        on_model(algorithms.joint_torque_regressor),
        QVA,
        {},
        "Torques by dynamic parameters, (nv, 10 nbodies).",
    ),
    "gravity_regressor": Recipe(
        on_model(algorithms.gravity_regressor), Q, {}, "The same at rest, (nv, 10 nbodies)."
    ),
    "static_regressor": Recipe(
        on_model(algorithms.static_regressor), Q, {}, "Centre of mass by m and m c, (3, 4 nbodies) [1/kg]."
    ),
    "frame_regressor": Recipe(
        _frame_regressor, QVA, FRAME, "Wrench on a body at a frame by its parameters, (6, 10)."
    ),
    "kinetic_energy_regressor": Recipe(
        on_model(algorithms.kinetic_energy_regressor),
        QV,
        {},
        "Kinetic energy by dynamic parameters, (10 nbodies,).",
    ),
    "potential_energy_regressor": Recipe(
        on_model(algorithms.potential_energy_regressor), Q, {}, "Potential energy likewise, (10 nbodies,)."
    ),
    "payload_multiples": Recipe(
        _payload_multiples,
        (*Q, ("wrench", (6,)), ("limit", "nv")),
        IN_FRAME,
        "How many times a wrench each joint can hold at a frame, (nv,).",
    ),
    "centroidal_derivatives": Recipe(
        on_model(algorithms.centroidal_derivatives),
        QVA,
        {},
        "Derivatives of the centroidal momentum by q, and of its rate by q, v and a, (6, nv) each.",
    ),
    "com_velocity_derivatives": Recipe(
        on_model(algorithms.com_velocity_derivatives),
        QV,
        {},
        "Derivatives of the velocity of the centre of mass by q and v, (3, nv) each.",
    ),
    "frame_velocity_derivatives": Recipe(
        _velocity_derivatives,
        QV,
        FRAME,
        'Derivatives of the twist of a frame, in "local", by q and v, (6, nv) each.',
    ),
    "frame_acceleration_derivatives": Recipe(
        _acceleration_derivatives,
        QVA,
        FRAME,
        'Derivatives of the spatial acceleration of a frame, in "local", by q, v and a, (6, nv) each.',
    ),
    "integrate": Recipe(
        on_model(algorithms.integrate), QV, {}, "Configuration reached from q by the step v."
    ),
    "difference": Recipe(
        on_model(algorithms.difference), QQ, {}, "The step that leads from q0 to q1, (nv,)."
    ),
    "interpolate": Recipe(
        on_model(algorithms.interpolate),
        (*QQ, ("t", ())),
        {},
        "Point at t on the geodesic from q0 to q1, (nq,).",
    ),
    "normalize": Recipe(on_model(algorithms.normalize), Q, {}, "q with unit quaternions, (nq,)."),
    "distance": Recipe(on_model(algorithms.distance), QQ, {}, "Length of the difference, ()."),
    "squared_distance": Recipe(on_model(algorithms.squared_distance), QQ, {}, "Its square, joint by joint."),
    "integrate_derivatives": Recipe(
        on_model(algorithms.integrate_derivatives),
        QV,
        {},
        "Derivatives of integrate by q and v, (nv, nv) each.",
    ),
    "difference_derivatives": Recipe(
        on_model(algorithms.difference_derivatives),
        QQ,
        {},
        "Derivatives of difference by q0 and q1, (nv, nv) each.",
    ),
    **constraints.RECIPES,
    **dynamics.RECIPES,
    **operational.RECIPES,
}

_SEARCHES = ("ik", "ik_all", "ik_classic", "ik_free", "distance", "collides", "first_contact")

_made: weakref.WeakValueDictionary[Any, Any] = weakref.WeakValueDictionary()
_recent: deque[Any] = deque(
    maxlen=64
)  # stay alive for callers that ask anew each time instead of holding one
_lock = forks.lock(forks.RECIPES)


def function(model: Model, name: str, *, parameters: str | Sequence[str] = (), **options: Any) -> Function:
    """The traced function of recipe `name` for `model`; see `kernel` for the arguments and errors."""
    recipe, chosen = _choose(name, options)
    names = _parameter_names(model, parameters)
    arguments = (*recipe.arguments, *recipe.more(chosen))
    shapes: dict[str, Any] = {key: _shape(model, size) for key, size in arguments}
    doc = f"{recipe.doc} Robot: {model.name}."
    if not names:
        with sized(model, name, chosen):
            return trace(recipe.build(model, **chosen), name=name, doc=doc, **shapes)

    def run(*arrays: Any) -> Any:
        values = dict(zip(names, arrays[len(shapes) :], strict=True))
        return recipe.build(models.with_parameters(model, values), **chosen)(*arrays[: len(shapes)])

    doc += f" Parameters: {', '.join(names)}."
    extra: dict[str, Any] = {key: models.parameters(model, key).shape for key in names}
    with sized(model, name, chosen):
        return trace(run, name=name, doc=doc, **shapes, **extra)


def kernel(
    model: Model,
    name: str,
    dtype: Any = np.float64,
    checked: bool = False,
    *,
    parameters: str | Sequence[str] = (),
    **options: Any,
) -> Any:
    """The compiled kernel of recipe `name` for `model`.

    Args:
        model: The robot's model; its parameters become constants of the code.
        name: A key of `RECIPES`.
        dtype: float64 or float32.
        checked: Whether nan and inf in the inputs raise NonFiniteError, and quaternions that are not unit InputError.
        parameters: Names of model parameters that become further arguments instead, in this order, after the
            others; see `ulna.model.parameters`. They broadcast like all arguments.
        **options: Options of the recipe, such as `frame` and `reference`.

    Raises:
        UnknownName: For an unknown kernel, parameter, option, frame or reference; names the nearest.
    """
    recipe, chosen = _choose(name, options)
    names = _parameter_names(model, parameters)
    key = (model.fingerprint, name, element_of(dtype).name, checked, names, tuple(chosen.items()))
    with _lock:
        compiled = _made.get(key)
        if compiled is None:
            unit = _quaternions(model, name) if checked else ()
            if isinstance(recipe.build, WithMass) and not MASS_PARAMETERS & set(names):
                check_mass(model, element_of(dtype).name)
            traced = function(model, name, parameters=names, **chosen)
            compiled = _made[key] = compile(traced, dtype=dtype, checked=checked, unit_entries=unit)
            _recent.append(compiled)
    return compiled


def _parameter_names(model: Model, parameters: str | Sequence[str]) -> tuple[str, ...]:
    """The names of the parameters, each once."""
    names = (parameters,) if isinstance(parameters, str) else tuple(parameters)
    for name in names:
        models.parameters(model, name)  # raises for an unknown one
        if names.count(name) > 1:
            raise InputError(f"`parameters` names {name!r} {names.count(name)} times; expected once.")
    return names


def _quaternions(model: Model, name: str) -> tuple[tuple[int, tuple[int, ...]], ...]:
    """Where configurations among the arguments hold quaternions; nowhere for `normalize`, which normalises them."""
    if name == "normalize":
        return ()
    inputs = [number for number, (_, size) in enumerate(RECIPES[name].arguments) if size == "nq"]
    return tuple((number, entries) for number in inputs for entries in model.quaternions)


def shapes_for(model: Model, names: Sequence[str], given: Mapping[str, Any]) -> dict[str, Any]:
    """Shapes of a user's arguments: q, q0, q1 as configurations, v, a, tau, qd, qdd as velocities, else as given."""
    sizes = {"q": "nq", "q0": "nq", "q1": "nq"} | {n: "nv" for n in ("v", "a", "tau", "qd", "qdd")}
    for name in given:
        if name not in names:
            raise UnknownName("argument of the function", name, names)
    shapes = {}
    for name in names:
        if name not in given and name not in sizes:
            fix = f"Give the shape of other arguments: compile(f, robot, {name}=(3,))."
            raise UnknownName("robot quantity", name, sizes, fix)
        shapes[name] = given[name] if name in given else _shape(model, sizes[name])
    return shapes


def _choose(name: str, options: Mapping[str, Any]) -> tuple[Recipe, dict[str, Any]]:
    recipe = RECIPES.get(name)
    if recipe is None:
        search = (
            f"robot.{name} is a method that searches; no kernel stands for it." if name in _SEARCHES else ""
        )
        raise UnknownName("kernel", name, RECIPES, search)
    for key in options:
        if key not in recipe.options:
            raise UnknownName(f"option of kernel {name!r}", key, recipe.options)
    chosen = {key: _hashable(options.get(key, default)) for key, default in recipe.options.items()}
    if "reference" in chosen:
        check_reference(chosen["reference"])
    return recipe, chosen


def _hashable(value: Any) -> Any:
    return tuple(value) if isinstance(value, (list, np.ndarray)) else value


def _shape(model: Model, size: Size) -> tuple[int, ...]:
    sizes = (size,) if isinstance(size, str) else size
    return tuple(getattr(model, n) if isinstance(n, str) else n for n in sizes)


__all__ = ["RECIPES", "Recipe", "frame_of", "function", "kernel", "shapes_for"]
