"""Methods that run a procedure of their object, without running Python.

An object that has called a procedure with certain arguments may leave a table in one of its slots: what arguments must
be for the same call to be right again (the same object, an object of a class with the same object in a slot, a list
with the same entries), and which arrays and numbers of theirs the procedure reads. Machine code examines the arguments
of a call by that table, writes where the arrays lie into the words of the procedure (see `BoundProcedure`), and runs
it. What the procedure returns, 0 or 1, is the truth value that the method returns. Where anything is not as expected,
and where the procedure returns another number, the Python function is called; it gives the same answer, and may leave
another table.

Nothing of Python runs between the examination and the end of the procedure, so all that the table leads to stays as it
is. That needs the global lock, which the procedure holds: without one methods stay what they are.
"""

from __future__ import annotations

import functools
import types
from array import array
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, final

import numpy as np

from ulna.compiler.runtime import entry_point, jit, native_types
from ulna.compiler.runtime.bound_call import bound_type
from ulna.compiler.runtime.fast_call import load_at
from ulna.compiler.runtime.method_code import bind_ir
from ulna.compiler.runtime.object_layout import (
    ARRAY_DESCRIPTOR,
    DATA,
    FLAGS,
    LENGTHS,
    LIST_ITEMS,
    LIST_SIZE,
    NDIM,
    READABLE,
    TYPE,
    VALUE,
    WORD,
    WRITEABLE,
    c_function,
    has_gil,
    slot_offset,
)
from ulna.compiler.runtime.procedure import BoundProcedure
from ulna.errors import InputError
from ulna.typing import Array

_FIELDS = (
    "kind", "slot", "array_type", "descriptor", "float_type", "true", "false", "none", "call", "incref", "method_new",
)  # fmt: skip
_RUN, _IS, _KIND, _ARRAY, _LIST, _LENGTH, _FLOAT = range(7)
_ROW = 7  # what is examined, number of the argument, slot [byte], three words, where to write; see `Calls`
# how many arguments, the procedure's code, its words, where it writes faults, whether None is returned, another table
_HEAD = 6


def _word(name: str, kind: str = "ptr") -> str:
    return load_at(name, "plan", _FIELDS.index(name) * WORD, kind)


_EXAMINE = f"""
define ptr @method(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
{load_at("plan", "self", entry_point.PLAN)}
{_word("kind")}
{_word("slot", "i64")}
{_word("array_type")}
{_word("descriptor")}
{_word("float_type")}
  %count = and i64 %flagged, 9223372036854775807
  %some = icmp ne i64 %count, 0
  %plain = icmp eq ptr %keywords, null
  %begin = and i1 %some, %plain
  br i1 %begin, label %owner, label %slow
owner:
  %instance = load ptr, ptr %args
{load_at("instance.kind", "instance", TYPE)}
  %kind.ok = icmp eq ptr %instance.kind, %kind
  br i1 %kind.ok, label %table.of, label %slow
table.of:
  %slot.at = getelementptr i8, ptr %instance, i64 %slot
  %holder = load ptr, ptr %slot.at
  %no.holder = icmp eq ptr %holder, null
  br i1 %no.holder, label %slow, label %holder.of
holder.of:
{load_at("holder.kind", "holder", TYPE)}
  %holder.ok = icmp eq ptr %holder.kind, %array_type
  br i1 %holder.ok, label %head, label %slow
head:
{load_at("table.0", "holder", DATA)}
  br label %look
look:
  %table = phi ptr [ %table.0, %head ], [ %table.next, %other ]
{load_at("wanted", "table", 0, "i64")}
  %count.ok = icmp eq i64 %wanted, %count
  %first = getelementptr i64, ptr %table, i64 {_HEAD}
  br i1 %count.ok, label %rows, label %other
other:  ; calls with another number of arguments may have a table, too
{load_at("table.next", "table", 5 * WORD)}
  %no.other = icmp eq ptr %table.next, null
  br i1 %no.other, label %slow, label %look
rows:
  br label %row
row:
  %at = phi ptr [ %first, %rows ], [ %at.next, %next ]
{load_at("sort", "at", 0, "i64")}
{load_at("argument", "at", WORD, "i64")}
{load_at("offset", "at", 2 * WORD, "i64")}
{load_at("x", "at", 3 * WORD)}
{load_at("y", "at", 4 * WORD, "i64")}
{load_at("z", "at", 5 * WORD, "i64")}
{load_at("target", "at", 6 * WORD)}
  %is.last = icmp eq i64 %sort, {_RUN}
  br i1 %is.last, label %run, label %base
base:
  %is.float = icmp eq i64 %sort, {_FLOAT}
  br i1 %is.float, label %from.slot, label %from.argument
from.argument:
  %given.p = getelementptr ptr, ptr %args, i64 %argument
  %given = load ptr, ptr %given.p
  %is.bare = icmp eq i64 %offset, 0
  br i1 %is.bare, label %object.of, label %from.slot
from.slot:
  %owner.is = phi ptr [ %x, %base ], [ %given, %from.argument ]
  %inner.p = getelementptr i8, ptr %owner.is, i64 %offset
  %inner = load ptr, ptr %inner.p
  %no.inner = icmp eq ptr %inner, null
  br i1 %no.inner, label %slow, label %object.of
object.of:
  %object = phi ptr [ %given, %from.argument ], [ %inner, %from.slot ]
{load_at("object.kind", "object", TYPE)}
  switch i64 %sort, label %slow [ i64 {_IS}, label %is
                                  i64 {_KIND}, label %kind.is
                                  i64 {_ARRAY}, label %array
                                  i64 {_LIST}, label %list
                                  i64 {_LENGTH}, label %length
                                  i64 {_FLOAT}, label %float ]
is:
  %same = icmp eq ptr %object, %x
  br i1 %same, label %next, label %slow
kind.is:
  %same.kind = icmp eq ptr %object.kind, %x
  br i1 %same.kind, label %next, label %slow
float:
  %float.ok = icmp eq ptr %object.kind, %float_type
{load_at("number", "object", VALUE, "i64")}
  store i64 %number, ptr %target
  br i1 %float.ok, label %next, label %slow
next:
  %at.next = getelementptr i64, ptr %at, i64 {_ROW}
  br label %row
"""
_REST = f"""
array:
  %array.ok = icmp eq ptr %object.kind, %array_type
  br i1 %array.ok, label %fields, label %slow
fields:
{load_at("numbers", "object", ARRAY_DESCRIPTOR)}
{load_at("ndim", "object", NDIM, "i32")}
{load_at("flags", "object", FLAGS, "i32")}
{load_at("lengths", "object", LENGTHS)}
{load_at("data", "object", DATA)}
  %ndim.64 = sext i32 %ndim to i64
  %flags.64 = zext i32 %flags to i64
  %got = and i64 %flags.64, %z
  %numbers.ok = icmp eq ptr %numbers, %descriptor
  %ndim.ok = icmp eq i64 %ndim.64, %y
  %flags.ok = icmp eq i64 %got, %z
  %both = and i1 %numbers.ok, %ndim.ok
  %all = and i1 %both, %flags.ok
  store ptr %data, ptr %target
  br i1 %all, label %entries.from, label %slow
list:
{load_at("size", "object", LIST_SIZE, "i64")}
{load_at("items", "object", LIST_ITEMS)}
  %size.ok = icmp eq i64 %size, %y
  br i1 %size.ok, label %entries.from, label %slow
length:
{load_at("size.only", "object", LIST_SIZE, "i64")}
  %size.only.ok = icmp eq i64 %size.only, %y
  br i1 %size.only.ok, label %next, label %slow
entries.from:  ; lengths of an array, or entries of a list
  %found = phi ptr [ %lengths, %fields ], [ %items, %list ]
  br label %entry.k
entry.k:
  %k = phi i64 [ 0, %entries.from ], [ %k.next, %entry.of ]
  %k.more = icmp ult i64 %k, %y
  br i1 %k.more, label %entry.of, label %next
entry.of:
  %found.p = getelementptr i64, ptr %found, i64 %k
  %found.k = load i64, ptr %found.p
  %kept.p = getelementptr i64, ptr %x, i64 %k
  %kept.k = load i64, ptr %kept.p
  %k.next = add nuw i64 %k, 1
  %entry.ok = icmp eq i64 %found.k, %kept.k
  br i1 %entry.ok, label %entry.k, label %slow
run:
{load_at("work", "table", WORD)}
{load_at("words", "table", 2 * WORD)}
{load_at("fault", "table", 3 * WORD)}
  %status = call i64 %work(ptr %words, ptr %fault)
  %failed = icmp ne i64 %status, 0
  %result = load i64, ptr %x
  %is.boolean = icmp ult i64 %result, 2
  %not.failed = xor i1 %failed, true
  %answered = and i1 %not.failed, %is.boolean
  br i1 %answered, label %answer, label %slow
answer:
{_word("true")}
{_word("false")}
{_word("none")}
{_word("incref")}
{load_at("is.none", "table", 4 * WORD, "i64")}
  %has.truth = icmp eq i64 %is.none, 0
  %is.true = icmp eq i64 %result, 1
  %truth = select i1 %is.true, ptr %true, ptr %false
  %found.it = select i1 %has.truth, ptr %truth, ptr %none
  call void %incref(ptr %found.it)
  ret ptr %found.it
slow:
{_word("call")}
{load_at("callable", "self", entry_point.SLOW)}
  %result.slowly = call ptr %call(ptr %callable, ptr %args, i64 %flagged, ptr %keywords)
  ret ptr %result.slowly
}}
"""
_IR = _EXAMINE + _REST + bind_ir(_FIELDS, "self")  # `solver.solve(*arguments)` makes a bound method


class Slot(NamedTuple):
    """An argument, or what is in a slot of it.

    Attributes:
        argument: Its number; the object that has the method is 0.
        name: The slot; empty for the argument itself.
    """

    argument: int
    name: str = ""


@final
class Calls:
    """What arguments must be for a bound procedure to answer a call.

    Args:
        run: The procedure; it returns 0 or 1 as the answer, another number where the method is to be run.
        arguments: The arguments, with the object first.
        returns_none: Whether the method returns None, whatever the answer.
    """

    def __init__(self, run: BoundProcedure, arguments: Sequence[Any], returns_none: bool = False) -> None:
        self._run, self._arguments, self._returns_none = run, tuple(arguments), returns_none
        self._rows, self._alive = array("Q"), list[Any]([run])

    def _row(self, sort: int, of: Slot, words: Sequence[int], target: int = 0) -> None:
        owner = self._arguments[of.argument]
        offset = _offset(owner, of.name) if of.name else 0
        self._rows.extend([sort, of.argument, offset, *words, *[0] * (3 - len(words)), target])

    def _found(self, of: Slot) -> Any:
        owner = self._arguments[of.argument]
        return getattr(owner, of.name) if of.name else owner

    def expect_kind(self, *arguments: int) -> None:
        """Has arguments be of exactly the class that they are of."""
        for k in arguments:
            self._row(_KIND, Slot(k), [id(type(self._arguments[k]))])
            self._alive.append(type(self._arguments[k]))

    def expect_same(self, of: Slot) -> None:
        """Has something be the object that it is."""
        found = self._found(of)
        self._row(_IS, of, [id(found)])
        self._alive.append(found)

    def expect_entries(self, argument: int) -> None:
        """Has a list be of the same class, with the same entries."""
        entries = list(self._arguments[argument])
        table = array("Q", map(id, entries))
        self.expect_kind(argument)
        self._row(_LIST, Slot(argument), [table.buffer_info()[0], len(entries)])
        self._alive += [entries, table]

    def expect_length(self, argument: int) -> None:
        """Has a list be of the same class, with as many entries."""
        self.expect_kind(argument)
        self._row(_LENGTH, Slot(argument), [0, len(self._arguments[argument])])

    def take_array(self, of: Slot, name: str, is_written: bool = False) -> None:
        """Has the procedure read an array of floats of the same shape without gaps, or write to it.

        Args:
            of: Where it is.
            name: The parameter of the procedure, such as `record.field`.
            is_written: Whether the procedure writes to it.
        """
        shape = self._found(of).shape
        lengths = array("Q", shape)
        flags = WRITEABLE if is_written else READABLE
        self._row(_ARRAY, of, [lengths.buffer_info()[0], len(shape), flags], self._run.address_of_word(name))
        self._alive.append(lengths)

    def take_float(self, owner: Any, slot: str, target: Array) -> None:
        """Has a number that an object has in a slot written into an array before every call.

        Args:
            owner: The object; it is kept alive.
            slot: The slot.
            target: The number in an array (1,) that the procedure reads.
        """
        self._rows.extend(
            [
                _FLOAT,
                0,
                _offset(owner, slot),
                id(owner),
                0,
                0,
                target.__array_interface__["data"][0],
            ]
        )
        self._alive += [owner, target]

    def table(self, other: Array | None = None) -> tuple[Array, Any]:
        """What an object has to have in its slot, and what must stay alive as long.

        Args:
            other: The table (n,) of calls with another number of arguments, which must stay alive, too.

        Returns:
            Both.
        """
        following = 0 if other is None else other.__array_interface__["data"][0]
        head = [len(self._arguments), *self._run.addresses(), int(self._returns_none), following]
        end = [_RUN, 0, 0, self._run.address_of_result(), 0, 0, 0]
        return np.array([*head, *self._rows, *end], np.uint64), self._alive


def _offset(owner: Any, slot: str) -> int:
    """Where an object has a slot [byte]."""
    offset = slot_offset(type(owner), slot)
    if not offset:
        raise InputError(f"`{slot}` is no slot of {type(owner).__name__} that machine code can read.")
    return offset


_KEEP: list[Any] = []


@functools.cache
def _code() -> Any:
    return jit.load_text(_IR, ("method", "bind"), has_loops=False)


@functools.cache
def _own_type() -> type | None:
    if bound_type() is None or not has_gil():
        return None
    flags, bind = native_types.LIKE_A_METHOD, _code().address("bind")
    return native_types.make_type(object, "procedure_method", flags, bind, {"__class__": entry_point.CLASS})


def procedure_method(function: Callable[..., Any], owner: type, slot: str) -> Callable[..., Any]:
    """What stands for a method so that calls of which an object has a table take no time of Python.

    Args:
        function: The method.
        owner: The class that has it, and whose instances have the tables; classes that derive from it have none.
        slot: The slot with `Calls.table()`, or None.

    Returns:
        The object; the function itself where machine code cannot be called in this way.
    """
    kind, offset = _own_type(), slot_offset(owner, slot)
    if kind is None or not offset:
        return function
    words = [
        id(owner), offset, id(np.ndarray), id(np.dtype(np.float64)), id(float), id(True), id(False), id(None),
        *(c_function(name) for name in ("PyObject_Vectorcall", "Py_IncRef", "PyMethod_New")),
    ]  # fmt: skip
    plan = array("Q", words)
    made = native_types.make_instance(
        kind,
        {
            entry_point.VECTORCALL: _code().address("method"),
            entry_point.SLOW: id(function),
            entry_point.PLAN: plan.buffer_info()[0],
            entry_point.CLASS: id(types.FunctionType),
        },
    )
    _KEEP.append((made, function, owner, plan))
    return functools.update_wrapper(made, function, (*functools.WRAPPER_ASSIGNMENTS, *_OF_FUNCTIONS))


def has_machine_code(owner: type, name: str) -> bool:
    """Whether a method of a class is one of `procedure_method`.

    Args:
        owner: The class.
        name: The name of the method.

    Returns:
        Whether it is.
    """
    return _own_type() is not None and type(vars(owner).get(name)) is _own_type()


_OF_FUNCTIONS = ("__code__", "__defaults__", "__kwdefaults__", "__globals__", "__closure__")
