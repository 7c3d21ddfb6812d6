"""A compiled function, as users hold it: called like a NumPy ufunc, 100 ns a call, batches in SIMD lanes."""

from __future__ import annotations

import os
import weakref
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ulna.compiler.language.function import Function, trace
from ulna.compiler.language.graph import Graph
from ulna.compiler.runtime import bound_call, gufunc, jit, native_types
from ulna.compiler.runtime.array_call import ELEMENT, ArrayCall, Unit
from ulna.compiler.runtime.differentiate import differentiated
from ulna.errors import DtypeError, InputError, needed
from ulna.idioms import unknown_attribute
from ulna.lazy import is_deferred
from ulna.system import forks
from ulna.typing import Array

if TYPE_CHECKING:
    from ulna.compiler.runtime.report import KernelReport


class KernelBase:
    """What every kernel offers beside being called; see `Kernel`."""

    __slots__ = ()

    _array_call: ArrayCall

    @property
    def function(self) -> Function:
        """The traced function behind the kernel."""
        return self._array_call.function

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type computed in: float64 or float32."""
        return self._array_call.dtype

    @property
    def gufunc(self) -> np.ufunc:
        """The NumPy generalised ufunc, for `dask.array.apply_gufunc` and the like."""
        return self._array_call.ufunc

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
        """Whether single calls use the fast call of 100 ns (else they go through the gufunc)."""
        return isinstance(self, _NATIVE) if _NATIVE is not None else False

    def ir(self, batch: bool = False) -> str:
        """LLVM IR of the single call, or of the loop over a batch."""
        return self._array_call.batch_ir() if batch else self._array_call.single_ir()

    def asm(self, batch: bool = False) -> str:
        """Assembly for this machine of the single call, or of the loop over a batch."""
        return jit.assembly(self.function, self.ir(batch))

    def report(self, batch: bool = False) -> KernelReport:
        """What the kernel costs: operations, bytes of code and stack, time to compile, what limits it; prints well.

        It is compiled once more for that, which takes as long as at first.

        Args:
            batch: Whether the loop over a batch is meant; else the single call.

        Returns:
            The report, whose attributes are these values.

        Example:
            >>> report = ulna.load("panda").kernel("fk").report()
            >>> report.operations, report.bytes_moved, report.limit
            (147, 184, 'arithmetic')
        """
        from ulna.compiler.runtime.report import report  # imported here: slow to import, rarely needed

        return report(self, batch)

    def jacobian(self, wrt: str | int = 0) -> Any:
        """The kernel of the derivative of the outputs by input `wrt`, shape output + input: forward or reverse mode.

        Example:
            >>> robot = ulna.load("panda")
            >>> height = ulna.compile(lambda q: robot.fk(q)[2, 3], robot)
            >>> height.jacobian()(robot.configurations["ready"]).round(3)
            array([ 0.   , -0.307, -0.   ,  0.472,  0.   ,  0.088,  0.   ])
        """
        return self._derived("jacobian", wrt)

    def value_and_gradient(self, wrt: str | int = 0) -> Any:
        """The kernel of a number and its gradient by input `wrt`, a pair, by one reverse sweep."""
        return self._derived("value_and_gradient", wrt)

    def hessian(self, wrt: str | int = 0) -> Any:
        """The kernel of the second derivatives of the outputs by input `wrt`, shape output + input + input."""
        return self._derived("hessian", wrt)

    def hvp(self, wrt: str | int = 0) -> Any:
        """The kernel of the product of a number's Hessian by input `wrt` with a vector, its last argument.

        It costs a few evaluations of the function, however many inputs there are; the Hessian is not formed.
        """
        return self._derived("hvp", wrt)

    def jvp(self) -> Any:
        """The kernel of the forward derivative: inputs and their tangents in, tangents of the outputs out."""
        return self._derived("jvp")

    def vjp(self) -> Any:
        """The kernel of the reverse derivative: inputs and cotangents of the outputs in, cotangents of inputs out."""
        return self._derived("vjp")

    def packed(self, zeros: bool = False) -> Any:
        """The kernel whose matrices are vectors of the entries that must be known, column by column.

        Of a symmetric matrix that is the lower triangle, without entries that are zero at every input. With `zeros` it
        is LAPACK's packed storage, `uplo="L"`. `kernel.pattern` has the places of the entries. Outputs that are no
        matrices stay as they are.

        Args:
            zeros: Whether entries that are always zero are stored, too.

        Returns:
            The kernel, of the same type and arguments.

        Raises:
            InputError: If no output is a matrix.
            TooLargeError: If the function of a large robot cannot be traced.

        Example:
            >>> mass = ulna.load("panda").kernel("mass_matrix")
            >>> mass.packed()(np.zeros(7)).shape
            (28,)
        """
        call = self._array_call
        return compile(self.function.packed(zeros), self.dtype, *call.input_settings)

    def pattern(self, zeros: bool = False) -> Any:
        """Which entries of its matrices `packed` stores.

        Args:
            zeros: Whether entries that are always zero are stored, too.

        Returns:
            The pattern, with `rows`, `columns`, `starts`, `shape`, `is_symmetric` and `unpack(values)`, which returns
            whole matrices; of several outputs a tuple, with None for those that are no matrices.

        Raises:
            InputError: If no output is a matrix.
            TooLargeError: If the function of a large robot cannot be traced.

        Example:
            >>> mass = ulna.load("panda").kernel("mass_matrix")
            >>> mass.pattern()
            <pattern of a symmetric 7 x 7 matrix, 28 entries stored>
        """
        return self.function.pattern(zeros)

    def _derived(self, what: str, *wrt: str | int) -> Any:
        function = differentiated(self.function, what, *wrt)
        call = self._array_call  # the inputs of the kernel come first among those of its derivative
        return compile(function, self.dtype, *call.input_settings)

    def into(
        self,
        *targets: Array,
        returns: Sequence[int] = (),
        watch: Sequence[tuple[Array, Array]] = (),
        otherwise: Callable[..., Any] | None = None,
        trailing_inputs: Sequence[Array] = (),
        last_inputs: Sequence[Array] = (),
        given: Sequence[Array] = (),
        holder: type | None = None,
        input_holders: Sequence[type | None] = (),
        condition: int | None = None,
        answer: Any = None,
    ) -> Any:
        """A callable of the inputs that writes the outputs into arrays chosen once: where nanoseconds count.

        Args:
            *targets: An array for each output, of its shape (...) and of the kernel's type, C-contiguous and
                writeable. They are kept alive, and may be inputs of the calls. Every call examines them, at 1 to
                2 ns each, and raises if one was resized, made read-only or given another shape or type since.
            returns: Indices of the outputs of which every call returns a copy: one as it is, several in a tuple, in
                this order. Without any, calls return None.
            watch: Pairs of arrays (...) of whole 8-byte words. A call works while both of each pair hold the same
                bits.
            otherwise: Called with the arguments, and its result returned, where these are not exactly arrays of the
                right type and shape, without gaps if they have more than 16 entries, or what is watched differs or has
                another shape or type than at first. Without it,
                arguments are converted as the kernel does, and one sample is computed. It must not hold the bound
                kernel: such a reference cycle is never freed. The arrays are examined before it is called, which takes
                2 us, unless it has an attribute `examines_arrays`, since it calls a kernel bound to the same ones.
            trailing_inputs: Arrays that are the last inputs (...), read at every call as they then are; calls pass the
                others.
            last_inputs: A former name of `trailing_inputs`, (...) each.
            given: A former name of `trailing_inputs`, (...) each.
            holder: A class with one slot and nothing else. A call returns a new instance, made without `__init__`,
                whose slot is the one array that `returns` names. Or float or bool, for a single number. NaN has
                no truth value: such a call goes to `otherwise`, and raises NonFiniteError without it.
            input_holders: For each input that calls pass, from the first on, such a class, or None. Instances of
                exactly that class are passed then, in place of the arrays that they hold.
            condition: The index of an output, one float64. Where it is not above zero, `otherwise` is called after the
                kernel, and its result returned: for what has no solution.
            answer: What calls return, in place of None, where `returns` names no output: an object that holds a target,
                say.

        Returns:
            A `Bound` kernel. It is called with positional arguments, and cannot be pickled: what it is bound to would
            be other arrays elsewhere. It holds the GIL while it works; on a free-threaded Python calls of the same one
            wait for each other, so what a call returns belongs to its arguments.

        Raises:
            InputError: If there are not as many arrays as outputs, or they share memory, cannot be written to or
                compared, or `watch` is given without `otherwise`, or the trailing inputs under two names.
            ShapeError: If an array has another shape than its output.
            DtypeError: If an array has another type than the kernel. All three come at once, and from later
                calls.
        """
        inputs = _trailing_inputs(trailing_inputs=trailing_inputs, last_inputs=last_inputs, given=given)
        bound = gufunc.Binding(targets, watch, returns, inputs, holder, input_holders, condition, answer)
        work = self._array_call.single_code().address("work") if self.is_fast else None
        return bound_call.bind(self, self._array_call, work, bound, otherwise)

    def draw(self, path: str | None = None) -> str:
        """The graph as an SVG picture; written to `path` when one is given."""
        return self.function.draw(path)

    def dask(self, *args: Any) -> Any:
        """Evaluates the kernel lazily and returns Dask arrays, even if no argument is one.

        Example:
            >>> fk = ulna.load("panda").kernel("fk")
            >>> poses = fk.dask(np.zeros((1000, 7)))  # nothing is computed yet
            >>> poses.shape, poses[:5].compute().shape
            ((1000, 4, 4), (5, 4, 4))
        """
        with needed("dask", "cluster", "Applying a kernel to Dask arrays"):
            import dask.array as da  # pyright: ignore[reportMissingImports]
        lazy = args if any(is_deferred(a) for a in args) else (*map(da.asarray, args[:1]), *args[1:])
        return self._array_call(*lazy)

    @property
    def __name__(self) -> str:
        return self.function.name

    def __getattr__(self, name: str) -> Any:
        raise unknown_attribute("kernel", name, dir(type(self)))

    def __repr__(self) -> str:
        f = self.function
        written = getattr(f, "untraced_operations", None)  # the graph of a large robot takes seconds
        size = f"{self.operations} operations" if written is None else f"{written} operations written out"
        return f"<kernel {f.name}{f.signature} {self.dtype.name}, {size}>"

    def __reduce__(self) -> tuple[Any, ...]:
        call = self._array_call
        settings = call.checked, call.unit, call.labels, call.not_negative
        return compile, (self.function, self.dtype.name, *settings)


class SlowKernel(KernelBase):
    """A kernel whose single calls go through the gufunc: where the fast call does not work."""

    __slots__ = ("__dict__", "__weakref__", "_array_call")

    def __init__(self, array_call: ArrayCall) -> None:
        self._array_call = array_call
        self.__dict__.update(__doc__=_doc(array_call.function))

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Evaluates the kernel; see `Kernel`.

        Args:
            *args, **options: As for `Kernel`.

        Returns:
            The result, or a tuple of several.
        """
        return self._array_call(*args, **options)


def _trailing_inputs(**arrays: Sequence[Array]) -> Sequence[Array]:
    """The arrays that were passed under one of several names; refuses those under two."""
    passed = [name for name, value in arrays.items() if len(value)]
    if len(passed) > 1:
        raise InputError(
            f"into() was given `{passed[0]}` and `{passed[1]}`, which are names of the same; expected all arrays in "
            "`trailing_inputs`."
        )
    return arrays[passed[0]] if passed else ()


def _doc(f: Function) -> str:
    """What help() says of a kernel."""
    return f"{f.name}({', '.join(p.name for p in f.inputs)}): {f.signature}\n\n{f.doc}".rstrip()


_NATIVE: Any = None
_native_made = False
_native_lock = forks.lock(forks.KERNEL)


def native_type() -> Any:
    """The type of kernels whose single calls are machine code; None where there can be none."""
    global _NATIVE, _native_made
    with _native_lock:
        if not _native_made:
            _NATIVE, _native_made = native_types.make_type(KernelBase, "Kernel"), True
    return _NATIVE


def element_of(dtype: Any) -> np.dtype[Any]:
    """The type to compute in that `dtype` names.

    Raises:
        DtypeError: If it is neither float64 nor float32.
    """
    try:
        kind = np.dtype(dtype)
    except TypeError:
        raise DtypeError("dtype", repr(dtype), "float64 or float32") from None
    if kind.name not in ELEMENT:
        raise DtypeError("dtype", str(kind), "float64 or float32")
    return np.dtype(kind.type)  # without metadata, in the machine's byte order


def compile(
    f: Function | Callable[..., Any],
    /,
    dtype: Any = np.float64,
    checked: bool = False,
    unit_entries: Unit = (),
    labels: Mapping[str | int, Sequence[str]] | None = None,
    not_negative: Sequence[int] = (),
    **shapes: tuple[int, ...] | int,
) -> Any:
    """Makes a kernel of a traced function; its machine code is made when it is first called, or bound by `into`.

    Args:
        f: A `Function`, or a Python function that is traced with `shapes` (see `trace`).
        dtype: The type to compute in: float64 or float32.
        checked: Whether nan or inf in an input raises NonFiniteError instead of passing through.
        unit_entries: With `checked`, what must be unit vectors, such as quaternions: (number of input, entries),
            ...
        labels: By name of an input or number of an output, what the entries of its last axis are called: arrays of
            xarray are put in that order.
        not_negative: With `checked`, the numbers of inputs of which no entry may be negative, such as gains.
        **shapes: Shape of each argument, if `f` is not traced yet.

    Returns:
        A kernel: callable as `kernel(*arrays, out=None, threads=None)`. Arguments may have any leading batch axes,
        which broadcast; lists and other real types are converted. With `threads=n` n threads share a large batch.
        It is thread-safe, releases the GIL in batches, and can be pickled. Dask arrays are evaluated lazily, in
        blocks; arrays of xarray keep their leading dimensions and coordinates.

    Raises:
        TraceError: If `f` cannot be traced.
        DtypeError: If `dtype` is neither float64 nor float32.
        TypeError: If `shapes` are given for a function that is traced already.
    """
    if not isinstance(f, Function):
        f = trace(f, **dict[str, Any](shapes))
    elif shapes:
        raise TypeError("Shapes are given for a function that is traced already.")
    array_call = ArrayCall(f, element_of(dtype), checked, unit_entries, labels, not_negative=not_negative)
    own_type = native_type()
    if "graph" in os.environ.get("ULNA_DEBUG", ""):
        print(f"[ulna] {f.name}{f.signature}: {f.operations} operations {f.operation_counts}")
    if own_type is None or not f.outputs:
        return SlowKernel(array_call)
    instance = gufunc.make_kernel(own_type, array_call, array_call.element)
    instance.__dict__.update(__doc__=_doc(f), _array_call=array_call)
    gufunc.keep(instance, array_call)
    array_call.single = weakref.ref(instance)
    return instance
