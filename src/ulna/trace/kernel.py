"""A compiled function, as users hold it: called like a NumPy ufunc, 100 ns a call, batches in SIMD lanes."""

from __future__ import annotations

import os
import threading
import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError
from ulna.trace import jit, native
from ulna.trace.emit import emit_batch
from ulna.trace.function import Function, Port, trace
from ulna.trace.graph import Graph
from ulna.trace.irtext import DType

_ELEMENT: dict[str, DType] = {"float64": "double", "float32": "float"}
_ROWS_PER_THREAD = 1024  # below this, starting a thread costs more than the work


class _General:
    """Everything but the exact single sample: conversion, broadcasting, messages, threads, `out=`."""

    def __init__(self, function: Function, dtype: np.dtype[Any], checked: bool) -> None:
        self.function, self.dtype, self.checked = function, dtype, checked
        self.single: Callable[[], Any] = lambda: None  # the fast door, once there is one
        # NumPy's generalised ufuncs need an input, an output, axes longer than 0, and at most 64 arrays.
        ports = native.ports_of(function)
        self.interpreted = (
            not function.inputs or not function.outputs or not all(p.size for p in ports) or len(ports) > 64
        )
        self._ufunc: np.ufunc | None = None
        self._lock = threading.Lock()

    @property
    def element(self) -> DType:
        return _ELEMENT[self.dtype.name]

    @property
    def lanes(self) -> int:
        return max(jit.target().register_bytes // self.dtype.itemsize, 2)

    def batch_ir(self) -> str:
        return emit_batch(self.function, self.element, self.lanes)

    @property
    def ufunc(self) -> np.ufunc:
        """The gufunc; its loop is compiled when it is first asked for."""
        if self._ufunc is None:
            with self._lock:
                if self._ufunc is None:
                    code = jit.load(self.batch_ir(), ("batch",))
                    self._ufunc = native.make_ufunc(self.function, code.address("batch"), code, self.element)
        return self._ufunc

    def __call__(self, *args: Any, out: Any = None, threads: int | None = None, **named: Any) -> Any:
        f = self.function
        if named:
            args = self._bind(args, named)
        if len(args) != len(f.inputs):
            names = ", ".join(p.name for p in f.inputs)
            raise TypeError(f"{f.name}({names}) takes {len(f.inputs)} arguments; {len(args)} were given.")
        if not self.interpreted and any(_is_foreign(a) for a in args):
            if self.checked:
                for a, port in zip(args, f.inputs, strict=True):
                    if isinstance(a, (np.ndarray, list, tuple, int, float)):  # others, as Dask's, may be lazy
                        _check_finite(port.name, np.asarray(a, self.dtype))
            return self._apply(args, out)
        arrays = [self._array(a, port) for a, port in zip(args, f.inputs, strict=True)]
        if any(a.dtype == object for a in arrays):
            return f(*arrays)  # inside a trace: inline
        batch = self._batch(arrays)
        if self.checked:
            for a, port in zip(arrays, f.inputs, strict=True):
                _check_finite(port.name, a)
        if batch == () and out is None:
            door = self.single()
            if door is not None:
                return door(*(self._exact(a) for a in arrays))
        if self.interpreted:
            return self._interpret(arrays, out)
        rows = int(np.prod(batch, dtype=np.int64))
        many = threads is not None and threads > 1 and rows >= 2 * _ROWS_PER_THREAD
        if many and batch and (out is None or self._is_apart(arrays, out, batch)):
            assert threads is not None
            return self._threaded(arrays, batch, out, min(threads, rows // _ROWS_PER_THREAD))
        return self._apply(arrays, out)

    def _apply(self, args: Sequence[Any], out: Any) -> Any:
        result = self.ufunc(*args) if out is None else self.ufunc(*args, out=out)
        return result if self.function.single or isinstance(result, tuple) else (result,)

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
        """An array that the fast door takes for sure: its very dtype, contiguous, aligned."""
        exact = np.empty(array.shape, self.dtype)
        exact[...] = array
        return exact

    def _interpret(self, arrays: Sequence[Any], out: Any) -> Any:
        """Evaluates a function that no generalised ufunc can be, such as one with an axis of length 0."""
        f = self.function
        results = f(*arrays)
        results = [r.astype(self.dtype) for r in ((results,) if f.single else results)]
        if out is not None:
            given = out if isinstance(out, tuple) else (out,)
            for target, result in zip(given, results, strict=True):
                np.copyto(target, result)
            results = given
        if f.single:
            return results[0] if results[0].ndim else results[0][()]
        return tuple(results)

    def _is_apart(self, arrays: Sequence[Any], out: Any, batch: tuple[int, ...]) -> bool:
        """Whether parts of the batch can be written to `out` independently; else NumPy must see the whole."""
        f = self.function
        given = out if isinstance(out, tuple) else (out,)
        return len(given) == len(f.outputs) and all(
            isinstance(o, np.ndarray)
            and o.shape == batch + p.shape
            and not any(np.may_share_memory(o, a) for a in arrays)
            for o, p in zip(given, f.outputs, strict=True)
        )

    def _array(self, value: Any, port: Port) -> Any:
        try:
            array = np.asarray(value)
        except ValueError as error:  # ragged lists
            raise InputError(
                f"`{port.name}` is ragged; expected an array of numbers, shape {_shown(port)}. NumPy says: {error}"
            ) from None
        if array.dtype != self.dtype:
            if array.dtype == object:
                return self._objects(array, port)
            if array.dtype.kind not in "fiub":
                raise DtypeError(port.name, str(array.dtype))
            array = array.astype(self.dtype)
        core = len(port.shape)
        if array.ndim < core or array.shape[array.ndim - core :] != port.shape:
            raise ShapeError(port.name, array.shape, _shown(port), _shape_mend(array.shape, port))
        return array

    def _objects(self, array: Any, port: Port) -> Any:
        from ulna.trace.scalar import Value

        if any(isinstance(v, Value) for v in array.reshape(-1)):
            return array
        odd = next((v for v in array.reshape(-1) if v is None or isinstance(v, (str, bytes))), 0)
        if odd != 0:  # NumPy would make nan of None and parse text
            raise DtypeError(port.name, f"object and holds {odd!r}")
        try:
            numbers = array.astype(self.dtype)
        except (TypeError, ValueError) as error:
            raise DtypeError(port.name, "object", mend=f"NumPy says: {error}.") from None
        return self._array(numbers, port)

    def _batch(self, arrays: Sequence[Any]) -> tuple[int, ...]:
        ports = self.function.inputs
        batches = [a.shape[: a.ndim - len(p.shape)] for a, p in zip(arrays, ports, strict=True)]
        try:
            return np.broadcast_shapes(*batches)
        except ValueError:
            said = ", ".join(f"`{p.name}` {a.shape}" for a, p in zip(arrays, ports, strict=True))
            raise ShapeError(
                ports[-1].name, arrays[-1].shape, "leading axes that broadcast", f"Together: {said}."
            ) from None

    def _threaded(self, arrays: Sequence[Any], batch: tuple[int, ...], out: Any, threads: int) -> Any:
        """Cuts the batch into equal parts along one axis; the GIL is free in the loops."""
        f = self.function
        if out is None:
            given = [np.empty(batch + p.shape, self.dtype) for p in f.outputs]
        else:
            given = list(out if isinstance(out, tuple) else (out,))
        wide = [
            np.broadcast_to(a, batch + p.shape) if a.ndim > len(p.shape) else a
            for a, p in zip(arrays, f.inputs, strict=True)
        ]
        axis = int(np.argmax(batch))
        cuts = np.linspace(0, batch[axis], min(threads, batch[axis]) + 1).astype(int)
        lead = (slice(None),) * axis

        def part(k: int) -> None:
            rows = (*lead, slice(cuts[k], cuts[k + 1]))
            inputs = [a[rows] if a.ndim > len(p.shape) else a for a, p in zip(wide, f.inputs, strict=True)]
            self.ufunc(*inputs, out=tuple(o[rows] for o in given))

        ufunc = self.ufunc  # compile before the threads start
        assert ufunc is not None
        with ThreadPoolExecutor(len(cuts) - 1) as pool:
            list(pool.map(part, range(len(cuts) - 1)))
        return given[0] if f.single else tuple(given)


def _is_foreign(value: Any) -> bool:
    """Whether an argument brings its own meaning of ufuncs: subclasses of ndarray, Dask arrays and the like."""
    return (
        type(value) is not np.ndarray
        and hasattr(value, "__array_ufunc__")
        and not isinstance(value, np.generic)
    )


def _shown(port: Port) -> str:
    return "(" + ", ".join(["...", *map(str, port.shape)]) + ")"


def _shape_mend(given: tuple[int, ...], port: Port) -> str:
    core = len(port.shape)
    if given and core and given[::-1][:core] == port.shape:
        return "It looks transposed."
    if len(given) == core + 1 and given[:core] == port.shape:
        return "The batch axis comes first: pass the transpose."
    if core == 1 and given and given[-1] != port.shape[0]:
        return f"The last axis holds the {port.shape[0]} numbers of one sample."
    return ""


def _check_finite(name: str, array: Any) -> None:
    with np.errstate(over="ignore", invalid="ignore"):
        if np.isfinite(array.sum()):  # one cheap pass in the good case
            return
    bad = ~np.isfinite(array)
    if bad.any():
        index = tuple(int(i) for i in np.argwhere(bad)[0])
        raise NonFiniteError(name, index, float(array[index]))


class KernelBase:
    """What every kernel offers beside being called; see `Kernel`."""

    __slots__ = ()

    _general: _General

    @property
    def function(self) -> Function:
        """The traced function behind the kernel."""
        return self._general.function

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type computed in: float64 or float32."""
        return self._general.dtype

    @property
    def gufunc(self) -> np.ufunc:
        """The NumPy generalised ufunc, for `dask.array.apply_gufunc` and the like."""
        return self._general.ufunc

    @property
    def signature(self) -> str:
        """Core shapes as NumPy writes them: "(7)->(4,4)"."""
        return self.function.signature

    @property
    def graph(self) -> Graph:
        """The graph of the function."""
        return self.function.graph

    @property
    def operations(self) -> int:
        """How many scalar operations one evaluation takes."""
        return self.function.operations

    @property
    def operation_counts(self) -> dict[str, int]:
        """How often each operation occurs."""
        return self.function.operation_counts

    @property
    def is_fast(self) -> bool:
        """Whether single calls take the 100 ns door (else they go through the gufunc)."""
        return isinstance(self, _NATIVE) if _NATIVE is not None else False

    def ir(self, batch: bool = False) -> str:
        """LLVM IR of the single call, or of the loop over a batch."""
        return self._general.batch_ir() if batch else _entry_ir(self._general)

    def asm(self, batch: bool = False) -> str:
        """Assembly for this machine of the single call, or of the loop over a batch."""
        return jit.assembly(self.ir(batch))

    def jacobian(self, wrt: str | int = 0) -> Any:
        """The kernel of the derivative of the outputs by input `wrt`, shape output + input."""
        return compile(self.function.jacobian(wrt), dtype=self.dtype, checked=self._general.checked)

    def draw(self, path: str | None = None) -> str:
        """The graph as an SVG picture; written to `path` when one is given."""
        return self.function.draw(path)

    def dask(self, *args: Any) -> Any:
        """Applies the kernel to Dask arrays, lazily: `dask.array.apply_gufunc` with this kernel's signature."""
        try:
            import dask.array as da  # pyright: ignore[reportMissingImports]
        except ImportError:
            from ulna.errors import MissingExtra

            raise MissingExtra("dask", "cluster", "Applying a kernel to Dask arrays") from None
        letters = iter("abcdefghijklmnopqrstuvwxyz")
        names: list[str] = []
        sizes: dict[str, int] = {}
        for port in native.ports_of(self.function):
            axes = [next(letters) for _ in port.shape]
            sizes.update(zip(axes, port.shape, strict=True))
            names.append("(" + ",".join(axes) + ")")
        count = len(self.function.inputs)
        inside = {d for n in names[:count] for d in n.strip("()").split(",") if d}
        signature = ",".join(names[:count]) + "->" + ",".join(names[count:])
        kinds = self.dtype if self.function.single else [self.dtype] * len(self.function.outputs)
        extra = {name: n for name, n in sizes.items() if name not in inside}
        return da.apply_gufunc(self.gufunc, signature, *args, output_dtypes=kinds, output_sizes=extra)

    @property
    def __name__(self) -> str:
        return self.function.name

    def __repr__(self) -> str:
        return (
            f"<kernel {self.function.name}{self.signature} {self.dtype.name}, {self.operations} operations>"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return compile, (self.function, self.dtype.name, self._general.checked)


class SlowKernel(KernelBase):
    """A kernel whose single calls go through the gufunc: where the fast door does not work."""

    __slots__ = ("__dict__", "__weakref__", "_general")

    def __init__(self, general: _General) -> None:
        self._general = general
        self.__dict__["__doc__"] = _doc(general.function)

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Evaluates the kernel; see `Kernel`."""
        return self._general(*args, **options)


def _doc(f: Function) -> str:
    """What help() says of a kernel."""
    return f"{f.name}({', '.join(p.name for p in f.inputs)}): {f.signature}\n\n{f.doc}".rstrip()


def _let_go(*_: Any) -> None:
    """Nothing is left to do: the references go with the call."""


_NATIVE: Any = None
_native_made = False
_native_lock = threading.Lock()


def _native_type() -> Any:
    global _NATIVE, _native_made
    with _native_lock:
        if not _native_made:
            _NATIVE, _native_made = native.make_type(KernelBase), True
    return _NATIVE


def _entry_ir(general: _General) -> str:
    return native.entry_ir(general.function, general.element, general.checked)


def compile(
    f: Function | Callable[..., Any],
    /,
    dtype: Any = np.float64,
    checked: bool = False,
    **shapes: tuple[int, ...] | int,
) -> Any:
    """Makes a kernel of a traced function.

    Args:
        f: A `Function`, or a Python function that is traced with `shapes` (see `trace`).
        dtype: The type to compute in: float64 or float32.
        checked: Whether nan or inf in an input raises NonFiniteError instead of passing through.
        **shapes: Shape of each argument, if `f` is not traced yet.

    Returns:
        A kernel: callable as `kernel(*arrays, out=None, threads=None)`. Arguments may have any leading batch axes,
        which broadcast; lists and other real types are converted. With `threads=n` a large batch is cut into n parts.
        It is thread-safe, releases the GIL in batches, and can be pickled.

    Raises:
        TraceError: If `f` cannot be traced.
        DtypeError: If `dtype` is neither float64 nor float32.
    """
    if not isinstance(f, Function):
        f = trace(f, **dict[str, Any](shapes))
    elif shapes:
        raise TypeError("Shapes are given for a function that is traced already.")
    kind = np.dtype(dtype)
    if kind.name not in _ELEMENT:
        raise DtypeError("dtype", str(kind), "float64 or float32")
    general = _General(f, np.dtype(kind.type), checked)
    door = _native_type()
    if "graph" in os.environ.get("ULNA_DEBUG", ""):
        print(f"[ulna] {f.name}{f.signature}: {f.operations} operations {f.operation_counts}")
    if door is None or not f.outputs:
        return SlowKernel(general)
    ir = _entry_ir(general)
    if "ir" in os.environ.get("ULNA_DEBUG", "").split(","):
        print(ir)
    code = jit.load(ir, ("entry",))
    instance = native.make_instance(door, code.address("entry"), general, general.element)
    instance.__dict__["__doc__"] = _doc(f)
    # Machine code reads `general` through a bare pointer: both stay until the instance goes, whatever happens to its
    # attributes.
    weakref.finalize(instance, _let_go, general, code).atexit = False
    if "asm" in os.environ.get("ULNA_DEBUG", ""):
        print(jit.assembly(ir))
    general.single = weakref.ref(instance)
    return instance
