"""Functions that hand calls with the same first arguments to a bound kernel, without running Python.

A function whose bound kernels belong to objects (a model, its data, the index of a frame) is called through a table:
its rows hold the addresses of first arguments, and the kernel that is bound for them. Machine code looks the row up and
calls the kernel with the other arguments. Where there is no row, or the kernel answers NotImplemented, the function
itself is called; it fills the rows.

Addresses stay valid: rows own their kernels and their other first arguments, and those of an object that is
referred to weakly are emptied before its memory is given back.
"""

from __future__ import annotations

import functools
import sys
import weakref
from array import array
from collections.abc import Callable
from typing import Any, TypeVar, final

from ulna.compiler.runtime import entry_point, gufunc, jit
from ulna.compiler.runtime.bound_call import bound_type
from ulna.compiler.runtime.fast_call import load_at
from ulna.compiler.runtime.object_layout import WORD, c_function
from ulna.system import forks

_Function = TypeVar("_Function", bound=Callable[..., Any])
MOST_FIRST_ARGUMENTS = 4
_ROW = MOST_FIRST_ARGUMENTS + 2  # number of all arguments, addresses of the first, that of the kernel
_BITS = 8
_LARGEST_SHARED = 256  # CPython has one object for each number up to this one
_LEFT_OUT = 15  # kernels that are not noted after one that took the row of another
_MULTIPLIER = (
    0x9E3779B97F4A7C15  # 2^64 / golden ratio: spreads addresses over the rows [Knuth, TAOCP 3, section 6.4]
)
_WORD_MASK = 2**64 - 1
_FIELDS = ("first_arguments", "rows", "not_implemented", "call", "own", "release")


def _word(name: str, kind: str = "ptr") -> str:
    return load_at(name, "plan", _FIELDS.index(name) * WORD, kind)


_IR = f"""
define ptr @repeated(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
{load_at("plan", "self", entry_point.PLAN)}
{_word("first_arguments", "i64")}
{_word("rows")}
  %count = and i64 %flagged, 9223372036854775807
  %plain = icmp eq ptr %keywords, null
  %few = icmp ult i64 %count, %first_arguments
  %n = select i1 %few, i64 %count, i64 %first_arguments
  %some = icmp ne i64 %count, 0  ; a row that is empty has 0 arguments
  %begin = and i1 %plain, %some
  br i1 %begin, label %hash, label %slow
hash:
  %k = phi i64 [ 0, %entry ], [ %k.next, %mix ]
  %sum = phi i64 [ %count, %entry ], [ %sum.next, %mix ]
  %more = icmp ult i64 %k, %n
  br i1 %more, label %mix, label %find
mix:
  %object.p = getelementptr ptr, ptr %args, i64 %k
  %object = load i64, ptr %object.p
  %place = lshr i64 %object, 4
  %mixed = xor i64 %sum, %place
  %sum.next = mul i64 %mixed, {_MULTIPLIER}
  %k.next = add nuw i64 %k, 1
  br label %hash
find:
  %number = lshr i64 %sum, {64 - _BITS}
  %offset = mul nuw i64 %number, {_ROW * WORD}
  %row = getelementptr i8, ptr %rows, i64 %offset
  %counted = load i64, ptr %row
  %count.ok = icmp eq i64 %counted, %count
  br i1 %count.ok, label %compare, label %slow
compare:
  %j = phi i64 [ 0, %find ], [ %j.next, %one ]
  %left = icmp ult i64 %j, %n
  br i1 %left, label %one, label %known
one:
  %given.p = getelementptr ptr, ptr %args, i64 %j
  %given = load i64, ptr %given.p
  %j.next = add nuw i64 %j, 1
  %kept.p = getelementptr i64, ptr %row, i64 %j.next
  %kept = load i64, ptr %kept.p
  %same = icmp eq i64 %given, %kept
  br i1 %same, label %compare, label %slow
known:
  %kernel.p = getelementptr i8, ptr %row, i64 {(_ROW - 1) * WORD}
  %kernel = load ptr, ptr %kernel.p
{_word("own")}
{_word("release")}
{_word("not_implemented")}
{load_at("code", "kernel", entry_point.VECTORCALL)}
  %rest = getelementptr ptr, ptr %args, i64 %n
  %rest.count = sub nuw i64 %count, %n
  call void %own(ptr %kernel)
  %result = call ptr %code(ptr %kernel, ptr %rest, i64 %rest.count, ptr null)
  call void %release(ptr %kernel)
  %refused = icmp eq ptr %result, %not_implemented
  br i1 %refused, label %again, label %done
done:
  ret ptr %result
again:
  call void %release(ptr %result)
  br label %slow
slow:
{_word("call")}
{load_at("callable", "self", entry_point.SLOW)}
  %found = call ptr %call(ptr %callable, ptr %args, i64 %flagged, ptr %keywords)
  ret ptr %found
}}
"""


class RepeatedCalls:
    """A function that is called through a table of bound kernels; see `repeated_calls`."""

    __slots__ = ()

    __wrapped__: Callable[..., Any]
    __call__: Callable[..., Any]

    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        return self  # so that `help` takes it for a function

    def __repr__(self) -> str:
        return f"<function {self.__wrapped__.__qualname__}>"

    def __reduce__(self) -> str:
        return self.__wrapped__.__qualname__


class _Table:
    """The rows of one function, and what they keep alive."""

    def __init__(self, first_arguments: int) -> None:
        self._left_out = 0
        self._words = array("Q", bytes(WORD * _ROW << _BITS))
        self._kept: list[Any] = [None] * (1 << _BITS)
        self.plan = array("Q", [first_arguments, self._words.buffer_info()[0], id(NotImplemented)])
        self.plan.extend(c_function(f) for f in ("PyObject_Vectorcall", "Py_IncRef", "Py_DecRef"))

    def put(self, arguments: tuple[Any, ...], others: int, kernel: Any, weakly: int) -> None:
        """Has the kernel called for these first arguments; seldom, where rows would often change hands."""
        if self._left_out:
            self._left_out -= 1
            return
        if any(type(x) is int and not x <= _LARGEST_SHARED for x in arguments[weakly:]):
            return
        total = len(arguments) + others  # calls with other numbers of arguments have other rows
        for x in arguments:
            total = (total ^ id(x) >> 4) * _MULTIPLIER & _WORD_MASK
        row = total >> 64 - _BITS
        first = row * _ROW
        addresses = [id(x) for x in arguments] + [0] * (MOST_FIRST_ARGUMENTS - len(arguments))
        values = array("Q", [len(arguments) + others, *addresses, id(kernel)])
        with _lock:
            known = self._words[first : first + _ROW - 1]
            self._left_out = _LEFT_OUT if known[0] and known != values[:-1] else 0
            self._words[first : first + _ROW] = _EMPTY
            self._kept[row] = (arguments[weakly:], kernel)
            for x in arguments[:weakly]:
                _watch(x).add((self, row))
            self._words[first : first + _ROW] = values

    def clear(self, row: int, address: int) -> None:
        """Empties a row that has the address of an object."""
        first = row * _ROW
        if address in self._words[first + 1 : first + _ROW - 1]:
            self._words[first : first + _ROW] = _EMPTY
            self._kept[row] = None


_EMPTY = array("Q", bytes(WORD * _ROW))
_lock = forks.lock(forks.KERNEL)
_rows_of: dict[int, set[tuple[_Table, int]]] = {}  # for the address of an object that is referred to weakly


def _watch(owner: Any) -> set[tuple[_Table, int]]:
    address = id(owner)
    rows = _rows_of.get(address)
    if rows is None:
        rows = _rows_of[address] = set()
        weakref.finalize(owner, _gone, address).atexit = False
    return rows


def _gone(address: int) -> None:
    with _lock:
        rows = _rows_of.pop(address, ())
        for table, row in rows:
            table.clear(row, address)


def forget(owner: Any) -> None:
    """Has no call with this first argument answered by the kernels that are known so far."""
    rows = _rows_of.get(id(owner))
    if rows:
        with _lock:
            for table, row in rows:
                table.clear(row, id(owner))
            rows.clear()


@final
class Memory:
    """Where a function notes kernels that answer calls with the same first arguments; see `repeated_calls`.

    Args:
        table: The table, or None where machine code cannot be called in this way.
        weakly: How many of the first arguments are referred to weakly.
    """

    __slots__ = ("_table", "_weakly")

    def __init__(self, table: _Table | None, weakly: int) -> None:
        self._table, self._weakly = table, weakly

    def __call__(self, kernel: Any, others: int, *arguments: Any) -> None:
        """Has a bound kernel called, with the other arguments, where these are the first ones.

        Args:
            kernel: What `into` returned.
            others: How many other arguments there are.
            *arguments: The first arguments.
        """
        if self._table is not None and type(kernel) is bound_type():
            self._table.put(arguments, others, kernel, self._weakly)


@functools.cache
def _own_type() -> type | None:
    if not getattr(sys, "_is_gil_enabled", lambda: True)():  # rows are read without a lock
        return None
    return gufunc.make_type(RepeatedCalls, "RepeatedCalls")


@functools.cache
def _code() -> tuple[Any, int]:
    code = jit.load_text(_IR, ("repeated",), has_loops=False)
    return code, code.address("repeated")


def memory(first_arguments: int, weakly: int) -> Memory:
    """What a function of `repeated_calls` notes its kernels in.

    Args:
        first_arguments: How many arguments, where there are as many, tell which kernel is called: at most 4.
        weakly: How many of them are objects whose life is not prolonged; the others are numbers and such.

    Returns:
        It.
    """
    return Memory(None if _own_type() is None else _Table(first_arguments), weakly)


_KEEP: list[Any] = []


def repeated_calls(noted: Memory) -> Callable[[_Function], _Function]:
    """Has a function called through the table in which it notes kernels.

    Args:
        noted: Its table. The function calls `noted(kernel, others, *first_arguments)` for a kernel that may answer the
            same call the next time; with NotImplemented as answer the function is called again.

    Returns:
        A decorator: what it makes has the function's name, signature and documentation. It is the function where there
        is no table.
    """

    def decorate(function: Any) -> Any:
        kind, table = _own_type(), noted._table
        if kind is None or table is None:
            return function
        words = {
            entry_point.VECTORCALL: _code()[1],
            entry_point.SLOW: id(function),
            entry_point.PLAN: table.plan.buffer_info()[0],
        }
        made = gufunc.make_instance(kind, words)
        _KEEP.append((made, function, table))
        return functools.update_wrapper(made, function)

    return decorate
