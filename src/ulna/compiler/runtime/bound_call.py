"""Kernels bound to arrays: what `kernel.into(...)` makes, writes its results into the same arrays at every call."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, final

import numpy as np

from ulna.compiler.runtime import gufunc, native_types
from ulna.compiler.runtime.array_call import ArrayCall
from ulna.compiler.runtime.fast_call import MOST_GATHERED
from ulna.compiler.runtime.gufunc import Binding
from ulna.compiler.runtime.object_layout import holder_slot
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError
from ulna.system import forks
from ulna.typing import Array


class Bound:
    """A kernel with the arrays that it writes into; see `KernelBase.into`."""

    __slots__ = ()

    kernel: Any
    """The kernel."""
    targets: tuple[Array, ...]
    """The arrays, one for each output."""
    __call__: Callable[..., Any]

    def __repr__(self) -> str:
        f = self.kernel.function
        return f"<bound kernel {f.name}{f.signature}, {self.kernel.dtype.name}>"

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError(
            "A bound kernel cannot be pickled or copied: it writes into arrays of this process. Pickle its `kernel` "
            "and bind that anew with `into`."
        )


@final
class CheckedBound(Bound):
    """A bound kernel whose every call checks its arguments in Python, for where there is no compiled fast call.

    Args:
        kernel: The kernel.
        bound: What it is bound to.
        checked_call: What checks the arguments and calls the kernel.
        fallback: What is called where a watched array has changed.
    """

    __slots__ = ("__weakref__", "_checked_call", "_condition", "_fallback", "_pairs", "kernel", "targets")

    def __init__(self, kernel: Any, bound: Binding, checked_call: _CheckedCall, fallback: Any) -> None:
        self.kernel, self.targets, self._condition = kernel, tuple(bound.targets), bound.condition
        self._checked_call, self._fallback = checked_call, fallback
        self._pairs = tuple(
            (live, reference, _layout(live), _layout(reference)) for live, reference in bound.watched
        )

    def __call__(self, *args: Any) -> Any:
        """Evaluates the kernel; see `KernelBase.into`."""
        if self._fallback is None:
            return self._checked_call(*args)
        if self._checked_call.fits(args) and _unchanged(self._pairs):
            try:
                results = self._checked_call.results(*args)
                result = self._checked_call.answer(results)
                if self._condition is None or results[self._condition] > 0.0:
                    return result
            except (
                InputError
            ):  # refused numbers, or no truth value; changed arrays are refused by the fallback, too
                pass
        return self._fallback(*args)


@final
class _CheckedCall:
    """The checked call of a kernel with fixed targets and trailing inputs."""

    def __init__(
        self,
        array_call: ArrayCall,
        bound: Binding,
        slot: str,
        input_slots: tuple[tuple[type | None, str], ...],
    ) -> None:
        self._holder, self._slot, self._input_slots = bound.holder, slot, input_slots
        self._answer = bound.answer
        self.array_call, self.returns = array_call, bound.returned
        self.targets, self.trailing_inputs = tuple(bound.targets), tuple(bound.trailing_inputs)

    def __call__(self, *args: Any) -> Any:
        return self.answer(self.results(*args))

    def results(self, *args: Any) -> tuple[Array, ...]:
        """New arrays with the outputs, which are copied into the targets: another thread may write there, too.

        Args:
            *args: The arguments of a call.

        Returns:
            One array for each output, of its shape (...).
        """
        self.check()
        made = tuple(np.empty_like(target) for target in self.targets)
        out = made[0] if len(made) == 1 else made
        self.array_call(*self.unwrapped(args), *self.trailing_inputs, out=out)
        for target, values in zip(self.targets, made, strict=True):
            target[...] = values
        return made

    def answer(self, results: tuple[Array, ...]) -> Any:
        """What a call with these results (...) returns."""
        copies = tuple(results[k].copy() if results[k].ndim else results[k][()] for k in self.returns)
        result = copies[0] if len(copies) == 1 else copies or self._answer
        if self._holder is None:
            return result
        if self._holder is float or self._holder is bool:
            return self._number(result)
        instance = object.__new__(self._holder)
        setattr(instance, self._slot, result)
        return instance

    def _number(self, result: Any) -> Any:
        """The result as a number of Python, or as a truth value."""
        if self._holder is bool and np.isnan(result):
            name = self.array_call.function.outputs[self.returns[0]].name
            raise NonFiniteError(
                name, (), float(result), "NaN has no truth value: pass `otherwise` to into()."
            )
        return (float if self._holder is float else bool)(result)

    def check(self) -> None:
        """Raises where bound arrays were changed in place: resized, made read-only, given another shape or type."""
        try:
            _check_targets(self.array_call, self.targets)
            _check_trailing_inputs(self.array_call, self.trailing_inputs)
        except InputError as error:
            error.args = (
                f"{error} The array was changed after into(); restore it, or bind the kernel anew.",
            )
            raise

    def unwrapped(self, args: tuple[Any, ...]) -> tuple[Any, ...]:
        """The arguments, with arrays in place of the objects that hold them."""
        slots = self._input_slots
        pairs = zip(args, slots, strict=False)
        held = (getattr(x, slot, x) if type(x) is kind else x for x, (kind, slot) in pairs)
        return (*held, *args[len(slots) :])

    def fits(self, args: tuple[Any, ...]) -> bool:
        """Whether the arguments are what the fast call takes."""
        kinds = [kind for kind, _ in self._input_slots]
        if any(kind and type(x) is not kind for x, kind in zip(args, kinds, strict=False)):
            return False
        args = self.unwrapped(args)
        ports, dtype = self.array_call.function.inputs, self.array_call.dtype
        ports = ports[: len(ports) - len(self.trailing_inputs)]
        kinds += [None] * (len(ports) - len(kinds))
        return len(args) == len(ports) and all(
            (
                type(a) is np.ndarray
                and a.dtype is dtype
                and a.shape == p.shape
                and (_is_readable(a) or (kind is None and _is_gathered(a)))
            )
            or (p.shape == () and dtype == np.float64 and type(a) in (float, np.float64))
            for a, p, kind in zip(args, ports, kinds, strict=True)
        )


@final
class _CheckedFallback:
    """Calls a function instead of the kernel, after checking that the bound arrays were not changed in place."""

    def __init__(self, checked_call: _CheckedCall, function: Callable[..., Any]) -> None:
        self._checked_call, self._function = checked_call, function

    def __call__(self, *args: Any, **named: Any) -> Any:
        self._checked_call.check()
        return self._function(*args, **named)


def _is_readable(array: Array) -> bool:
    return array.flags.c_contiguous and array.flags.aligned


def _is_gathered(array: Array) -> bool:
    """Whether compiled code takes an array with gaps."""
    small = array.ndim in (1, 2) and 0 < array.size <= MOST_GATHERED
    return small and array.dtype == np.float64 and array.flags.aligned


def _layout(array: Array) -> tuple[Any, ...]:
    """The properties of an array that must not change for compiled code to go on reading it."""
    return array.shape, array.dtype, _is_readable(array)


def _unchanged(pairs: Sequence[tuple[Any, ...]]) -> bool:
    return all(
        _layout(live) == live_layout
        and _layout(reference) == reference_layout
        and live.tobytes() == reference.tobytes()
        for live, reference, live_layout, reference_layout in pairs
    )


_lock = forks.lock(forks.KERNEL)
_types: list[type | None] = []


def bound_type() -> type | None:
    """The type of bound kernels that are machine code; None where there is none."""
    with _lock:
        if not _types:
            _types.append(native_types.make_type(Bound, "Bound"))
        return _types[0]


def bind(
    kernel: Any, array_call: ArrayCall, work: int | None, bound: Binding, otherwise: Callable[..., Any] | None
) -> Bound:
    """Makes the result of `KernelBase.into`.

    Args:
        kernel: The kernel that is bound; it is kept alive.
        array_call: The checked call of its function.
        work: Address of the kernel's code, or None where there is no compiled code.
        bound: What it is bound to.
        otherwise: Called instead of the kernel where what is watched has changed; after it where the condition fails.

    Returns:
        The bound kernel.

    Raises:
        InputError: If an array does not fit, an index names no output, or `watched` comes without `otherwise`.
    """
    bound = _checked(array_call, bound, otherwise)
    slot = "" if bound.holder is None else _holder_slot(bound.holder, bound.returned, bound.targets)
    input_slots = _input_slots(
        bound.input_holders, len(array_call.function.inputs) - len(bound.trailing_inputs)
    )
    checked_call = _CheckedCall(array_call, bound, slot, input_slots)
    fallback: Any = checked_call
    if otherwise is not None:  # without the attribute the arrays are examined first, in Python
        examines = getattr(otherwise, "examines_arrays", False)
        fallback = otherwise if examines else _CheckedFallback(checked_call, otherwise)
    kind = bound_type() if work is not None else None
    if kind is None or work is None:
        return CheckedBound(kernel, bound, checked_call, None if otherwise is None else fallback)
    plan = gufunc.Plan(array_call.function, array_call.element, work, bound)
    instance = gufunc.make_bound(kind, plan, fallback)
    instance.__dict__.update(kernel=kernel, targets=bound.targets)
    gufunc.keep(instance, kernel, plan, fallback)
    return instance


def _checked(array_call: ArrayCall, bound: Binding, otherwise: Any) -> Binding:
    """The same of tuples, where all of it fits."""
    outputs, pairs = tuple(bound.targets), tuple((live, reference) for live, reference in bound.watched)
    inputs, returned = tuple(bound.trailing_inputs), tuple(int(k) for k in bound.returned)
    _check_targets(array_call, outputs)
    _check_trailing_inputs(array_call, inputs)
    _check_pairs(pairs)
    if pairs and otherwise is None:
        raise InputError("`watch` is given without `otherwise`; expected a function for when it differs.")
    for k in returned:
        if not 0 <= k < len(outputs):
            raise InputError(f"`returns` names output {k}; expected 0 to {len(outputs) - 1}.")
    if bound.condition is not None:
        _check_condition(bound.condition, outputs, otherwise)
    holders = tuple(bound.input_holders)
    return Binding(outputs, pairs, returned, inputs, bound.holder, holders, bound.condition, bound.answer)


def _check_condition(condition: int, targets: tuple[Array, ...], otherwise: Any) -> None:
    if otherwise is None:
        raise InputError("`condition` is given without `otherwise`; expected a function for where it fails.")
    of = targets[condition] if 0 <= condition < len(targets) else None
    if of is None or of.shape != () or of.dtype != np.float64:
        raise InputError(
            f"`condition` is {condition!r}; expected the index of an output that is one float64."
        )


def _input_slots(holders: Sequence[type | None], passed: int) -> tuple[tuple[type | None, str], ...]:
    """The classes, each with the name of its slot."""
    slots = tuple((holder, "" if holder is None else holder_slot(holder)) for holder in holders)
    wrong = [holder for holder, slot in slots if holder is not None and not slot]
    if wrong or len(holders) > passed:
        raise InputError(
            f"`input_holders` is {holders!r}; expected at most {passed} entries, as many as calls pass inputs, each a "
            "class with one slot and nothing else, or None."
        )
    return slots


def _holder_slot(holder: type, returns: Sequence[int], targets: Sequence[Array]) -> str:
    if holder in (float, bool):
        returned = [targets[k] for k in returns]
        if len(returned) != 1 or returned[0].shape != () or returned[0].dtype != np.float64:
            raise InputError(
                f"`holder` is {holder.__name__}; expected one returned output, a single float64."
            )
        return ""
    slot = holder_slot(holder)
    if not slot or len(returns) != 1:
        raise InputError(
            f"`holder` is {holder.__name__}, and `returns` names {len(returns)} outputs; expected a class with one "
            "slot and nothing else, and one output."
        )
    return slot


def _check_targets(array_call: ArrayCall, targets: tuple[Any, ...]) -> None:
    f, dtype = array_call.function, array_call.dtype
    if len(targets) != len(f.outputs):
        raise InputError(f"into() was given {len(targets)} arrays; {f.name} has {len(f.outputs)} outputs.")
    for target, port in zip(targets, f.outputs, strict=True):
        if type(target) is not np.ndarray:
            raise InputError(f"into() was called with a {type(target).__name__}; expected NumPy arrays.")
        if target.dtype != dtype:
            raise DtypeError(port.name, str(target.dtype), f"{dtype}, which {f.name} computes in")
        if target.shape != port.shape:
            raise ShapeError(port.name, target.shape, str(port.shape))
        if not target.flags.carray:
            raise InputError(
                f"The array for `{port.name}` is read-only or has gaps; expected C-contiguous and writeable."
            )
    spans = sorted((x.__array_interface__["data"][0], x.nbytes) for x in targets if x.nbytes)
    if any(start + size > following for (start, size), (following, _) in pairwise(spans)):
        raise InputError("Arrays given to into() share memory; expected a separate array for each output.")


def _check_trailing_inputs(array_call: ArrayCall, arrays: tuple[Any, ...]) -> None:
    ports, dtype = array_call.function.inputs, array_call.dtype
    if len(arrays) > len(ports):
        raise InputError(
            f"into() was given {len(arrays)} inputs; {array_call.function.name} has {len(ports)}."
        )
    for array, port in zip(arrays, ports[len(ports) - len(arrays) :], strict=True):
        if type(array) is not np.ndarray or array.dtype != dtype or not _is_readable(array):
            raise InputError(f"`trailing_inputs` holds no C-contiguous array of {dtype} for `{port.name}`.")
        if array.shape != port.shape:
            raise ShapeError(port.name, array.shape, str(port.shape))


def _check_pairs(pairs: tuple[tuple[Any, Any], ...]) -> None:
    for pair in pairs:
        for x in pair:
            if type(x) is not np.ndarray or not _is_readable(x) or x.nbytes % 8 or x.dtype.hasobject:
                raise InputError(
                    "`watch` holds something else; expected C-contiguous arrays of whole 8-byte words."
                )
        if pair[0].nbytes != pair[1].nbytes:
            raise InputError(
                f"A pair in `watch` has {pair[0].nbytes} and {pair[1].nbytes} bytes; expected as many."
            )
