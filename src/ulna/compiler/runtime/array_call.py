"""The checked call of a kernel: conversion, broadcasting, messages, threads, `out=`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from os import environ
from typing import Any, final

import numpy as np

from ulna.checks.arrays import batched_shape, check_core_shape, check_finite, check_not_negative, real_array
from ulna.checks.masked import check_not_masked
from ulna.checks.quaternions import check_unit
from ulna.compiler.codegen.ir_text import DType
from ulna.compiler.codegen.module import emit_batch, serves_batches_one_by_one
from ulna.compiler.language.function import Function
from ulna.compiler.language.ports import Port, batch_shape, wrong_count
from ulna.compiler.language.scalar import Value
from ulna.compiler.runtime import entry_point, gufunc, jit
from ulna.compiler.runtime.foreign import is_foreign, readable, reject_tables
from ulna.compiler.runtime.shared_batch import share
from ulna.compiler.runtime.shared_call import SharedCall, shared_call
from ulna.errors import DtypeError, InputError, ShapeError
from ulna.lazy import Slot, apply, is_deferred
from ulna.system import forks
from ulna.system.helper_threads import cuts, in_threads

Unit = tuple[tuple[int, tuple[int, ...]], ...]
"""Which entries of which inputs must form unit vectors, quaternions say: (number of the input, entries), ..."""

ELEMENT: dict[str, DType] = {"float64": "double", "float32": "float"}
_LEAST_WORK = 2**20  # of a thread, in operations of float64 and bytes of arguments and results: some 0.1 ms
_BLOCKS = 16  # in so much work, which threads take one after the other
_PART = 2  # times so much work has a part by NumPy, which costs 20 to 40 us more
_ROUND = 16  # blocks have multiples of so many rows, as of the numbers of lanes


@final
class ArrayCall:
    """Calls a function with whatever may stand for its arguments.

    Args:
        function: The function.
        dtype: The type of numbers it computes with.
        checked: Whether arguments must be finite.
        unit: Which entries of inputs are unit quaternions.
        not_negative: The numbers of inputs of which no entry may be negative, such as gains.
        labels: By name of an input or number of an output, what the entries of its last axis are called.
        evaluate: What evaluates batches, called as a generalised ufunc is; None to compile one.
        least_rows: Samples for which a thread is worth while [-]; None to estimate them from the function.
    """

    def __init__(
        self,
        function: Function,
        dtype: np.dtype[Any],
        checked: bool,
        unit: Unit = (),
        labels: Mapping[str | int, Sequence[str]] | None = None,
        evaluate: Callable[..., Any] | None = None,
        least_rows: int | None = None,
        not_negative: Sequence[int] = (),
    ) -> None:
        self.function, self.dtype, self.checked, self.unit = function, dtype, checked, unit
        self.not_negative = tuple(not_negative)
        self.labels = {} if labels is None else dict(labels)
        # The kernel, where its single calls can be machine code, and that code, once it is needed.
        self.single: Callable[[], Any] = lambda: None
        self._single_code: tuple[jit.Code, gufunc.Plan] | None = None
        # NumPy's generalised ufuncs need an input, an output, axes longer than 0, and at most 64 arrays.
        ports = gufunc.ports_of(function)
        self.interpreted = (
            not function.inputs or not function.outputs or not all(p.size for p in ports) or len(ports) > 64
        )
        self._ufunc: Any = evaluate
        self.batch_code: jit.Code | None = (
            None  # that has `batch`: a single call's, or made when it is first needed
        )
        self._least_rows = least_rows
        self._shared_call: SharedCall | None = None  # once a batch was shared
        self._lock = forks.lock(forks.KERNEL)

    def __reduce__(self) -> tuple[Any, ...]:
        evaluate = None if isinstance(self._ufunc, np.ufunc) else self._ufunc
        settings = self.unit, self.labels, evaluate, self._least_rows, self.not_negative
        return ArrayCall, (self.function, self.dtype, self.checked, *settings)

    @property
    def input_labels(self) -> dict[str | int, Sequence[str]]:
        """The labels of the inputs alone."""
        return {name: row for name, row in self.labels.items() if isinstance(name, str)}

    @property
    def input_settings(self) -> tuple[Any, ...]:
        """What is checked of the inputs, and what their entries are called, as `compile` takes it after the type."""
        return self.checked, self.unit, self.input_labels, self.not_negative

    @property
    def element(self) -> DType:
        """The type computed in, as LLVM spells it."""
        return ELEMENT[self.dtype.name]

    def batch_ir(self) -> str:
        """IR of the gufunc's inner loop."""
        return emit_batch(self.function, jit.target(), self.element)

    def single_ir(self) -> str:
        """IR of single calls; see `entry_point.entry_ir`."""
        settings = self.checked, self.unit, self.not_negative
        return entry_point.entry_ir(self.function, jit.target(), self.element, *settings)

    def single_code(self) -> jit.Code:
        """Machine code of single calls, compiled when it is first asked for; from then on the kernel runs it."""
        with self._lock:
            if self._single_code is None:
                f, debugged = self.function, environ.get("ULNA_DEBUG", "")
                ir = self.single_ir()
                if "ir" in debugged.split(","):
                    print(ir)
                names = ("entry", "work", "batch") if self._is_batch_in_single_code() else ("entry", "work")
                code = jit.load(f, ir, names)
                if "asm" in debugged:
                    print(jit.assembly(f, ir))
                plan = gufunc.Plan(f, self.element, code.address("work"))
                self._single_code = code, plan
                if (kernel := self.single()) is not None:
                    gufunc.set_code(kernel, code.address("entry"), plan)
            return self._single_code[0]

    def _is_batch_in_single_code(self) -> bool:
        return serves_batches_one_by_one(self.function, jit.target(), self.element)

    def _loop(self) -> jit.Code:
        """Machine code that has the inner loop of the gufunc."""
        if self.single() is not None and self._is_batch_in_single_code():
            return self.single_code()
        return jit.load(self.function, self.batch_ir(), ("batch",))

    @property
    def ufunc(self) -> Any:
        """The gufunc; its loop is compiled when it is first asked for."""
        if self._ufunc is None:
            with self._lock:
                if self._ufunc is None:
                    self.batch_code = code = self._loop()
                    self._ufunc = gufunc.make_ufunc(self.function, code.address("batch"), code, self.element)
        return self._ufunc

    def __call__(self, *args: Any, out: Any = None, threads: int | None = None, **named: Any) -> Any:
        """Evaluates the function; see `ulna.compiler.runtime.kernel.compile` for what may be passed.

        Args:
            *args: The arguments, by position or by name.
            out: Where the results are written; None for new arrays.
            threads: How many threads a large batch may use; None for one.
            **named: The arguments, by position or by name.

        Returns:
            The result, or a tuple of several.

        Raises:
            InputError: `threads` is not a whole number from 1.
            TypeError: the number or the names of the arguments do not fit.
        """
        f = self.function
        if named:
            args = self._bind(args, named)
        if threads is not None:
            _check_threads(threads)
            if (result := self._plain(args, out, threads)) is not None:
                return result
        if len(args) != len(f.inputs):
            raise wrong_count(f.name, [p.name for p in f.inputs], args)
        is_foreign_call = any(is_foreign(a) for a in args)
        if is_foreign_call and any(is_deferred(a) for a in args):
            return self.deferred(args, out, threads)
        if is_foreign_call and not self.interpreted:
            return self._foreign_call(args, out)
        arrays = [self._array(a, port) for a, port in zip(args, f.inputs, strict=True)]
        if any(a.dtype == object for a in arrays):
            return f(*arrays)  # inside a trace: inline
        batch = self._batch(arrays)
        if out is not None:
            self._check_out(out, batch)
        if self.checked:
            self.check_values(arrays)
        fast_call = self.single() if batch == () and (out is None or self._is_exact(out)) else None
        if fast_call is not None:
            return self._sample(fast_call, arrays, out)
        if self.interpreted:
            return self._interpret(arrays, out)
        if (
            threads is not None
            and threads > 1
            and batch
            and (out is None or self._is_apart(arrays, out, batch))
        ):
            return self._threaded(arrays, batch, out, threads)
        return self._apply(arrays, out)

    def _sample(self, fast_call: Any, arrays: Sequence[Any], out: Any) -> Any:
        """The call of one sample by machine code."""
        self.single_code()
        exact = [self._exact(a) for a in arrays]
        if out is None:
            return fast_call(*exact)
        gufunc.take_out(fast_call)
        return fast_call(*exact, out=out if self.function.single or isinstance(out, tuple) else (out,))

    def _foreign_call(self, args: Sequence[Any], out: Any) -> Any:
        """The call where some arguments are arrays of other libraries."""
        for a, port in zip(args, self.function.inputs, strict=True):
            reject_tables(port, a)
            check_not_masked(port.name, a)
        if self.checked:
            self.check_values(
                [self._readable_now(a, p) for a, p in zip(args, self.function.inputs, strict=True)]
            )
        return self._apply(args, out)

    def _readable_now(self, value: Any, port: Port) -> Any:
        """The numbers of an argument that holds them in memory; None for others, which may be lazy."""
        if not isinstance(value, (np.ndarray, np.generic, list, tuple, int, float)):
            return None
        array = np.asarray(value, self.dtype)
        check_core_shape(port.name, array, port.shape)
        return array

    def check_values(self, arrays: Sequence[Any]) -> None:
        """Examines numbers.

        Args:
            arrays: An array (..., shape) for each input; None for unknown numbers.

        Raises:
            NonFiniteError: A number is not finite.
            InputError: A quaternion has not length one, or a number is negative that must not be.
        """
        for a, port in zip(arrays, self.function.inputs, strict=True):
            if a is not None:
                check_finite(port.name, a)
        for number, entries in self.unit:
            if arrays[number] is not None:
                check_unit(self.function.inputs[number].name, arrays[number], [entries])
        for number in self.not_negative:
            if arrays[number] is not None:
                check_not_negative(self.function.inputs[number].name, arrays[number])

    def _apply(self, args: Sequence[Any], out: Any) -> Any:
        result = self.ufunc(*args) if out is None else self.ufunc(*args, out=out)
        return result if self.function.single or isinstance(result, tuple) else (result,)

    def deferred(self, args: Sequence[Any], out: Any = None, threads: int | None = None) -> Any:
        """Evaluates the function on arrays of Dask, block by block when asked for, or of xarray.

        Args:
            args: The arguments, (...).
            out: Must be None.
            threads: How many threads may work on a block; None for one.

        Returns:
            The lazy or labelled result, or a tuple of several.

        Raises:
            InputError: If `out` is given.
        """
        if out is not None:
            raise InputError(
                "`out` is given, but results for arrays of Dask and xarray are new; leave it out."
            )
        for a, port in zip(args, self.function.inputs, strict=True):
            reject_tables(port, a)
        inputs = [Slot(p.name, p.shape, np.float64, self.labels.get(p.name)) for p in self.function.inputs]
        outputs = [
            Slot("", p.shape, self.dtype, self.labels.get(k)) for k, p in enumerate(self.function.outputs)
        ]
        run = self if threads is None else partial(self, threads=threads)
        return apply(run, args, inputs, outputs, is_single=self.function.single)

    def _bind(self, args: tuple[Any, ...], named: dict[str, Any]) -> tuple[Any, ...]:
        """The arguments in order where some are passed by name."""
        names = [p.name for p in self.function.inputs]
        for name in named:
            if name not in names:
                raise TypeError(
                    f"{self.function.name}({', '.join(names)}) has no argument {name!r}; besides its inputs it takes "
                    "`out` and `threads`."
                )
            if name in names[: len(args)]:
                raise TypeError(f"{self.function.name}({', '.join(names)}) got `{name}` twice.")
        return (*args, *(named[name] for name in names[len(args) :] if name in named))

    def _exact(self, array: Any) -> Any:
        """An array that the fast call takes for sure: its very dtype, contiguous, aligned."""
        exact = np.empty(array.shape, self.dtype)
        exact[...] = array
        return exact

    def _is_exact(self, out: Any) -> bool:
        """Whether the fast call writes into `out` for sure."""
        targets = out if type(out) is tuple else (out,)
        return len(targets) == len(self.function.outputs) and all(
            _is_exact(target, port.shape, self.dtype)
            for target, port in zip(targets, self.function.outputs, strict=True)
        )

    def _interpret(self, arrays: Sequence[Any], out: Any) -> Any:
        """Evaluates a function that no generalised ufunc can be, such as one with an axis of length 0."""
        f = self.function
        results = f(*arrays)
        results = [r.astype(self.dtype) for r in ((results,) if f.single else results)]
        if out is not None:
            targets = out if isinstance(out, tuple) else (out,)
            for target, result in zip(targets, results, strict=True):
                np.copyto(target, result)
            results = targets
        if f.single:
            return results[0] if results[0].ndim else results[0][()]
        return tuple(results)

    def _check_out(self, out: Any, batch: tuple[int, ...]) -> None:
        """Refuses what the results of a batch cannot be written to."""
        f = self.function
        targets = out if isinstance(out, tuple) else (out,)
        if len(targets) != len(f.outputs):
            raise InputError(
                f"`out` holds {len(targets)} arrays; {f.name} has {len(f.outputs)} outputs: expected as many arrays, "
                "in a tuple."
            )
        for target, port in zip(targets, f.outputs, strict=True):
            if (
                type(target) is np.ndarray
                and target.shape == batch + port.shape
                and target.dtype == self.dtype
            ):
                continue
            if target is None or is_foreign(target):  # None: a new array
                continue
            if not isinstance(target, np.ndarray):
                raise InputError(f"`out` is of type {type(target).__name__}; expected a NumPy array.")
            wide = target.ndim - len(port.shape)
            if wide < 0 or target.shape[wide:] != port.shape or not _fits(batch, target.shape[:wide]):
                raise ShapeError("out", target.shape, str(batch + port.shape))
            if not np.can_cast(self.dtype, target.dtype, "same_kind"):
                raise DtypeError("out", str(target.dtype), f"{self.dtype}, or what that casts to")

    def _is_apart(self, arrays: Sequence[Any], out: Any, batch: tuple[int, ...]) -> bool:
        """Whether parts of the batch can be written to `out` independently; else NumPy must see the whole."""
        f = self.function
        targets = out if isinstance(out, tuple) else (out,)
        return len(targets) == len(f.outputs) and all(
            isinstance(o, np.ndarray)
            and o.shape == batch + p.shape
            and not any(np.may_share_memory(o, a) for a in arrays)
            for o, p in zip(targets, f.outputs, strict=True)
        )

    def _array(self, value: Any, port: Port) -> Any:
        if type(value) is not np.ndarray:
            value = readable(port, value)
        if type(value) is np.ndarray and value.dtype is self.dtype:
            array = value
        else:
            shape = batched_shape(port.shape)
            array = real_array(port.name, value, shape=shape, dtype=self.dtype, is_symbol=_is_traced)
        check_core_shape(port.name, array, port.shape)
        return array

    def _batch(self, arrays: Sequence[Any]) -> tuple[int, ...]:
        ports = self.function.inputs
        batches = [a.shape[: a.ndim - len(p.shape)] for a, p in zip(arrays, ports, strict=True)]
        if batches and batches.count(batches[0]) == len(batches):
            return batches[0]
        return batch_shape(ports, [a.shape for a in arrays])

    def _plain(self, args: tuple[Any, ...], out: Any, threads: int) -> Any:
        """The result of a batch that is large and of which machine code takes all arrays; None for another."""
        f, call = self.function, self._shared_call
        if call is None or len(args) != len(f.inputs):
            return None
        if type(args[0]) is not np.ndarray or not args[0].ndim:
            return None
        rows = len(args[0])
        threads = min(threads, rows // self._rows_worth_a_thread())
        if threads < 2:
            return None
        if self.checked:
            if any(type(a) is not np.ndarray or a.dtype is not self.dtype for a in args):
                return None
            self.check_values([self._array(a, port) for a, port in zip(args, f.inputs, strict=True)])
        if out is None:
            targets = tuple([np.empty((rows, *p.shape), self.dtype) for p in f.outputs])
        else:
            targets = out if type(out) is tuple else (out,)
        if len(targets) != len(f.outputs) or not call((*args, *targets), threads):
            return None
        return targets[0] if f.single else targets

    def _threaded(self, arrays: Sequence[Any], batch: tuple[int, ...], out: Any, threads: int) -> Any:
        """Cuts the batch along one axis; the GIL is free in the loops."""
        f, rows, least = self.function, math.prod(batch), self._rows_worth_a_thread()
        if rows < 2 * least:
            return self._apply(arrays, out)
        if out is None:
            targets = [np.empty(batch + p.shape, self.dtype) for p in f.outputs]
        else:
            targets = list(out if isinstance(out, tuple) else (out,))
        if not self._is_shared(arrays, targets, batch, min(threads, rows // least), least):
            self._cut(arrays, targets, batch, threads, _PART * least)
        return targets[0] if f.single else tuple(targets)

    def _is_shared(
        self, arrays: Sequence[Any], targets: Sequence[Any], batch: tuple[int, ...], threads: int, least: int
    ) -> bool:
        """Computes a batch by machine code that several threads call; False where its arrays do not allow it."""
        evaluate, code = self.ufunc, self.batch_code  # compiled before other threads begin
        if code is None or evaluate is None:
            return False
        if any(target.dtype != self.dtype or not target.flags.writeable for target in targets):
            return False  # NumPy converts, and refuses what is read only
        block = -(-least // (_BLOCKS * _ROUND)) * _ROUND
        f, loop, ports = self.function, code.address("batch"), gufunc.ports_of(self.function)
        if self._shared_call is None:
            self._shared_call = shared_call(loop, f.inputs, f.outputs, self.dtype, block)
        return share(loop, ports, [*arrays, *targets], batch, block, threads)

    def _cut(
        self, arrays: Sequence[Any], targets: Sequence[Any], batch: tuple[int, ...], threads: int, least: int
    ) -> None:
        """Computes a batch in parts, cut along one axis; NumPy lets go of the interpreter's lock in them."""
        f, axis, evaluate = self.function, int(np.argmax(batch)), self.ufunc
        wide = [
            np.broadcast_to(a, batch + p.shape) if a.ndim > len(p.shape) else a
            for a, p in zip(arrays, f.inputs, strict=True)
        ]
        ends = cuts(batch[axis], threads, -(-least * batch[axis] // math.prod(batch)))
        lead = (slice(None),) * axis

        def part(k: int) -> Callable[[], Any]:
            rows = (*lead, slice(ends[k], ends[k + 1]))
            inputs = [a[rows] if a.ndim > len(p.shape) else a for a, p in zip(wide, f.inputs, strict=True)]
            return partial(evaluate, *inputs, out=tuple(o[rows] for o in targets))

        while not in_threads(part, len(ends) - 1, threads):
            pass  # a child that was forked meanwhile begins again

    def _rows_worth_a_thread(self) -> int:
        """Samples that take longer than another thread takes to begin."""
        if self._least_rows is None:
            numbers = self.function.operations // 8 + sum(
                port.size for port in gufunc.ports_of(self.function)
            )
            rows = _LEAST_WORK // (max(1, numbers) * self.dtype.itemsize)
            self._least_rows = -(-max(1, rows) // _ROUND) * _ROUND
        return self._least_rows


def _check_threads(threads: Any) -> None:
    """Refuses what is no number of threads."""
    if not isinstance(threads, (int, np.integer)) or threads < 1:
        raise InputError(f"`threads` is {threads!r}; expected a whole number, 1 or more, or None for one.")


def _is_exact(target: Any, shape: tuple[int, ...], dtype: np.dtype[Any]) -> bool:
    """Whether compiled code may write an output of this shape and type into `target`."""
    return (
        type(target) is np.ndarray and target.dtype is dtype and target.shape == shape and target.flags.carray
    )


def _fits(batch: tuple[int, ...], target: tuple[int, ...]) -> bool:
    """Whether a batch can be written to leading axes `target`: they may be more or longer, never fewer or shorter."""
    try:
        return np.broadcast_shapes(batch, target) == target
    except ValueError:
        return False


def _is_traced(value: object) -> bool:
    return isinstance(value, Value)
