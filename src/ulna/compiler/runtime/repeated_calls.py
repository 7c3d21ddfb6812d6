"""Functions that pass calls with the same first arguments to a bound kernel, without running Python: an inline cache.

A function whose bound kernels belong to objects (a model, its data, the index of a frame) is called through a hash
table. A row is keyed by the addresses of the first arguments, and holds the kernel that is bound for them. Machine code
looks the row up and calls the kernel with the remaining arguments. The arguments of the kernel may also stand between
the keys (a placement before the reference frame). Keys that are lists must have the same entries, too, of which the
row has the addresses. Where there is no row, or the kernel answers NotImplemented, the function itself is called; it
adds rows.

Addresses stay valid: rows hold references to their kernels and keys, but for keys that are referred to weakly; the rows
of such an object are cleared before its memory is freed. Without a global lock each row has one of its own, until the
call has a reference to the kernel, and calls with lists, which may change meanwhile, have none.
"""

from __future__ import annotations

import ctypes
import functools
import weakref
from array import array
from collections.abc import Callable
from typing import Any, TypeVar, final

from ulna.compiler.runtime import entry_point, jit, native_types
from ulna.compiler.runtime.bound_call import bound_type
from ulna.compiler.runtime.fast_call import load_at
from ulna.compiler.runtime.object_layout import LIST_ITEMS, LIST_SIZE, WORD, c_function, has_gil
from ulna.system import forks

_Function = TypeVar("_Function", bound=Callable[..., Any])
MOST_FIRST_ARGUMENTS = 4
_KEYS = MOST_FIRST_ARGUMENTS + 1
_ROW = (
    _KEYS + 3
)  # one more than all arguments, addresses of the first, of the kernel and of entries of lists, a mutex
_BITS = 8
_LARGEST_SHARED = 256  # CPython has one object for each number up to this one
_SKIPPED = (
    15  # kernels that are not added after one that replaced another: rows in use by both would never hit
)
_MULTIPLIER = (
    0x9E3779B97F4A7C15  # 2^64 / golden ratio: spreads addresses over the rows [Knuth, TAOCP 3, section 6.4]
)
_WORD_MASK = 2**64 - 1
_FIELDS = (
    "first_arguments", "rows", "not_implemented", "call", "incref", "decref", "kernel_argument", "kernel_arguments",
    "lock", "unlock",  # 0 with a global lock
)  # fmt: skip


def _word(name: str, kind: str = "ptr") -> str:
    return load_at(name, "plan", _FIELDS.index(name) * WORD, kind)


_MUTEX = f"  %mutex = getelementptr i8, ptr %row, i64 {(_ROW - 1) * WORD}"
_TAKE_ROW = (
    ""
    if has_gil()
    else f"""{_MUTEX}
{_word("lock")}
{_word("unlock")}
  call void %lock(ptr %mutex)
"""
)
_LEAVE_ROW = "" if has_gil() else "  call void %unlock(ptr %mutex)\n"
_IR = f"""
define ptr @repeated(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
{load_at("plan", "self", entry_point.PLAN)}
{_word("first_arguments", "i64")}
{_word("rows")}
{_word("kernel_argument", "i64")}
{_word("kernel_arguments", "i64")}
  %count = and i64 %flagged, 9223372036854775807
  %plain = icmp eq ptr %keywords, null
  %some = icmp uge i64 %count, %kernel_arguments
  %keys = sub i64 %count, %kernel_arguments
  %few = icmp ult i64 %keys, %first_arguments
  %n = select i1 %few, i64 %keys, i64 %first_arguments
  %begin = and i1 %plain, %some
  br i1 %begin, label %hash, label %slow
hash:
  %k = phi i64 [ 0, %entry ], [ %k.next, %mix ]
  %sum = phi i64 [ %count, %entry ], [ %sum.next, %mix ]
  %more = icmp ult i64 %k, %n
  br i1 %more, label %mix, label %find
mix:
  %k.after = icmp uge i64 %k, %kernel_argument
  %k.gap = select i1 %k.after, i64 %kernel_arguments, i64 0
  %k.at = add nuw i64 %k, %k.gap
  %object.p = getelementptr ptr, ptr %args, i64 %k.at
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
{_TAKE_ROW}  %counted = load i64, ptr %row
  %count.wanted = add nuw i64 %count, 1  ; a row that is empty has 0
  %count.ok = icmp eq i64 %counted, %count.wanted
  br i1 %count.ok, label %compare, label %other
compare:
  %j = phi i64 [ 0, %find ], [ %j.next, %one ]
  %left = icmp ult i64 %j, %n
  br i1 %left, label %one, label %lists
one:
  %j.after = icmp uge i64 %j, %kernel_argument
  %j.gap = select i1 %j.after, i64 %kernel_arguments, i64 0
  %j.at = add nuw i64 %j, %j.gap
  %given.p = getelementptr ptr, ptr %args, i64 %j.at
  %given = load i64, ptr %given.p
  %j.next = add nuw i64 %j, 1
  %kept.p = getelementptr i64, ptr %row, i64 %j.next
  %kept = load i64, ptr %kept.p
  %same = icmp eq i64 %given, %kept
  br i1 %same, label %compare, label %other
other:
{_LEAVE_ROW}  br label %slow
lists:
  %lists.p = getelementptr i8, ptr %row, i64 {(_KEYS + 1) * WORD}
  %lists.0 = load ptr, ptr %lists.p
  %no.lists = icmp eq ptr %lists.0, null
  br i1 %no.lists, label %known, label %list.from
list.from:  ; of each list its position among the arguments plus one, its length, its entries; 0 at the end
  br label %list
list:
  %table = phi ptr [ %lists.0, %list.from ], [ %table.next, %list.same ]
  %position = load i64, ptr %table
  %is.end = icmp eq i64 %position, 0
  br i1 %is.end, label %known, label %list.size
list.size:
  %argument.p0 = getelementptr ptr, ptr %args, i64 %position
  %argument.p = getelementptr ptr, ptr %argument.p0, i64 -1
  %argument = load ptr, ptr %argument.p
{load_at("size", "argument", LIST_SIZE, "i64")}
{load_at("size.wanted", "table", WORD, "i64")}
  %entries = getelementptr i64, ptr %table, i64 2
  %size.ok = icmp eq i64 %size, %size.wanted
  br i1 %size.ok, label %items.of, label %other
items.of:
{load_at("items", "argument", LIST_ITEMS)}
  br label %item
item:
  %e = phi i64 [ 0, %items.of ], [ %e.next, %item.of ]
  %e.more = icmp ult i64 %e, %size
  br i1 %e.more, label %item.of, label %list.same
item.of:
  %item.p = getelementptr i64, ptr %items, i64 %e
  %item.given = load i64, ptr %item.p
  %entry.p = getelementptr i64, ptr %entries, i64 %e
  %item.kept = load i64, ptr %entry.p
  %e.next = add nuw i64 %e, 1
  %item.ok = icmp eq i64 %item.given, %item.kept
  br i1 %item.ok, label %item, label %other
list.same:
  %table.next = getelementptr i64, ptr %entries, i64 %size
  br label %list
known:
  %kernel.p = getelementptr i8, ptr %row, i64 {_KEYS * WORD}
  %kernel = load ptr, ptr %kernel.p
{_word("incref")}
{_word("decref")}
{_word("not_implemented")}
{load_at("code", "kernel", entry_point.VECTORCALL)}
  %first.remaining = call i64 @llvm.umin.i64(i64 %n, i64 %kernel_argument)
  %rest = getelementptr ptr, ptr %args, i64 %first.remaining
  %rest.count = sub nuw i64 %count, %n
  call void %incref(ptr %kernel)
{_LEAVE_ROW}  %result = call ptr %code(ptr %kernel, ptr %rest, i64 %rest.count, ptr null)
  call void %decref(ptr %kernel)
  %refused = icmp eq ptr %result, %not_implemented
  br i1 %refused, label %again, label %done
done:
  ret ptr %result
again:
  call void %decref(ptr %result)
  br label %slow
slow:
{_word("call")}
{load_at("callable", "self", entry_point.SLOW)}
  %result.slowly = call ptr %call(ptr %callable, ptr %args, i64 %flagged, ptr %keywords)
  ret ptr %result.slowly
}}
declare i64 @llvm.umin.i64(i64, i64)
"""
_EXCHANGE_IR = f"""
; Fills a row while no call looks at it.
define void @exchange(ptr %row, ptr %words, ptr %lock, ptr %unlock) nounwind {{
{_MUTEX}
  call void %lock(ptr %mutex)
  call void @llvm.memcpy.p0.p0.i64(ptr %row, ptr %words, i64 {(_ROW - 1) * WORD}, i1 false)
  call void %unlock(ptr %mutex)
  ret void
}}
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
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

    def __init__(self, first_arguments: int, kernel_argument: int | None, kernel_arguments: int) -> None:
        self._to_skip, self._kernel_argument, self._gap = 0, kernel_argument, kernel_arguments
        self._words = array("Q", bytes(WORD * _ROW << _BITS))
        self._references: list[Any] = [None] * (1 << _BITS)
        self.plan = array("Q", [first_arguments, self._words.buffer_info()[0], id(NotImplemented)])
        self.plan.extend(c_function(f) for f in ("PyObject_Vectorcall", "Py_IncRef", "Py_DecRef"))
        self.plan.extend((_WORD_MASK, 0) if kernel_argument is None else (kernel_argument, kernel_arguments))
        self.plan.extend(_mutex_functions())

    def put(self, arguments: tuple[Any, ...], remaining: int, kernel: Any, weak: int) -> None:
        """Has the kernel called for these first arguments, unless a row was replaced a few calls ago."""
        if self._to_skip:
            self._to_skip -= 1
            return
        if any([type(x) is int and not x <= _LARGEST_SHARED for x in arguments[weak:]]):
            return
        count = len(arguments) + remaining
        total = count  # calls with other numbers of arguments have other rows
        for x in arguments:
            total = (total ^ id(x) >> 4) * _MULTIPLIER & _WORD_MASK
        row = total >> 64 - _BITS
        first = row * _ROW
        if self._has(row, count, arguments, kernel):
            return
        lists = [(k, x, list(x)) for k, x in enumerate(arguments) if isinstance(x, list)]
        if lists and not has_gil():
            return
        addresses = [id(x) for x in arguments] + [0] * (MOST_FIRST_ARGUMENTS - len(arguments))
        entries = self._entries_of(lists)
        values = array(
            "Q",
            [
                count + 1,
                *addresses,
                id(kernel),
                entries.buffer_info()[0] if lists else 0,
            ],
        )
        with _lock:
            known = self._words[first : first + _KEYS]
            self._to_skip = _SKIPPED if known[0] and known != values[:_KEYS] else 0
            self._fill(first, _EMPTY)
            self._references[row] = (arguments[weak:], kernel, lists, entries)
            for x in arguments[:weak]:
                _rows_with(x).add((self, row))
            self._fill(first, values)

    def _has(self, row: int, count: int, arguments: tuple[Any, ...], kernel: Any) -> bool:
        """Whether a row without lists is there already: calls with keywords find none, and add theirs again."""
        words = self._words[row * _ROW : (row + 1) * _ROW].tolist()
        known = words[0] == count + 1 and words[_KEYS] == id(kernel) and not words[_KEYS + 1]
        return known and words[1 : len(arguments) + 1] == [*map(id, arguments)]

    def _entries_of(self, lists: list[tuple[int, Any, list[Any]]]) -> array[int]:
        """The table of the entries of lists, each with its number among the keys."""
        words, begin = array("Q"), _WORD_MASK if self._kernel_argument is None else self._kernel_argument
        for k, _, entries in lists:
            place = k + (self._gap if k >= begin else 0)
            words.extend([place + 1, len(entries), *map(id, entries)])
        words.append(0)
        return words

    def clear(self, row: int, address: int) -> None:
        """Empties a row that has the address of an object."""
        first = row * _ROW
        if address in self._words[first + 1 : first + _KEYS]:
            self._fill(first, _EMPTY)
            self._references[row] = None

    def _fill(self, first: int, values: array[int]) -> None:
        """Changes the row that begins at a word."""
        if has_gil():
            self._words[first : first + _ROW - 1] = values
            return
        row = self._words.buffer_info()[0] + first * WORD
        _exchange()[0](row, values.buffer_info()[0], *_mutex_functions())


_EMPTY = array("Q", bytes(WORD * (_ROW - 1)))
_lock = forks.lock(forks.KERNEL)
_rows_of: dict[int, set[tuple[_Table, int]]] = {}  # for the address of an object that is referred to weakly


def _rows_with(owner: Any) -> set[tuple[_Table, int]]:
    """The rows that have an object as a key; they are cleared when it is freed."""
    address = id(owner)
    rows = _rows_of.get(address)
    if rows is None:
        rows = _rows_of[address] = set()
        weakref.finalize(owner, _clear_rows_of, address).atexit = False
    return rows


def _clear_rows_of(address: int) -> None:
    with _lock:
        rows = _rows_of.pop(address, ())
        for table, row in rows:
            table.clear(row, address)


def forget(owner: Any) -> None:
    """Removes the kernels of calls with this first argument from all caches."""
    rows = _rows_of.get(id(owner))
    if rows:
        with _lock:
            for table, row in rows:
                table.clear(row, id(owner))
            rows.clear()


@final
class CallCache:
    """The kernels that answer calls with the same first arguments, of one function; see `repeated_calls`.

    Args:
        table: The table, or None where machine code cannot be called in this way.
        weak: How many of the first arguments are referred to weakly.
    """

    __slots__ = ("_table", "_weak")

    def __init__(self, table: _Table | None, weak: int) -> None:
        self._table, self._weak = table, weak

    def add(self, kernel: Any, remaining: int, *arguments: Any) -> None:
        """Has calls with these first arguments answered by a bound kernel.

        Args:
            kernel: What `into` returned.
            remaining: How many arguments such a call has besides: those that the kernel is called with.
            *arguments: The first arguments.
        """
        if self._table is not None and type(kernel) is bound_type():
            self._table.put(arguments, remaining, kernel, self._weak)


@functools.cache
def _own_type() -> type | None:
    return native_types.make_type(RepeatedCalls, "RepeatedCalls")


@functools.cache
def _code() -> tuple[Any, int]:
    code = jit.load_text(_IR, ("repeated",), has_loops=False)
    return code, code.address("repeated")


@functools.cache
def _mutex_functions() -> tuple[int, int]:
    """The addresses of what locks and unlocks a mutex; 0 with a global lock."""
    return (0, 0) if has_gil() else (c_function("PyMutex_Lock"), c_function("PyMutex_Unlock"))


@functools.cache
def _exchange() -> tuple[Any, Any]:
    """The function that fills a row, which nothing interrupts, and its code."""
    code = jit.load_text(_EXCHANGE_IR, ("exchange",), has_loops=False)
    return ctypes.PYFUNCTYPE(None, *[ctypes.c_void_p] * 4)(code.address("exchange")), code


def call_cache(
    first_arguments: int, weak: int, kernel_argument: int | None = None, kernel_arguments: int = 1
) -> CallCache:
    """A new cache for a function of `repeated_calls`.

    Args:
        first_arguments: How many arguments are keys, at most 4; in shorter calls all of them.
        weak: How many of the keys, from the first on, are referred to weakly.
        kernel_argument: Position among the keys of the first argument of the kernel; None where the kernel is called
            with all arguments after the keys.
        kernel_arguments: How many arguments the kernel has, where they stand between the keys.

    Returns:
        The cache.
    """
    if _own_type() is None:
        return CallCache(None, weak)
    return CallCache(_Table(first_arguments, kernel_argument, kernel_arguments), weak)


_KEEP: list[Any] = []


def repeated_calls(*caches: CallCache) -> Callable[[_Function], _Function]:
    """Has calls of a function answered by the kernels in its caches.

    Args:
        *caches: The caches, which are looked up in this order. The function calls `cache.add(kernel, remaining,
            *first_arguments)` for a kernel that may answer the same call the next time; where that answers
            NotImplemented, the next cache is looked up, and last the function is called.

    Returns:
        A decorator: what it makes has the function's name, signature and documentation. It is the function where
        machine code cannot be called in this way.
    """

    def decorate(function: Any) -> Any:
        for cache in reversed(caches):
            function = _looked_up(function, cache._table)
        return function

    return decorate


def _looked_up(function: Any, table: _Table | None) -> Any:
    """A function that looks calls up in a table first, in machine code."""
    kind = _own_type()
    if kind is None or table is None:
        return function
    words = {
        entry_point.VECTORCALL: _code()[1],
        entry_point.SLOW: id(function),
        entry_point.PLAN: table.plan.buffer_info()[0],
    }
    made = native_types.make_instance(kind, words)
    _KEEP.append((made, function, table))
    return functools.update_wrapper(made, function)
