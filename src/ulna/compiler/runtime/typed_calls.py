"""Functions that pass calls with arguments of known types to bound kernels, without running Python.

A function that means something else for other types (a placement times a placement, a point, a motion) has a row for
each: how many arguments, the exact types of each, and the bound kernel that answers. Machine code looks for the row of
a call, and calls its kernel with the same arguments. Where there is none, where the kernel is not made yet, or where it
answers NotImplemented, the function itself is called.

What stands for the function in a module or a class looks like it: read as an attribute of a class or of an instance, it
is the function. A kernel stays in its row once it is there, so that machine code needs no reference of its own.
"""

from __future__ import annotations

import functools
import types
from array import array
from collections.abc import Callable, Mapping
from typing import Any, final

from ulna.compiler.runtime import entry_point, jit, native_types
from ulna.compiler.runtime.bound_call import bound_type
from ulna.compiler.runtime.fast_call import load_at
from ulna.compiler.runtime.method_code import bind_ir
from ulna.compiler.runtime.object_layout import TYPE, WORD, c_function
from ulna.compiler.runtime.repeated_calls import RepeatedCalls
from ulna.errors import InputError
from ulna.system import forks

MOST_ARGUMENTS = 4
_ROW = MOST_ARGUMENTS + 2  # how many arguments, the type of each, the kernel or 0
_FIELDS = ("rows", "count_of_rows", "not_implemented", "call", "decref", "incref", "method_new")


def _word(name: str, kind: str = "ptr") -> str:
    return load_at(name, "plan", _FIELDS.index(name) * WORD, kind)


_IR = f"""
define ptr @typed(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
{load_at("plan", "self", entry_point.PLAN)}
{_word("rows")}
{_word("count_of_rows", "i64")}
  %count = and i64 %flagged, 9223372036854775807
  %plain = icmp eq ptr %keywords, null
  br i1 %plain, label %next, label %slow
next:
  %k = phi i64 [ 0, %entry ], [ %k.next, %other ]
  %more = icmp ult i64 %k, %count_of_rows
  br i1 %more, label %look, label %slow
look:
  %at = mul nuw i64 %k, {_ROW * WORD}
  %row = getelementptr i8, ptr %rows, i64 %at
  %wanted = load i64, ptr %row
  %count.ok = icmp eq i64 %wanted, %count
  br i1 %count.ok, label %compare, label %other
compare:
  %j = phi i64 [ 0, %look ], [ %j.next, %one ]
  %left = icmp ult i64 %j, %count
  br i1 %left, label %one, label %found
one:
  %object.p = getelementptr ptr, ptr %args, i64 %j
  %object = load ptr, ptr %object.p
{load_at("kind", "object", TYPE)}
  %j.next = add nuw i64 %j, 1
  %kept.p = getelementptr ptr, ptr %row, i64 %j.next
  %kept = load ptr, ptr %kept.p
  %same = icmp eq ptr %kind, %kept
  br i1 %same, label %compare, label %other
other:
  %k.next = add nuw i64 %k, 1
  br label %next
found:
  %kernel.p = getelementptr i8, ptr %row, i64 {(_ROW - 1) * WORD}
  %kernel = load atomic ptr, ptr %kernel.p acquire, align {WORD}
  %missing = icmp eq ptr %kernel, null
  br i1 %missing, label %slow, label %run
run:
{_word("not_implemented")}
{load_at("code", "kernel", entry_point.VECTORCALL)}
  %result = call ptr %code(ptr %kernel, ptr %args, i64 %count, ptr null)
  %refused = icmp eq ptr %result, %not_implemented
  br i1 %refused, label %again, label %done
done:
  ret ptr %result
again:
{_word("decref")}
  call void %decref(ptr %result)
  br label %slow
slow:
{_word("call")}
{load_at("callable", "self", entry_point.SLOW)}
  %result.slowly = call ptr %call(ptr %callable, ptr %args, i64 %flagged, ptr %keywords)
  ret ptr %result.slowly
}}
"""
_CODE = _IR + bind_ir(_FIELDS)


@final
class TypedCalls:
    """The rows of a function; see `typed_calls`.

    Args:
        kinds: For each row the exact types of the arguments, at most four.

    Raises:
        InputError: A row has more.
    """

    def __init__(self, kinds: tuple[tuple[type, ...], ...]) -> None:
        self._kinds, self._kernels = kinds, [None] * len(kinds)
        self._words = array("Q")
        longest = max(kinds, key=len, default=())
        if len(longest) > MOST_ARGUMENTS:
            raise InputError(
                f"A row of typed calls has {len(longest)} types; expected at most {MOST_ARGUMENTS}, as many as machine "
                "code compares."
            )
        for row in kinds:
            rest = [0] * (MOST_ARGUMENTS - len(row))
            self._words.extend([len(row), *map(id, row), *rest, 0])
        self.plan = array("Q", [self._words.buffer_info()[0], len(kinds), id(NotImplemented)])
        self.plan.extend(c_function(name) for name in _FUNCTIONS)

    def put(self, row: int, kernel: Any) -> None:
        """Has calls of a row answered by a bound kernel from now on, unless it is not machine code.

        Args:
            row: The number of the row.
            kernel: What `into` returned, with an `otherwise` that answers NotImplemented.
        """
        with _lock:
            if self._kernels[row] is None and type(kernel) is bound_type():
                self._kernels[row] = kernel
                self._words[(row + 1) * _ROW - 1] = id(kernel)


_FUNCTIONS = ("PyObject_Vectorcall", "Py_DecRef", "Py_IncRef", "PyMethod_New")
_lock = forks.lock(forks.KERNEL)
_KEEP: list[Any] = []


@functools.cache
def _code() -> Any:
    return jit.load_text(_CODE, ("typed", "bind"), has_loops=False)


@functools.cache
def _own_type(is_method: bool) -> type | None:
    """The type of what stands for methods, or for other functions; None where there is none."""
    if bound_type() is None:
        return None
    if not is_method:
        return native_types.make_type(RepeatedCalls, "TypedCalls")
    flags, bind = native_types.LIKE_A_METHOD, _code().address("bind")
    members = {"__class__": entry_point.CLASS}
    return native_types.make_type(object, "typed_method", flags, bind, members)


def typed_calls(
    function: Callable[..., Any],
    makers: Mapping[tuple[type, ...], Callable[[], Any]],
    is_method: bool = False,
) -> Callable[..., Any]:
    """What stands for a function so that calls with arguments of known types take no time of Python.

    Args:
        function: The function; called whenever there is no kernel for a call, or that answers NotImplemented. It gives
            the same answers.
        makers: By the exact types of arguments, at most four, what makes the bound kernel when such a call is first
            made. It takes these very arguments.
        is_method: Whether it is a method of a class, whose first argument is the instance.

    Returns:
        The object; the function itself where machine code cannot be called in this way.
    """
    kind = _own_type(is_method)
    if kind is None:
        return function
    waiting, table = dict(makers), TypedCalls(tuple(makers))
    places = {kinds: row for row, kinds in enumerate(makers)}

    @functools.wraps(function)
    def general(*args: Any, **named: Any) -> Any:
        if waiting and not named:
            kinds = tuple(map(type, args))
            make = waiting.pop(kinds, None)
            if make is not None:
                table.put(places[kinds], make())
        return function(*args, **named)

    words = {
        entry_point.VECTORCALL: _code().address("typed"),
        entry_point.SLOW: id(general),
        entry_point.PLAN: table.plan.buffer_info()[0],
    }
    if is_method:
        words[entry_point.CLASS] = id(types.FunctionType)
    made = native_types.make_instance(kind, words)
    _KEEP.append((made, general, table))
    return functools.update_wrapper(made, function, (*functools.WRAPPER_ASSIGNMENTS, *_OF_FUNCTIONS))


_OF_FUNCTIONS = ("__code__", "__defaults__", "__kwdefaults__", "__globals__", "__closure__")
