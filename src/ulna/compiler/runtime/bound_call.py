"""Kernels bound to arrays: what `kernel.into(...)` makes, writes its results into the same arrays at every call."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from ulna.compiler.runtime import gufunc
from ulna.compiler.runtime.array_call import ArrayCall
from ulna.compiler.runtime.object_layout import holder_slot
from ulna.errors import DtypeError, InputError, ShapeError
from ulna.system import forks
from ulna.typing import Array

_Pairs = Sequence[tuple[Array, Array]]


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
class SlowBound(Bound):
    """A bound kernel where the fast call does not work.

    Args:
        kernel: The kernel.
        targets: The arrays (...) that results are written to.
        checked_call: What checks the arguments and calls the kernel.
        pairs: Arrays to watch, each with a copy of what it held.
        slow: What is called where a watched array has changed.
    """

    __slots__ = ("__weakref__", "_checked_call", "_pairs", "_slow", "kernel", "targets")

    def __init__(
        self, kernel: Any, targets: tuple[Array, ...], checked_call: _CheckedCall, pairs: _Pairs, slow: Any
    ) -> None:
        self.kernel, self.targets = kernel, targets
        self._checked_call, self._slow = checked_call, slow
        self._pairs = tuple((live, reference, _form(live), _form(reference)) for live, reference in pairs)

    def __call__(self, *args: Any) -> Any:
        """Evaluates the kernel; see `KernelBase.into`."""
        if self._slow is not None and not (self._checked_call.fits(args) and _same(self._pairs)):
            return self._slow(*args)
        return self._checked_call(*args)


@final
class _CheckedCall:
    """The checked call of a kernel with fixed targets and last inputs."""

    def __init__(
        self,
        array_call: ArrayCall,
        targets: tuple[Array, ...],
        returns: tuple[int, ...],
        last_inputs: tuple[Array, ...],
        holder: type | None,
        slot: str,
    ) -> None:
        self._holder, self._slot = holder, slot
        self.array_call, self.targets, self.returns, self.last_inputs = (
            array_call,
            targets,
            returns,
            last_inputs,
        )
        self._out = targets[0] if len(targets) == 1 else targets

    def __call__(self, *args: Any) -> Any:
        self.check()
        self.array_call(*args, *self.last_inputs, out=self._out)
        copies = tuple(
            self.targets[k].copy() if self.targets[k].ndim else self.targets[k][()] for k in self.returns
        )
        result = copies[0] if len(copies) == 1 else copies or None
        if self._holder is None:
            return result
        if self._holder is float or self._holder is bool:
            number: Any = result
            return self._holder(number)
        instance = object.__new__(self._holder)
        setattr(instance, self._slot, result)
        return instance

    def check(self) -> None:
        """Raises where bound arrays were changed in place: resized, made read-only, given another shape or type."""
        try:
            _check_targets(self.array_call, self.targets)
            _check_last_inputs(self.array_call, self.last_inputs)
        except InputError as error:
            error.args = (
                f"{error} The array was changed after into(); restore it, or bind the kernel anew.",
            )
            raise

    def fits(self, args: tuple[Any, ...]) -> bool:
        """Whether the arguments are what the fast call takes."""
        ports, dtype = self.array_call.function.inputs, self.array_call.dtype
        ports = ports[: len(ports) - len(self.last_inputs)]
        return len(args) == len(ports) and all(
            (type(a) is np.ndarray and a.dtype is dtype and a.shape == p.shape and _is_readable(a))
            or (p.shape == () and dtype == np.float64 and type(a) in (float, np.float64))
            for a, p in zip(args, ports, strict=True)
        )


@final
class _Otherwise:
    """What is called instead of a bound kernel, once its arrays are known to be intact."""

    def __init__(self, checked_call: _CheckedCall, function: Callable[..., Any]) -> None:
        self._checked_call, self._function = checked_call, function

    def __call__(self, *args: Any, **named: Any) -> Any:
        self._checked_call.check()
        return self._function(*args, **named)


def _is_readable(array: Array) -> bool:
    return array.flags.c_contiguous and array.flags.aligned


def _form(array: Array) -> tuple[Any, ...]:
    """The properties of an array that must not change for compiled code to go on reading it."""
    return array.shape, array.dtype, _is_readable(array)


def _same(pairs: Sequence[tuple[Any, ...]]) -> bool:
    return all(
        _form(live) == live_form
        and _form(reference) == reference_form
        and live.tobytes() == reference.tobytes()
        for live, reference, live_form, reference_form in pairs
    )


_lock = forks.lock(forks.KERNEL)
_types: list[type | None] = []


def bound_type() -> type | None:
    """The type of bound kernels that are machine code; None where there is none."""
    with _lock:
        if not _types:
            _types.append(gufunc.make_type(Bound, "Bound"))
        return _types[0]


def bind(
    kernel: Any,
    array_call: ArrayCall,
    work: int | None,
    targets: Sequence[Array],
    returns: Sequence[int],
    watch: _Pairs,
    otherwise: Callable[..., Any] | None,
    last_inputs: Sequence[Array] = (),
    holder: type | None = None,
) -> Bound:
    """Makes the result of `KernelBase.into`.

    Args:
        kernel: The kernel that is bound; it is kept alive.
        array_call: The checked call of its function.
        work: Address of the kernel's code, or None where there is no compiled code.
        targets: Arrays that take the outputs, each contiguous and of the shape of its output (...).
        returns: Numbers of the outputs that a call returns.
        watch: Pairs (live array, reference copy); a call with any difference between them goes to `otherwise`.
        otherwise: Called instead of the kernel when `watch` finds a difference.
        last_inputs: Arrays for the last inputs, each of the shape of its input (...), which calls then leave out.
        holder: A class with one slot; a call returns an instance that holds the one result. Or float or bool: a call
            returns that of the one number.

    Returns:
        The bound kernel.

    Raises:
        InputError: If an array does not fit, `returns` names no output, or `watch` comes without `otherwise`.
    """
    chosen, inputs, pairs = (
        tuple(targets),
        tuple(last_inputs),
        tuple((live, reference) for live, reference in watch),
    )
    numbers = tuple(int(k) for k in returns)
    _check_targets(array_call, chosen)
    _check_last_inputs(array_call, inputs)
    _check_pairs(pairs)
    if pairs and otherwise is None:
        raise InputError("`watch` is given without `otherwise`; expected a function for when it differs.")
    for k in numbers:
        if not 0 <= k < len(chosen):
            raise InputError(f"`returns` names output {k}; expected 0 to {len(chosen) - 1}.")
    slot = "" if holder is None else _holder_slot(holder, numbers, chosen)
    checked_call = _CheckedCall(array_call, chosen, numbers, inputs, holder, slot)
    slow = checked_call if otherwise is None else _Otherwise(checked_call, otherwise)
    kind = bound_type() if work is not None else None
    if kind is None or work is None:
        return SlowBound(kernel, chosen, checked_call, pairs, None if otherwise is None else slow)
    plan = gufunc.Plan(array_call.function, array_call.element, work, chosen, pairs, numbers, inputs, holder)
    instance = gufunc.make_bound(kind, plan, slow)
    instance.__dict__.update(kernel=kernel, targets=chosen)
    gufunc.keep(instance, kernel, plan, slow)
    return instance


def _holder_slot(holder: type, returns: tuple[int, ...], targets: tuple[Array, ...]) -> str:
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
    for k, target in enumerate(targets):
        if any(np.may_share_memory(target, other) for other in targets[:k]):
            raise InputError(
                "Arrays given to into() share memory; expected a separate array for each output."
            )


def _check_last_inputs(array_call: ArrayCall, arrays: tuple[Any, ...]) -> None:
    ports, dtype = array_call.function.inputs, array_call.dtype
    if len(arrays) > len(ports):
        raise InputError(
            f"into() was given {len(arrays)} inputs; {array_call.function.name} has {len(ports)}."
        )
    for array, port in zip(arrays, ports[len(ports) - len(arrays) :], strict=True):
        if type(array) is not np.ndarray or array.dtype != dtype or not _is_readable(array):
            raise InputError(f"`last_inputs` holds no C-contiguous array of {dtype} for `{port.name}`.")
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
