"""Functions that pass calls with arguments of known types to bound kernels, without running Python.

A function that means something else for other types (a placement times a placement, a point, a motion) has a row for
each: how many arguments, the exact types of each, and the bound kernel that answers. Machine code looks for the row of
a call, and calls its kernel with the same arguments, an int among them as a float. Where there is none, where the
kernel is not made yet, or where it answers NotImplemented, the function itself is called. A method that changes its
instance (`x += y`) has kernels that return a new one, whose numbers are copied into the array that the instance holds.

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
from ulna.compiler.runtime.object_layout import (
    DATA,
    FLAGS,
    TYPE,
    VALUE,
    WORD,
    WRITEABLE,
    c_function,
    has_gil,
    holder_slot,
)
from ulna.compiler.runtime.repeated_calls import RepeatedCalls
from ulna.errors import InputError
from ulna.system import forks

MOST_ARGUMENTS = 4
_ROW = (
    MOST_ARGUMENTS + 3
)  # how many arguments, the type of each, the place of an int plus 1 or 0, the kernel or 0
_FIELDS = (
    "rows", "count_of_rows", "not_implemented", "call", "decref", "incref", "method_new",
    "float_of", "float_new", "occurred", "clear", "bytes_of_array",
)  # fmt: skip


def _word(name: str, kind: str = "ptr") -> str:
    return load_at(name, "plan", _FIELDS.index(name) * WORD, kind)


_FIND = f"""(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
  %with.float = alloca [{MOST_ARGUMENTS} x ptr]
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
{_word("decref")}
{load_at("code", "kernel", entry_point.VECTORCALL)}
  %int.p = getelementptr i8, ptr %row, i64 {(_ROW - 2) * WORD}
  %int.place = load i64, ptr %int.p
  %no.int = icmp eq i64 %int.place, 0
  br i1 %no.int, label %as.given, label %convert
as.given:
  %result.of.given = call ptr %code(ptr %kernel, ptr %args, i64 %count, ptr null)
  br label %answered
convert:
{_word("float_of")}
{_word("float_new")}
{_word("occurred")}
  %int.at = sub i64 %int.place, 1
  %int.from = getelementptr ptr, ptr %args, i64 %int.at
  %int = load ptr, ptr %int.from
  %number = call double %float_of(ptr %int)
  %error = call ptr %occurred()
  %fits = icmp eq ptr %error, null
  br i1 %fits, label %number.of, label %too.large
too.large:
{_word("clear")}
  call void %clear()
  br label %slow
number.of:
  %float = call ptr %float_new(double %number)
  %no.float = icmp eq ptr %float, null
  br i1 %no.float, label %failed, label %replace
failed:
  ret ptr null
replace:
  %bytes = mul nuw i64 %count, {WORD}
  call void @llvm.memcpy.p0.p0.i64(ptr %with.float, ptr %args, i64 %bytes, i1 false)
  %float.to = getelementptr ptr, ptr %with.float, i64 %int.at
  store ptr %float, ptr %float.to
  %result.of.float = call ptr %code(ptr %kernel, ptr %with.float, i64 %count, ptr null)
  call void %decref(ptr %float)
  br label %answered
answered:
  %result = phi ptr [ %result.of.given, %as.given ], [ %result.of.float, %replace ]
  %refused = icmp eq ptr %result, %not_implemented
  br i1 %refused, label %again, label %done
again:
  call void %decref(ptr %result)
  br label %slow
slow:
{_word("call")}
{load_at("callable", "self", entry_point.SLOW)}
  %result.slowly = call ptr %call(ptr %callable, ptr %args, i64 %flagged, ptr %keywords)
  ret ptr %result.slowly
"""
_IR = f"""
define ptr @typed{_FIND}
done:
  ret ptr %result
}}

; The result is an instance like the first argument, which takes over its numbers, and is returned.
define ptr @in_place{_FIND}
done:
  %is.error = icmp eq ptr %result, null
  br i1 %is.error, label %failed, label %change
change:  ; the kernel found that the array of the first argument has no gaps, and the shape of the result
{_word("bytes_of_array", "i64")}
{_word("incref")}
  %first = load ptr, ptr %args
{load_at("array", "first", VALUE)}
{load_at("flags", "array", FLAGS, "i32")}
{load_at("to", "array", DATA)}
{load_at("made", "result", VALUE)}
{load_at("from", "made", DATA)}
  %got = and i32 %flags, {WRITEABLE}
  %may.write = icmp eq i32 %got, {WRITEABLE}
  br i1 %may.write, label %write, label %again
write:
  call void @llvm.memcpy.p0.p0.i64(ptr %to, ptr %from, i64 %bytes_of_array, i1 false)
  call void %decref(ptr %result)
  call void %incref(ptr %first)
  ret ptr %first
}}
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
"""
_CODE = _IR + bind_ir(_FIELDS)


@final
class TypedCalls:
    """The rows of a function; see `typed_calls`.

    Args:
        kinds: For each row the exact types of the arguments, at most four, one of which may be int.
        bytes_of_array: Where results are copied into the first argument: the size of the array that it holds [byte].

    Raises:
        InputError: A row has more.
    """

    def __init__(self, kinds: tuple[tuple[type, ...], ...], bytes_of_array: int = 0) -> None:
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
            place_of_int = row.index(int) + 1 if int in row else 0
            self._words.extend([len(row), *map(id, row), *rest, place_of_int, 0])
        self.plan = array("Q", [self._words.buffer_info()[0], len(kinds), id(NotImplemented)])
        self.plan.extend(c_function(name) for name in _FUNCTIONS)
        self.plan.append(bytes_of_array)

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


_FUNCTIONS = (
    *("PyObject_Vectorcall", "Py_DecRef", "Py_IncRef", "PyMethod_New"),
    *("PyLong_AsDouble", "PyFloat_FromDouble", "PyErr_Occurred", "PyErr_Clear"),
)
_lock = forks.lock(forks.KERNEL)
_KEEP: list[Any] = []


@functools.cache
def _code() -> Any:
    return jit.load_text(_CODE, ("typed", "in_place", "bind"), has_loops=False)


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
    in_place: int = 0,
) -> Callable[..., Any]:
    """What stands for a function so that calls with arguments of known types take no time of Python.

    Args:
        function: The function; called whenever there is no kernel for a call, or that answers NotImplemented. It gives
            the same answers.
        makers: By the exact types of arguments, at most four, what makes the bound kernel when such a call is first
            made. It takes these very arguments.
        is_method: Whether it is a method of a class, whose first argument is the instance.
        in_place: Of a method that changes and returns its instance, of a class with one slot that holds an array: the
            size of that array [byte]. Its kernels return new instances, whose numbers are copied.

    Returns:
        The object; the function itself where machine code cannot be called in this way.
    """
    kind = _own_type(is_method)
    if kind is None:
        return function
    if in_place and not (has_gil() and all(holder_slot(kinds[0]) for kinds in makers)):
        return function
    waiting, table = dict(makers), TypedCalls(tuple(makers), in_place)
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
        entry_point.VECTORCALL: _code().address("in_place" if in_place else "typed"),
        entry_point.SLOW: id(general),
        entry_point.PLAN: table.plan.buffer_info()[0],
    }
    if is_method:
        words[entry_point.CLASS] = id(types.FunctionType)
    made = native_types.make_instance(kind, words)
    _KEEP.append((made, general, table))
    return functools.update_wrapper(made, function, (*functools.WRAPPER_ASSIGNMENTS, *_OF_FUNCTIONS))


_OF_FUNCTIONS = ("__code__", "__defaults__", "__kwdefaults__", "__globals__", "__closure__")
