"""Where algorithms and the compiler meet: algorithm x model -> kernel, by name, each made once.

A quantity names its arrays and its algorithm; for one model and one choice of options that is a plain function of
arrays, which is traced and compiled. Kernels are shared between equal models.
"""

from __future__ import annotations

import weakref
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, final

import numpy as np

from ulna import compiler
from ulna import model as models
from ulna.algorithms.multibody.references import check_reference
from ulna.errors import InputError, UnknownName
from ulna.model import Model
from ulna.quantities import QUANTITIES, Quantity
from ulna.quantities.documentation import ARRAYS, Size, with_batch
from ulna.quantities.mass import MASS_PARAMETERS, check_mass
from ulna.quantities.part import frozen
from ulna.quantities.quantity import frame_of
from ulna.quantities.size import check_size, estimated_nodes, sized
from ulna.system import forks

if TYPE_CHECKING:
    from ulna.compiler import Function
    from ulna.compiler.language.function import SecondForm
    from ulna.recursions.looped_function import LoopedFunction

_SEARCHES = ("ik", "ik_all", "ik_classic", "ik_free", "distance", "collides", "first_contact")

LOOPED_ABOVE = 60_000
"""Operations, as they are estimated, above which a quantity is computed by loops over joints where it can be.

To compile so many takes some three seconds; straight-line code of 50 joints computes 6 to 20 times as fast as loops, in
batches more (benchmarks/large_robots.py)."""

_MORE_FOR_MATRICES = 3
"""How many times as many for quantities in a form of columns, which is compiled in a third of the time, and for others
that take many operations for each pair of joints, whose loops are slowest beside straight-line code."""

_MANY_FOR_A_PAIR = 39
"""Operations."""

DEVICES = ("cpu", "cuda")
"""What kernels are compiled for."""

_MIN_COLUMNS = 12
"""Velocities of a robot from which on a quantity is compiled in its form of columns, where it has one."""

_STAGED_BATCHES_ABOVE = 120_000
"""Operations, as they are estimated, above which batches are computed in stages, too: to compile the graph would take
three seconds and more."""

_MAX_STAGES = 200
"""Velocities of a robot up to which stages are used: some take straight-line code, compiled in 6 ms for each joint."""

_made: weakref.WeakValueDictionary[Any, Any] = weakref.WeakValueDictionary()
_recent: deque[Any] = deque(
    maxlen=64
)  # stay alive for callers that ask anew each time instead of holding one
_lock = forks.lock(forks.RECIPES)


def function(model: Model, name: str, *, parameters: str | Sequence[str] = (), **options: Any) -> Function:
    """The traced function of a quantity for a model.

    Args:
        model: The robot's model.
        name: As for `kernel`.
        parameters: As for `kernel`.
        **options: As for `kernel`.

    Returns:
        The function, before compilation.

    Raises:
        UnknownName: As from `kernel`.
    """
    quantity, chosen = _choose(name, options)
    names = _parameter_names(model, parameters)
    shapes, doc = _shapes(model, quantity, chosen), _doc(model, quantity, chosen)
    extra: dict[str, Any] = {key: models.parameters(model, key).shape for key in names}
    doc += f" Parameters: {', '.join(names)}." if names else ""

    def on_parameters(of_model: Callable[..., Callable[..., Any]]) -> Callable[..., Any]:
        if not names:
            return of_model(model, **chosen)

        def run(*arrays: Any) -> Any:
            values = dict(zip(names, arrays[len(shapes) :], strict=True))
            return of_model(models.with_parameters(model, values), **chosen)(*arrays[: len(shapes)])

        return run

    with sized(model, quantity, chosen):
        traced = compiler.trace(on_parameters(quantity.build), name=name, doc=doc, **shapes, **extra)
    if not names and (form := _stages_of(model, quantity, chosen)) is not None:
        return replace(traced, columns=form)
    if quantity.columns is None or model.nv < _MIN_COLUMNS:
        return traced
    from ulna.compiler.forms.columns import with_columns

    return with_columns(traced, on_parameters(quantity.build_columns), **shapes, **extra)


def _stages_of_large(
    model: Model, quantity: Quantity, dtype: np.dtype[Any], chosen: Mapping[str, Any]
) -> SecondForm | None:
    """The form of stages of a robot that would be looped over otherwise: it is faster, and its code stays short.

    None where there is none, or where the processor or the size of the results does not suit it.
    """
    if quantity.columns is not None or model.nv > _MAX_STAGES:
        return None
    form = _stages_of(model, quantity, chosen)
    if form is None:
        return None
    from ulna.compiler.codegen.columns import can_write_columns
    from ulna.compiler.runtime import jit

    suits = can_write_columns(form, jit.target(), "double" if dtype == np.float64 else "float")
    return replace(form, serves_batches=True) if suits else None  # type: ignore[type-var]


def _stages_of(model: Model, quantity: Quantity, chosen: Mapping[str, Any]) -> SecondForm | None:
    """The form of stages of a quantity; None where it has none, or where the robot is too small for it."""
    if quantity.stages is None or model.nv < quantity.stages_from:
        return None
    form = quantity.stages(model, **chosen)
    if (
        form is None
        or form.serves_batches
        or estimated_nodes(model, quantity, chosen) < _STAGED_BATCHES_ABOVE
    ):
        return form
    return replace(form, serves_batches=True)  # type: ignore[type-var]


def looped(model: Model, name: str, **options: Any) -> LoopedFunction | None:
    """A quantity of a model by loops over a table of its joints, whatever its size; large robots use it by themselves.

    Args:
        model: The robot's model.
        name: As for `kernel`.
        **options: As for `kernel`.

    Returns:
        The function; None where the quantity, its options or the kinds of joints have no such loops.

    Raises:
        UnknownName: As from `kernel`.
    """
    from ulna.recursions.looped_function import LoopedFunction  # with the language of procedures, for few
    from ulna.recursions.quantities import recursion_of

    quantity, chosen = _choose(name, options)
    recursion = recursion_of(model, quantity, chosen)
    if recursion is None:
        return None
    shapes, doc = _shapes(model, quantity, chosen), _doc(model, quantity, chosen)
    again = partial(looped, model, name, **chosen)
    return LoopedFunction(
        name, doc, model, shapes, recursion, partial(function, model, name, **chosen), (again, ())
    )


def kernel(
    model: Model,
    name: str,
    dtype: Any = np.float64,
    checked: bool = False,
    *,
    parameters: str | Sequence[str] = (),
    device: str = "cpu",
    **options: Any,
) -> Any:
    """The compiled kernel of a quantity for a model.

    Args:
        model: The robot's model; its parameters become constants of the code.
        name: A key of `QUANTITIES`.
        dtype: float64 or float32.
        checked: Whether nan and inf in the inputs raise NonFiniteError, and quaternions that are not unit InputError.
        parameters: Names of model parameters that become further arguments instead, in this order, after the
            others; see `ulna.model.parameters`. They broadcast like all arguments.
        device: "cpu", or "cuda" for an NVIDIA GPU (experimental; see docs/gpu.md).
        **options: Options of the quantity, such as `frame` and `reference`.

    Returns:
        The kernel; see `ulna.compiler.compile`. Equal models share it.

    Raises:
        UnknownName: For an unknown kernel, parameter, option, device, frame or reference; names the nearest.
        InputError: If `checked` is asked for on a GPU.
    """
    check_device(device, checked)
    quantity, chosen = _choose(name, options)
    names = _parameter_names(model, parameters)
    key = (
        model.fingerprint,
        name,
        compiler.element_of(dtype).name,
        checked,
        names,
        device,
        tuple(chosen.items()),
    )
    with _lock:
        compiled = _made.get(key)
        if compiled is None:
            unit = _quaternions(model, quantity) if checked else ()
            if quantity.inverts_mass and not MASS_PARAMETERS & set(names):
                check_mass(model, compiler.element_of(dtype).name)
            is_long = device == "cpu" and not names and _is_long(model, quantity, chosen)
            element = compiler.element_of(dtype)
            form = _stages_of_large(model, quantity, element, chosen) if is_long else None
            if is_long and form is None:
                compiled = _looped_kernel(model, name, element, checked, unit, chosen)
            if compiled is None:
                compiled = _traced_kernel(model, name, dtype, checked, unit, names, device, chosen, form)
            _made[key] = compiled
            _recent.append(compiled)
    return compiled


def _is_long(model: Model, quantity: Quantity, chosen: Mapping[str, Any]) -> bool:
    """Whether straight-line code would take long to compile."""
    is_matrix = quantity.columns is not None or quantity.nodes[1] > _MANY_FOR_A_PAIR
    limit = LOOPED_ABOVE * (_MORE_FOR_MATRICES if is_matrix else 1)
    return estimated_nodes(model, quantity, chosen) > limit


def _traced_kernel(
    model: Model,
    name: str,
    dtype: Any,
    checked: bool,
    unit: Any,
    names: tuple[str, ...],
    device: str,
    chosen: Mapping[str, Any],
    form: SecondForm | None,
) -> Any:
    """The kernel of straight-line code or a second form, or for a GPU."""
    if device == "cuda":
        from ulna.compiler.runtime.cuda_kernel import CudaKernel  # with what it imports, for few

        return CudaKernel(function(model, name, parameters=names, **chosen), dtype)
    quantity = QUANTITIES[name]
    traced = None if names else _deferred(model, quantity, chosen, form)
    if traced is None:
        traced = function(model, name, parameters=names, **chosen)
    return compiler.compile(traced, dtype, checked, unit_entries=unit, labels=labels(model, traced))


def _deferred(
    model: Model, quantity: Quantity, chosen: Mapping[str, Any], form: SecondForm | None
) -> Function | None:
    """A quantity in a second form, that which is given or its own; None without one.

    Single calls do not need the graph, which is traced when it is used.
    """
    if model.nv < _MIN_COLUMNS or (quantity.columns is None and quantity.stages is None):
        return None
    from ulna.compiler.forms.columns import DeferredFunction, column_form

    check_size(
        model, quantity, chosen
    )  # a second form is traced in a fraction of the time: nothing is announced
    form = form or _stages_of(model, quantity, chosen)
    if form is None and quantity.columns is not None:
        shapes = _shapes(model, quantity, chosen)
        form = column_form(quantity.build_columns(model, **chosen), quantity.name, **shapes)
    if form is None:
        return None
    doc = _doc(model, quantity, chosen)
    return DeferredFunction(quantity.name, doc, form, partial(function, model, quantity.name, **chosen))


def _looped_kernel(
    model: Model, name: str, dtype: Any, checked: bool, unit: Any, chosen: Mapping[str, Any]
) -> Any:
    """The kernel that loops over joints; None where there is none."""
    from ulna.recursions.looped_function import LoopedKernel

    made = looped(model, name, **chosen)
    if made is None:
        return None
    again = partial(kernel, model, name, dtype, checked, **chosen)
    return LoopedKernel(made, dtype, checked, unit, labels(model, made), (again, ()))


def labels(model: Model, traced: Function | LoopedFunction) -> dict[str, Sequence[str]]:
    """What the entries of configurations and velocities among the inputs of a function are called.

    Args:
        model: The robot.
        traced: The function.

    Returns:
        The names of the coordinates, by input.
    """
    names = {"nq": model.position_names, "nv": model.velocity_names}
    sizes = {name: argument.size for name, argument in ARRAYS.items()} | {"qd": "nv", "qdd": "nv"}
    known = {port.name: names.get(sizes.get(port.name)) for port in traced.inputs}  # type: ignore[arg-type]
    shapes = {port.name: port.shape for port in traced.inputs}
    return {name: row for name, row in known.items() if row is not None and shapes[name] == (len(row),)}


def named_options(model: Model, quantity: Quantity, options: Mapping[str, Any]) -> dict[str, str]:
    """Which frame, reference and other names a kernel has been made for.

    Args:
        model: The robot.
        quantity: The quantity.
        options: Its options; those that are missing have their default values.

    Returns:
        The names by option; the tool's where a frame is None.
    """
    chosen = {**quantity.options, **options}
    names = {key: value for key, value in chosen.items() if isinstance(value, str)}
    frame = chosen.get("frame", "")
    if frame is None:
        return {"frame": model.tool, **names}
    return names if isinstance(frame, str) else {"frame": ", ".join(map(str, frame)), **names}


def check_device(device: str, checked: bool) -> None:
    """Refuses an unknown device, and checks on one that has none.

    Args:
        device: "cpu" or "cuda".
        checked: Whether nan and inf in the inputs are to be refused.

    Raises:
        UnknownName: For another device.
        InputError: If `checked` is asked for on a GPU.
    """
    if device not in DEVICES:
        raise UnknownName("device", device, DEVICES)
    if device == "cuda" and checked:
        raise InputError(
            "`checked` is True; expected False with device='cuda', since a GPU does not report what is wrong. "
            "Check the arrays before the call."
        )


def _parameter_names(model: Model, parameters: str | Sequence[str]) -> tuple[str, ...]:
    """The names of the parameters, each once."""
    names = (parameters,) if isinstance(parameters, str) else tuple(parameters)
    for name in names:
        models.parameters(model, name)  # raises for an unknown one
        if names.count(name) > 1:
            raise InputError(f"`parameters` names {name!r} {names.count(name)} times; expected once.")
    return names


def _quaternions(model: Model, quantity: Quantity) -> tuple[tuple[int, tuple[int, ...]], ...]:
    """Where configurations among the arguments hold quaternions; nowhere for `normalize`, which normalises them."""
    if quantity.name == "normalize":
        return ()
    inputs = [number for number, array in enumerate(quantity.arrays) if ARRAYS[array].size == "nq"]
    return tuple((number, entries) for number in inputs for entries in model.quaternions)


def shapes_for(model: Model, names: Sequence[str], known: Mapping[str, Any]) -> dict[str, Any]:
    """Shapes of the arguments of a user's function: those of q, q0, q1, v, a, tau, qd and qdd are the model's.

    Args:
        model: The robot.
        names: The names of the arguments.
        known: Shapes by name; they count also where they are known.

    Returns:
        The shape of each argument.

    Raises:
        UnknownName: If a shape is not known, or one is given for another name.
    """
    sizes = {name: ARRAYS[name].size for name in ("q", "q0", "q1", "v", "a", "tau")} | {
        "qd": "nv",
        "qdd": "nv",
    }
    for name in known:
        if name not in names:
            raise UnknownName("argument of the function", name, names)
    shapes = {}
    for name in names:
        if name not in known and name not in sizes:
            fix = f"Give the shape of other arguments: compile(f, robot, {name}=(3,))."
            raise UnknownName("argument of known shape", name, sizes, fix)
        shapes[name] = known[name] if name in known else _shape(model, sizes[name])
    return shapes


def _choose(name: str, options: Mapping[str, Any]) -> tuple[Quantity, dict[str, Any]]:
    """The quantity of that name, and all its options: those that are given, and the default values of the others."""
    quantity = QUANTITIES.get(name)
    if quantity is None:
        search = (
            f"robot.{name} is a method that searches; no kernel stands for it." if name in _SEARCHES else ""
        )
        raise UnknownName("kernel", name, QUANTITIES, search)
    for key in options:
        if key not in quantity.options:
            raise UnknownName(f"option of kernel {name!r}", key, quantity.options)
    chosen = {key: frozen(options.get(key, default)) for key, default in quantity.options.items()}
    if "reference" in chosen:
        check_reference(chosen["reference"])
    return quantity, chosen


def _shapes(model: Model, quantity: Quantity, chosen: Mapping[str, Any]) -> dict[str, Any]:
    return {key: _shape(model, size) for key, size in quantity.arguments(chosen)}


def _doc(model: Model, quantity: Quantity, chosen: Mapping[str, Any]) -> str:
    names = named_options(model, quantity, chosen)
    about = "".join(f" {key.capitalize()}: {value}." for key, value in names.items())
    return f"{quantity.summary} Returns {with_batch(quantity.result)}. Robot: {model.name}.{about}"


def _shape(model: Model, size: Size) -> tuple[int, ...]:
    sizes = (size,) if isinstance(size, str) else size
    return tuple(getattr(model, n) if isinstance(n, str) else n for n in sizes)


@final
class KernelsByName:
    """The kernels of default options that are made: attributes, which Python finds sooner than keys of a dictionary."""

    __slots__ = tuple(QUANTITIES)


@final
class CheckedKernels:
    """The kernels of one model that check their inputs, made when first asked for.

    Reading an attribute, or for other options than the default ones a look into dictionaries, is all that a call costs
    beyond the kernel.

    Args:
        model: The model.
    """

    __slots__ = ("by_name", "by_options", "model")

    def __init__(self, model: Model) -> None:
        self.model = model
        self.by_name = KernelsByName()
        """Those of default options, by name."""
        self.by_options: dict[str, Any] = {}
        """All of a name, by their options: `by_options[name][first][second]`."""

    def make(self, name: str, *options: Any) -> Any:
        """The kernel of a quantity, which is entered in both tables.

        Args:
            name: The quantity.
            *options: All its options in their order, or none for their default values.

        Returns:
            The kernel.
        """
        defaults = QUANTITIES[name].options
        values = options or tuple(defaults.values())
        made = kernel(self.model, name, checked=True, **dict(zip(defaults, values, strict=True)))
        if values == tuple(defaults.values()):
            setattr(self.by_name, name, made)
        *outer, last = (name, *values)
        table = self.by_options
        for key in outer:
            table = table.setdefault(key, {})
        table[last] = made
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return CheckedKernels, (self.model,)


__all__ = [
    "DEVICES",
    "QUANTITIES",
    "CheckedKernels",
    "check_device",
    "frame_of",
    "function",
    "kernel",
    "labels",
    "looped",
    "named_options",
    "shapes_for",
]
