"""A quantity of one model by loops: what a traced function is to straight-line code, and its kernel."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NoReturn, final

import numpy as np

from ulna.compiler.language.function import Function
from ulna.compiler.language.ports import Port
from ulna.compiler.runtime.array_call import ArrayCall, Unit
from ulna.compiler.runtime.jit import assembly
from ulna.compiler.runtime.kernel import KernelBase
from ulna.errors import InputError
from ulna.model import Model
from ulna.numeric import is_symbolic
from ulna.recursions.composition import Composition
from ulna.recursions.recursion import Recursion
from ulna.typing import Floats

_FLOAT64 = np.dtype(np.float64)
_OUT = {"out"}
_LEAST_ROWS = 4  # for which a thread is worth while; a part of a batch has twice as many


@final
class LoopedFunction:
    """A quantity of one model, evaluated by a recursion; called as NumPy calls a generalised ufunc.

    Args:
        name: The name of the quantity.
        doc: What it is.
        model: The robot.
        inputs: Its inputs.
        recursion: What computes it.
        trace: Makes the function that is traced for the model, which some uses need.
        remake: What makes this function in another process: a function and its arguments.
    """

    has_loops = True

    def __init__(
        self,
        name: str,
        doc: str,
        model: Model,
        inputs: Mapping[str, tuple[int, ...]],
        recursion: Recursion | Composition,
        trace: Callable[[], Function],
        remake: tuple[Any, ...],
    ) -> None:
        self.name, self.doc, self.model = name, doc, model
        self.inputs = tuple(Port(name, shape) for name, shape in inputs.items())
        self.outputs = tuple(Port(f"out{k}", shape) for k, shape in enumerate(recursion.outputs))
        self.evaluator = recursion.evaluator()
        self.trace, self._remake = trace, remake

    def __reduce__(self) -> tuple[Any, ...]:
        return self._remake

    @property
    def single(self) -> bool:
        """Whether there is one output."""
        return len(self.outputs) == 1

    @property
    def signature(self) -> str:
        """Core shapes as NumPy writes them: "(7)->(4,4)"."""
        return "->".join(
            ",".join("(" + ",".join(map(str, port.shape)) + ")" for port in ports)
            for ports in (self.inputs, self.outputs)
        )

    def __call__(self, *arrays: Any, out: Any = None, dtype: Any = np.float64) -> Any:
        """Evaluates the quantity, or inlines its traced function into a trace under way.

        Args:
            *arrays: An array (..., shape) for each input.
            out: An array of the result's shape (...) to write into, or a tuple of it; None for a new one.
            dtype: The type of a new one.

        Returns:
            The result, with the batch axes of the arrays.
        """
        if is_symbolic(*arrays):
            return self.trace()(*arrays)
        rows = [np.asarray(x) for x in arrays]
        batches = {x.shape[: x.ndim - len(p.shape)] for x, p in zip(rows, self.inputs, strict=True)}
        batch = next(iter(batches)) if len(batches) == 1 else np.broadcast_shapes(*batches)
        targets = (
            out if isinstance(out, tuple) else (out,) if out is not None else (None,) * len(self.outputs)
        )
        results = self._evaluated(rows, batch, targets)
        written = tuple(
            result if target is not None else _as_number(result.astype(dtype, copy=False))
            for result, target in zip(results, targets, strict=True)
        )
        return written[0] if self.single else written

    def of_sample(
        self, arrays: Sequence[Any], out: Any, check: Callable[[Sequence[Any]], None] | None = None
    ) -> Any:
        """Evaluates one sample whose arrays the loops read and write as they are, without looking at anything else.

        Args:
            arrays: The arguments, of any kind.
            out: Where the result is written, of any kind; None for new arrays.
            check: Called with the arguments once these are what the loops read.

        Returns:
            The result; None where an argument is not exactly a contiguous array of float64 of its input's shape, or
            `out` is not one array that lies apart.
        """
        if len(arrays) != len(self.inputs) or not all(map(_is_sample, arrays, self.inputs)):
            return None
        if check is not None:
            check(arrays)
        if out is None:
            results = [np.empty(port.shape) for port in self.outputs]
        elif self.single and _is_plain(out, self.outputs[0].shape, arrays):
            results = [out]
        else:
            return None
        rows = [x.reshape(1, -1) for x in results]
        if not all(x.size for x in rows):
            return None
        self.evaluator.evaluate([x.reshape(1, -1) for x in arrays], rows)
        written = tuple(x if out is not None else _as_number(x) for x in results)
        return written[0] if self.single else written

    def _evaluated(self, arrays: Sequence[Any], batch: tuple[int, ...], targets: Sequence[Any]) -> list[Any]:
        """The results, which are the targets where there are any."""
        inputs = [
            np.ascontiguousarray(_spread(x, batch + p.shape), np.float64).reshape(-1, p.size)
            for x, p in zip(arrays, self.inputs, strict=True)
        ]
        shapes = [batch + port.shape for port in self.outputs]
        others = lambda k: [*arrays, *(x for j, x in enumerate(targets) if j != k and x is not None)]  # noqa: E731
        results = [
            target if _is_plain(target, shape, others(k)) else np.empty(shape)
            for k, (target, shape) in enumerate(zip(targets, shapes, strict=True))
        ]
        if all(result.size for result in results):
            rows = [x.reshape(-1, port.size) for x, port in zip(results, self.outputs, strict=True)]
            self.evaluator.evaluate(inputs, rows)
        for target, result in zip(targets, results, strict=True):
            if target is not None and result is not target:
                np.copyto(target, result, casting="same_kind")
        return [result if target is None else target for result, target in zip(results, targets, strict=True)]


def _is_sample(x: Any, port: Port) -> bool:
    """Whether an argument is exactly what the loops read."""
    return type(x) is np.ndarray and x.dtype is _FLOAT64 and x.shape == port.shape and x.flags.c_contiguous


def _spread(x: Any, shape: tuple[int, ...]) -> Any:
    """An array broadcast to a shape; NumPy takes ten microseconds for one that has it already."""
    return x if x.shape == shape else np.broadcast_to(x, shape)


def _as_number(array: Any) -> Any:
    """An array; a number for one without axes."""
    return array if array.ndim else array[()]


def _is_plain(target: Any, shape: tuple[int, ...], arrays: Sequence[Floats]) -> bool:
    """Whether results can be written to an array as they come."""
    return (
        type(target) is np.ndarray
        and target.shape == shape
        and target.dtype == np.float64
        and target.flags.carray
        and not any(np.may_share_memory(target, x) for x in arrays)
    )


@final
class LoopedKernel(KernelBase):
    """A kernel that loops over a table of the model's joints; called like every kernel.

    It computes in float64; a kernel of float32 takes and returns float32.

    Args:
        function: The function.
        dtype: The type of inputs and outputs.
        checked: Whether arguments must be finite.
        unit: Which entries of inputs are unit quaternions.
        labels: By name of an input or number of an output, what the entries of its last axis are called.
        remake: What makes this kernel in another process: a function and its arguments.
    """

    __slots__ = ("__dict__", "__weakref__", "_array_call", "_looped", "_remake")

    def __init__(
        self,
        function: LoopedFunction,
        dtype: np.dtype[Any],
        checked: bool,
        unit: Unit,
        labels: Mapping[str | int, Sequence[str]],
        remake: tuple[Any, ...],
    ) -> None:
        evaluate = function if dtype == np.float64 else partial(function, dtype=dtype)
        call = ArrayCall(function, dtype, checked, unit, labels, evaluate, _LEAST_ROWS)  # type: ignore[arg-type]
        self._array_call, self._looped, self._remake = call, function, remake
        names = ", ".join(port.name for port in function.inputs)
        doc = f"{function.name}({names}): {function.signature}\n\n{function.doc}"
        self.__dict__.update(__doc__=doc)

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Evaluates the kernel; see `ulna.compiler.runtime.kernel.compile`.

        Args:
            *args: The arguments.
            **options: `out` and `threads`.

        Returns:
            The result.
        """
        call = self._array_call
        if call.dtype is _FLOAT64 and options.keys() <= _OUT:
            check = call.check_values if call.checked else None
            result = self._looped.of_sample(args, options.get("out"), check)
            if result is not None:
                return result
        return call(*args, **options)

    @property
    def function(self) -> Function:
        """The function that is traced for the model, which this kernel does without.

        Raises:
            TooLargeError: If its graph would be too large.
        """
        return self._looped.trace()

    @property
    def signature(self) -> str:
        """Core shapes as NumPy writes them: "(7)->(4,4)"."""
        return self._looped.signature

    @property
    def gufunc(self) -> NoReturn:
        """Refused: NumPy's inner loop is separate machine code, which this kernel has not."""
        self._reject("no generalised ufunc", "Call the kernel: it takes batches and `out`.")

    @property
    def operations(self) -> NoReturn:
        """Refused: there is no graph whose operations could be counted."""
        self._reject("no graph of operations")

    @property
    def operation_counts(self) -> NoReturn:
        """Refused, as `operations`."""
        self._reject("no graph of operations")

    def _reject(self, what: str, fix: str = "") -> NoReturn:
        fix = fix or (
            f"robot.function({self._looped.name!r}) traces one, unless it is too large; kernel.ir() shows the code."
        )
        raise InputError(
            f"The kernel {self._looped.name!r} of {self._looped.model.name!r} loops over a table of "
            f"{len(self._looped.model.joints):,} joints and has {what}. {fix}"
        )

    def ir(self, batch: bool = False) -> str:
        """LLVM IR of the loops, for one sample or for lanes of samples; it is the same for all models.

        Args:
            batch: Whether for lanes.

        Returns:
            The text.
        """
        return self._looped.evaluator.procedure(batch).ir()

    def asm(self, batch: bool = False) -> str:
        """Assembly for this machine of the loops.

        Args:
            batch: Whether for lanes.

        Returns:
            The text.
        """
        return assembly(self._looped, self.ir(batch))  # type: ignore[arg-type]

    @property
    def __name__(self) -> str:
        return self._looped.name

    def __repr__(self) -> str:
        joints = len(self._looped.model.joints)
        dtype = self._array_call.dtype.name
        return f"<kernel {self._looped.name}{self.signature} {dtype}, loops over {joints:,} joints>"

    def __reduce__(self) -> tuple[Any, ...]:
        return self._remake
