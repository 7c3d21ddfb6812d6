"""Compiles algorithms for models: algorithm x model -> kernel, by name, each made once.

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
from ulna.kernel_options import (
    DEVICES,
    check_device,
    choose,
    doc_of,
    for_precision,
    labels,
    named_options,
    parameter_names,
    shapes_for,
    shapes_of,
    unit_vector_entries,
)
from ulna.model import Model
from ulna.quantities import QUANTITIES, Quantity
from ulna.quantities.mass import MASS_PARAMETERS, check_mass
from ulna.quantities.quantity import frame_of
from ulna.quantities.size import check_size, estimated_nodes, sized
from ulna.system import forks

if TYPE_CHECKING:
    from ulna.compiler import Function
    from ulna.compiler.language.ports import SecondForm
    from ulna.recursions.looped_function import LoopedFunction

LOOPED_ABOVE = 60_000
"""Operations, as they are estimated, above which a quantity is computed by loops over joints where it can be.

To compile so many takes some three seconds; straight-line code of 50 joints computes 6 to 20 times as fast as loops, in
batches more (benchmarks/large_robots.py)."""

_MORE_FOR_MATRICES = 3
"""How many times as many for quantities in a form of columns, which is compiled in a third of the time, and for others
that take many operations for each pair of joints, whose loops are slowest beside straight-line code."""

_MANY_FOR_A_PAIR = 39
"""Operations."""

_STAGED_BATCHES_ABOVE = 120_000
"""Operations, as they are estimated, above which batches are computed in stages, too: to compile the graph would take
three seconds and more."""

_MAX_STAGES = 200
"""Velocities of a robot up to which stages are used: some take straight-line code, compiled in 6 ms for each joint."""

_MORE_FOR_SCANS = 50
"""How many times as many for quantities whose stages are scans."""

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
    quantity, chosen = choose(name, options)
    names = parameter_names(model, parameters)
    traced = _graph(model, name, chosen, names)
    if not names and (stages := _stages_of(model, quantity, chosen)) is not None:
        return replace(traced, columns=stages)
    if quantity.columns is None or model.nv < quantity.columns_from:
        return traced
    from ulna.compiler.forms.columns import with_columns

    columns = _on_parameters(model, quantity.build_columns, chosen, names)
    return with_columns(traced, columns, **{port.name: port.shape for port in traced.inputs})


def _graph(model: Model, name: str, chosen: Mapping[str, Any], names: tuple[str, ...] = ()) -> Function:
    """The traced function of a quantity for a model, without its other forms."""
    from ulna.system.collector import paused_collection  # imported here: importing Ulna imports few files

    quantity = QUANTITIES[name]
    shapes, doc = shapes_of(model, quantity, chosen), doc_of(model, quantity, chosen)
    shapes |= {key: models.parameters(model, key).shape for key in names}
    doc += f" Parameters: {', '.join(names)}." if names else ""
    run = _on_parameters(model, quantity.build, chosen, names)
    with sized(model, quantity, chosen), paused_collection():  # nodes are in no cycles
        return compiler.trace(run, name=name, doc=doc, **shapes)


def _on_parameters(
    model: Model,
    of_model: Callable[..., Callable[..., Any]],
    chosen: Mapping[str, Any],
    names: tuple[str, ...],
) -> Callable[..., Any]:
    """A function of arrays, the last of which are parameters of the model, from one that is made for a model."""
    if not names:
        return of_model(model, **chosen)

    def run(*arrays: Any) -> Any:
        values = dict(zip(names, arrays[-len(names) :], strict=True))
        return of_model(models.with_parameters(model, values), **chosen)(*arrays[: -len(names)])

    return run


def _stages_of_large(
    model: Model, quantity: Quantity, dtype: np.dtype[Any], chosen: Mapping[str, Any]
) -> SecondForm | None:
    """The form of stages of a robot that would be looped over otherwise: it is faster, and its code stays short.

    None where there is none, or where the processor or the size of the results does not suit it.
    """
    from ulna.algorithms import is_serial

    limit = _MAX_STAGES * (_MORE_FOR_SCANS if quantity.scans else 1)
    if model.nv > limit or (quantity.columns is not None and not is_serial(model)):
        return None
    if (
        quantity.inverts_mass and dtype != np.float64
    ):  # loops compute in float64, and masses of long chains need it
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
    if quantity.stages is None or not _is_large_enough(model, quantity):
        return None
    form = quantity.stages(model, **chosen)
    if form is None:
        return None
    if model.nv < quantity.batches_from:
        return replace(form, serves_batches=False)  # type: ignore[type-var]
    if form.serves_batches or estimated_nodes(model, quantity, chosen) < _STAGED_BATCHES_ABOVE:
        return form
    return replace(form, serves_batches=True)  # type: ignore[type-var]


def _is_large_enough(model: Model, quantity: Quantity) -> bool:
    """Whether a robot has enough velocities for the form of stages of a quantity."""
    if model.nv >= quantity.stages_from or quantity.chains_from is None:
        return model.nv >= quantity.stages_from
    from ulna.algorithms import chain_frames

    return model.nv >= quantity.chains_from and chain_frames(model) is not None


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

    quantity, chosen = choose(name, options)
    recursion = recursion_of(model, quantity, chosen)
    if recursion is None:
        return None
    shapes, doc = shapes_of(model, quantity, chosen), doc_of(model, quantity, chosen)
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
    quantity, chosen = choose(name, options)
    chosen = for_precision(chosen, compiler.element_of(dtype).name)
    names = parameter_names(model, parameters)
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
            unit = unit_vector_entries(model, quantity) if checked else ()
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
        from ulna.compiler.runtime.cuda_kernel import (
            CudaKernel,
        )  # imported here: slow to import, rarely needed

        return CudaKernel(function(model, name, parameters=names, **chosen), dtype)
    quantity = QUANTITIES[name]
    traced = None if names else _deferred(model, quantity, chosen, form)
    if traced is None:
        traced = function(model, name, parameters=names, **chosen)
    return compiler.compile(traced, dtype, checked, unit_entries=unit, labels=labels(model, traced, quantity))


def _deferred(
    model: Model, quantity: Quantity, chosen: Mapping[str, Any], form: SecondForm | None
) -> Function | None:
    """A quantity in a second form, that which is given or its own; None without one.

    Single calls do not need the graph, which is traced when it is used.
    """
    has_columns = quantity.columns is not None and model.nv >= quantity.columns_from
    has_stages = quantity.stages is not None and _is_large_enough(model, quantity)
    if form is None and not has_columns and not has_stages:
        return None
    from ulna.compiler.forms.columns import DeferredFunction, column_form

    if form is None:  # forms are traced in a fraction of the time: nothing is announced
        check_size(model, quantity, chosen)
    form = form or _stages_of(model, quantity, chosen)
    if form is None and has_columns:
        shapes = shapes_of(model, quantity, chosen)
        form = column_form(quantity.build_columns(model, **chosen), quantity.name, **shapes)
    if form is None:
        return None
    doc = doc_of(model, quantity, chosen)
    return DeferredFunction(quantity.name, doc, form, partial(_graph, model, quantity.name, dict(chosen)))


def _looped_kernel(
    model: Model, name: str, dtype: Any, checked: bool, unit: Any, chosen: Mapping[str, Any]
) -> Any:
    """The kernel that loops over joints; None where there is none."""
    from ulna.recursions.looped_function import LoopedKernel

    made = looped(model, name, **chosen)
    if made is None:
        return None
    again = partial(kernel, model, name, dtype, checked, **chosen)
    return LoopedKernel(made, dtype, checked, unit, labels(model, made, QUANTITIES[name]), (again, ()))


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
        *outer, last = (name, *values)
        table = self.by_options
        for key in outer:
            table = table.setdefault(key, {})
        made = table.setdefault(last, made)  # that of another thread stays: machine code may be calling it
        if values == tuple(defaults.values()):
            setattr(self.by_name, name, made)
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
