"""Procedures: restricted Python with loops and arrays, as machine code.

>>> import numpy as np
>>> from ulna.compiler.procedures import Array1, Array2, f64, procedure
>>> @procedure
... def nearest(points: Array2[f64], q: Array1[f64]) -> int:
...     best, least = -1, np.inf
...     for i in range(len(points)):
...         distance = 0.0
...         for k in range(len(q)):
...             distance += (points[i, k] - q[k]) ** 2
...         if distance < least:
...             best, least = i, distance
...     return best
>>> nearest(np.array([[0.0, 0.0], [1.0, 1.0]]), np.array([0.8, 0.9]))
1
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, final, overload

import numpy as np

from ulna import disk_cache
from ulna.compiler.codegen.procedure_types import DIVISION_BY_ZERO
from ulna.compiler.codegen.procedures import procedure_ir, result_words
from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.effects import written
from ulna.compiler.imperative.interpreter import interpret
from ulna.compiler.imperative.program import ProgramReader
from ulna.compiler.imperative.source import Definition
from ulna.compiler.imperative.types import INT, Number, RecordType
from ulna.compiler.runtime import procedure_cache
from ulna.compiler.runtime.jit import load_known, target
from ulna.compiler.runtime.procedure_arguments import (
    check_count,
    interpreted,
    layout,
    one_or_all,
    python_number,
    result_from,
    words_of,
)
from ulna.compiler.runtime.procedure_cache import Compiled
from ulna.errors import DivisionByZero, InputError, OutOfBounds

Number_ = bool | int | float


class Procedure(Definition):
    """A Python function of numbers and arrays, compiled the first time it is called.

    Arrays are passed as they are: they must have the annotated type and rank and be C-contiguous, and may be written
    to. The call releases the interpreter's lock, and cannot be interrupted: a long search returns now and then and
    goes on where it was.

    Args:
        function: The Python function, whose parameters are annotated.
        constants: Values of parameters that are compiled in.
        contract: Whether products and sums may be fused.

    Raises:
        InputError: `constants` names something that is no parameter.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        constants: Mapping[str, Number_] | None = None,
        contract: bool = False,
    ) -> None:
        super().__init__(function, contract, constants)
        self.__doc__, self.__module__ = function.__doc__, function.__module__
        unknown = [name for name in self.constants if name not in self.parameters]
        if unknown:
            raise InputError(
                f"`constants` names {', '.join(unknown)}; {self.__name__} has the parameters "
                f"{', '.join(self.parameters)}."
            )
        self._instances: tuple[t.Instance, ...] = ()
        self._writes: frozenset[str] = frozenset()
        self._functions: set[Callable[..., Any]] = set()
        self._outside: dict[tuple[str, str], Any] = {}
        self._entries: dict[bool, Any] = {}
        self._compiled_code: dict[bool, Compiled] = {}

    def __repr__(self) -> str:
        return f"<procedure {self.__name__}({', '.join(self.parameters)})>"

    def __call__(self, *arguments: Any) -> Any:
        """Runs the machine code.

        Args:
            *arguments: What the parameters take, without those that are constants.

        Returns:
            Its result, a tuple of several, or None: int, float, bool, float32, or an array for lanes.

        Raises:
            ProcedureError: If the source cannot be compiled.
            InputError: If an argument is not what the annotation says.
            DivisionByZero: If it divides an integer by zero.
        """
        return self.bind(*arguments)()

    def checked(self, *arguments: Any) -> Any:
        """Runs machine code that checks every access to an array; takes and returns what a call does.

        Raises:
            OutOfBounds: If it reads or writes beside an array.
        """
        return self.bind(*arguments, is_checked=True)()

    def interpret(self, *arguments: Any) -> Any:
        """Runs the interpreter, the reference: takes and returns what a call does, with every access checked."""
        instance = self.instance
        check_count(self.__name__, instance.parameters, arguments)
        values = []
        for (name, type_), value in zip(instance.parameters, arguments, strict=True):
            words_of(name, type_, value, name in self._writes)
            values.append(interpreted(type_, value))
        return one_or_all(
            [python_number(r, v) for r, v in zip(instance.results, interpret(instance, values), strict=True)]
        )

    def bind(
        self, *arguments: Any, is_checked: bool = False, are_arrays_private: bool = False
    ) -> BoundProcedure:
        """Prepares calls with the same arrays: what it returns is called without arguments.

        Args:
            *arguments: What a call takes; numbers keep their values until `set`, arrays are read and written where
                they lie.
            is_checked: Whether every access to an array is checked.
            are_arrays_private: Whether nobody but the caller has the arrays, who never changes their shape or memory:
                calls do not look whether they are as they were, which takes two microseconds an array.

        Returns:
            The bound procedure, for one thread at a time.
        """
        compiled = self._compiled(is_checked)
        check_count(self.__name__, compiled.parameters, arguments)
        words: list[int] = []
        alive: list[Any] = []
        places: dict[str, int] = {}
        for (name, type_), value in zip(compiled.parameters, arguments, strict=True):
            part, buffers = words_of(name, type_, value, name in compiled.writes)
            places |= {f"{name}{rest}": len(words) + at for rest, at in _places_in(type_, value).items()}
            words += part
            alive += buffers
        return BoundProcedure(compiled, self._entry(is_checked), words, alive, places, are_arrays_private)

    @property
    def instance(self) -> t.Instance:
        """The typed tree of the procedure for calls from Python."""
        return self.instances[-1]

    @property
    def instances(self) -> tuple[t.Instance, ...]:
        """The typed trees of the procedure, last, and of all that it calls."""
        if not self._instances:
            reader = ProgramReader(self.constants)
            self._writes = written(reader.entry(self))
            self._functions, self._outside = {key[0] for key in reader.instances}, reader.outside
            self._instances = tuple(reader.instances.values())
        return self._instances

    def ir(self, is_checked: bool = False) -> str:
        """The LLVM IR.

        Args:
            is_checked: Whether every access to an array is checked.

        Returns:
            The module's text.
        """
        return procedure_ir(self.instances, is_checked, self.contract, target().register_bytes)

    def specialized(self, **constants: Number_) -> Procedure:
        """The same procedure with further parameters as constants.

        Args:
            **constants: Their values; these parameters are no arguments of a call any more.

        Returns:
            A procedure that is compiled apart.
        """
        return Procedure(self.function, {**self.constants, **constants}, self.contract)

    def _compiled(self, is_checked: bool) -> Compiled:
        """What calls need to know, from the disk where it is there."""
        if is_checked in self._compiled_code:
            return self._compiled_code[is_checked]
        width = target().register_bytes
        key = procedure_cache.key_of(
            self.function, sorted(self.constants.items()), self.contract, is_checked, width
        )
        compiled = procedure_cache.read(key) if key is not None else None
        if compiled is None:
            instance, text = self.instance, self.ir(is_checked)
            compiled = Compiled(
                instance.parameters, instance.results, self._writes, tuple(i.file for i in self.instances),
                procedure_cache.texts_of(self._outside), disk_cache.key("procedure", text),
            )  # fmt: skip
            if key is not None and all(map(procedure_cache.is_from_package, self._functions)):
                procedure_cache.write(key, compiled)
        self._compiled_code[is_checked] = compiled
        return compiled

    def _entry(self, is_checked: bool) -> Any:
        if is_checked not in self._entries:
            digest = self._compiled(is_checked).digest
            code = load_known(digest, partial(self.ir, is_checked), ("entry",), self.__name__)
            function = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)(
                code.address("entry")
            )
            function.code = code  # type: ignore[attr-defined]  # it is freed with the function
            self._entries[is_checked] = function
        return self._entries[is_checked]


@final
class BoundProcedure:
    """A procedure with its arguments: calling it runs the machine code on what the arrays hold now.

    Args:
        compiled: The procedure.
        entry: The address of its machine code.
        words: The arguments as machine words.
        alive: What must stay alive: the arrays among the arguments.
        places: Where the words of each parameter begin, and of each field of a record.
        are_arrays_private: Whether nothing can have happened to the arrays between calls.
    """

    def __init__(
        self,
        compiled: Compiled,
        entry: Any,
        words: Sequence[int],
        alive: Sequence[Any],
        places: Mapping[str, int],
        are_arrays_private: bool = False,
    ) -> None:
        self._compiled, self._entry, self._held, self._places = compiled, entry, alive, places
        self._numbers = {name: (places[name], t) for name, t in compiled.parameters if isinstance(t, Number)}
        arrays = [] if are_arrays_private else [a for a in alive if isinstance(a, np.ndarray)]
        self._arrays = [(a, layout(a)) for a in arrays]
        self._first = len(words)
        self._is_integer = len(compiled.results) == 1 and compiled.results[0] == INT
        self._integers = {place for place, kind in self._numbers.values() if kind == INT}
        size = len(words) + sum(result_words(r) for r in compiled.results)
        self._words = np.zeros(max(size, 1), np.int64)
        self._words[: len(words)] = words
        self._view = self._words.data  # read in half the time
        self._bound = self._words[: len(words)], self._words[: len(words)].copy()
        self._fault = np.zeros(2, np.int64)
        arrays = self._words, self._fault
        self._pointers = tuple(ctypes.c_void_p(a.ctypes.data) for a in arrays)  # faster than plain numbers

    def __call__(self) -> Any:
        """Runs the machine code; returns and raises what a call of the procedure does."""
        for array, before in self._arrays:
            if layout(array) != before:
                raise InputError(
                    "An array was resized, made read-only or replaced in place after bind(). Bind the procedure anew."
                )
        return self.unguarded()

    def unguarded(self) -> Any:
        """Runs the machine code without a look at the arrays: for arrays that nothing else can resize."""
        status = self._entry(*self._pointers)
        if status:
            self._raise(status)
        if self._is_integer:
            return self._view[self._first]
        results, position = [], self._first
        for result in self._compiled.results:
            results.append(result_from(result, self._words[position:]))
            position += result_words(result)
        return one_or_all(results)

    def addresses(self) -> tuple[int, int, int]:
        """Where the machine code lies, the words that it reads, and where it writes faults."""
        words, fault = (int(pointer.value or 0) for pointer in self._pointers)
        return ctypes.cast(self._entry, ctypes.c_void_p).value or 0, words, fault

    def address_of_word(self, name: str) -> int:
        """Where the word with the address of an array lies.

        Args:
            name: The parameter, or `parameter.field` of a record.
        """
        return self.addresses()[1] + 8 * self._places[name]

    def address_of_result(self) -> int:
        """Where the first word of the result lies."""
        return self.addresses()[1] + 8 * self._first

    def restore(self) -> None:
        """Has calls read the arrays and numbers that were bound, after others were written into the words."""
        words, bound = self._bound
        words[:] = bound

    def set(self, name: str, value: Number_) -> None:
        """Gives a number that was bound another value.

        Args:
            name: The name of the parameter.
            value: The number [any].

        Raises:
            InputError: If the procedure has no such parameter, or it is no number of the type.
        """
        if name not in self._numbers:
            numbers = ", ".join(self._numbers) or "there are none"
            raise InputError(f"`name` is {name!r}; expected a parameter that is a number: {numbers}.")
        place, kind = self._numbers[name]
        is_plain = place in self._integers and type(value) is int and -(2**62) < value < 2**62
        self._words[place] = value if is_plain else words_of(name, kind, value, False)[0][0]

    def _raise(self, status: int) -> None:
        file = self._compiled.files[status >> 32]
        line = status & 0xFFFFFF
        if status >> 24 & 0xFF == DIVISION_BY_ZERO:
            raise DivisionByZero(file, line)
        raise OutOfBounds(file, line, *self._fault.tolist())


def _places_in(type_: Any, value: Any) -> dict[str, int]:
    """Where the words of an argument begin, "" for all of it, and of its fields."""
    places, size = {"": 0}, 0
    for field, kind in type_.fields if isinstance(type_, RecordType) else ():
        inner = getattr(value, field)
        places |= {f".{field}{rest}": size + at for rest, at in _places_in(kind, inner).items()}
        size += len(words_of(field, kind, inner, False)[0])
    return places


@overload
def procedure(function: Callable[..., Any]) -> Procedure: ...
@overload
def procedure(
    *, constants: Mapping[str, Number_] | None = None, contract: bool = False
) -> Callable[[Callable[..., Any]], Procedure]: ...
def procedure(
    function: Callable[..., Any] | None = None,
    *,
    constants: Mapping[str, Number_] | None = None,
    contract: bool = False,
) -> Any:
    """Makes a Python function a procedure: machine code with loops, branches and arrays.

    Args:
        function: The function; its parameters are annotated with bool, int, float, f32, f64, Array1[f32] to
            Array3[...], Kernel, or a NamedTuple of these. Parameters of procedures that only procedures call need no
            annotation.
        constants: Values of parameters that are known when the code is compiled, such as the number of lanes.
        contract: Whether a product and a sum may become one instruction that rounds once, in this procedure wherever it
            is called, and in all that it calls; without it results equal the interpreter's bit for bit, but for
            elementary functions.

    Returns:
        The procedure, or with keywords alone a decorator that makes it.

    Raises:
        InputError: If a constant is not a parameter.
    """
    if function is None:
        return lambda f: Procedure(f, constants, contract)
    return Procedure(function, constants, contract)
