"""Properties of objects that hold one array: they read and assign a part of it without running Python.

Reading makes a view of the part, as a slice does, or a float of one number. Assigning copies an array of float64 of the
part's shape, or a float, into the array. Machine code does so where the object is an instance of one class, and the
array that it holds, and the value, are exactly what they should be; in every other case the functions of an ordinary
property do, which convert or refuse. No Python runs between the checks and the copy, so that nothing changes meanwhile.
"""

from __future__ import annotations

import functools
from array import array
from collections.abc import Callable
from typing import Any

import numpy as np

from ulna.compiler.runtime import jit, native_types
from ulna.compiler.runtime.fast_call import load_at
from ulna.compiler.runtime.object_layout import (
    ALIGNED,
    ARRAY_DESCRIPTOR,
    DATA,
    FLAGS,
    LENGTHS,
    MAY_WRITE,
    NDIM,
    NEW_FROM_DESCRIPTOR,
    NUMPY_TYPE,
    READABLE,
    SET_BASE,
    STEPS,
    TYPE,
    VALUE,
    WORD,
    WRITEABLE,
    array_function,
    c_function,
    has_gil,
    holder_slot,
)
from ulna.errors import InputError
from ulna.typing import Array

_MOST = 16  # entries of a part
_FIELDS = (
    "kind",  # the class
    "held_axes", "held_length0", "held_length1",  # of the array that instances hold
    "axes", "length0", "length1", "step0", "step1", "offset",  # of the part; steps and offset in bytes
    "reads",  # whether machine code reads it
    "get", "set",  # of ordinary properties
    "array_type", "descriptor", "float_type", "float64_type",
    "new_from_descriptor", "set_base", "float_new", "incref", "decref",
)  # fmt: skip
_PLAN = property.__basicsize__ + WORD  # behind the documentation


def _word(name: str, kind: str = "ptr") -> str:
    return load_at(name, "plan", _FIELDS.index(name) * WORD, kind)


_FITS = f"""
; Whether an object is exactly an array of float64 of these lengths.
define internal i1 @fits(ptr %plan, ptr %object, i64 %axes, i64 %length0, i64 %length1,
                         i32 %wanted) alwaysinline nounwind {{
entry:
{_word("array_type")}
{load_at("kind", "object", TYPE)}
  %is.array = icmp eq ptr %kind, %array_type
  br i1 %is.array, label %fields, label %no
fields:
{_word("descriptor")}
{load_at("descr", "object", ARRAY_DESCRIPTOR)}
{load_at("ndim", "object", NDIM, "i32")}
{load_at("flags", "object", FLAGS, "i32")}
  %descr.ok = icmp eq ptr %descr, %descriptor
  %axes.32 = trunc i64 %axes to i32
  %ndim.ok = icmp eq i32 %ndim, %axes.32
  %got = and i32 %flags, %wanted
  %flags.ok = icmp eq i32 %got, %wanted
  %both = and i1 %descr.ok, %ndim.ok
  %all = and i1 %both, %flags.ok
  br i1 %all, label %first, label %no
first:
{load_at("lengths", "object", LENGTHS)}
  %given0 = load i64, ptr %lengths
  %same0 = icmp eq i64 %given0, %length0
  %is.plane = icmp eq i64 %axes, 2
  %more = and i1 %same0, %is.plane
  br i1 %more, label %second, label %done
second:
{load_at("given1", "lengths", WORD, "i64")}
  %same1 = icmp eq i64 %given1, %length1
  ret i1 %same1
done:
  ret i1 %same0
no:
  ret i1 false
}}

; The array that an object holds, where it is as it should be; else null.
define internal ptr @held(ptr %plan, ptr %object, i32 %wanted) alwaysinline nounwind {{
entry:
{_word("kind")}
{load_at("its.kind", "object", TYPE)}
  %is.one = icmp eq ptr %its.kind, %kind
  br i1 %is.one, label %inside, label %no
inside:
{load_at("array", "object", VALUE)}
  %is.empty = icmp eq ptr %array, null
  br i1 %is.empty, label %no, label %look
look:
{_word("held_axes", "i64")}
{_word("held_length0", "i64")}
{_word("held_length1", "i64")}
  %good = call i1 @fits(ptr %plan, ptr %array, i64 %held_axes, i64 %held_length0, i64 %held_length1, i32 %wanted)
  br i1 %good, label %yes, label %no
yes:
  ret ptr %array
no:
  ret ptr null
}}
"""
_GET = f"""
define ptr @get(ptr %self, ptr %object, ptr %owner) nounwind {{
entry:
{load_at("plan", "self", _PLAN)}
{_word("reads", "i64")}
  %has.object = icmp ne ptr %object, null
  %may = icmp ne i64 %reads, 0
  %begin = and i1 %has.object, %may
  br i1 %begin, label %look, label %slow
look:
  %array = call ptr @held(ptr %plan, ptr %object, i32 {READABLE})
  %refused = icmp eq ptr %array, null
  br i1 %refused, label %slow, label %part
part:
{_word("axes", "i64")}
{_word("offset", "i64")}
{load_at("data", "array", DATA)}
  %first = getelementptr i8, ptr %data, i64 %offset
  %is.number = icmp eq i64 %axes, 0
  br i1 %is.number, label %number, label %view.of
number:
{_word("float_new")}
  %value = load double, ptr %first, align 8
  %float = call ptr %float_new(double %value)
  ret ptr %float
view.of:
{_word("array_type")}
{_word("descriptor")}
{_word("incref")}
{_word("decref")}
{_word("new_from_descriptor")}
{_word("set_base")}
{load_at("flags", "array", FLAGS, "i32")}
  %kept = and i32 %flags, {MAY_WRITE | ALIGNED}
  %axes.32 = trunc i64 %axes to i32
  %lengths = getelementptr i8, ptr %plan, i64 {_FIELDS.index("length0") * WORD}
  %steps = getelementptr i8, ptr %plan, i64 {_FIELDS.index("step0") * WORD}
  call void %incref(ptr %descriptor)  ; the new array takes it
  %view = call ptr %new_from_descriptor(ptr %array_type, ptr %descriptor, i32 %axes.32, ptr %lengths,
                                        ptr %steps, ptr %first, i32 %kept, ptr null)
  %failed = icmp eq ptr %view, null
  br i1 %failed, label %none, label %base.of
base.of:
  call void %incref(ptr %array)  ; the view takes it
  %state = call i32 %set_base(ptr %view, ptr %array)
  %bad = icmp slt i32 %state, 0
  br i1 %bad, label %free, label %done
free:
  call void %decref(ptr %view)
  br label %none
none:
  ret ptr null
done:
  ret ptr %view
slow:
{load_at("slow.get", "plan", _FIELDS.index("get") * WORD)}
  %slowly = call ptr %slow.get(ptr %self, ptr %object, ptr %owner)
  ret ptr %slowly
}}
"""
_SET = f"""
define i32 @set(ptr %self, ptr %object, ptr %value) nounwind {{
entry:
  %copy = alloca [{_MOST} x double]
{load_at("plan", "self", _PLAN)}
  %is.deleted = icmp eq ptr %value, null
  br i1 %is.deleted, label %slow, label %look
look:
  %array = call ptr @held(ptr %plan, ptr %object, i32 {WRITEABLE})
  %refused = icmp eq ptr %array, null
  br i1 %refused, label %slow, label %part
part:
{_word("axes", "i64")}
{_word("offset", "i64")}
{load_at("data", "array", DATA)}
  %first = getelementptr i8, ptr %data, i64 %offset
  %is.number = icmp eq i64 %axes, 0
  br i1 %is.number, label %number, label %block
number:
{_word("float_type")}
{_word("float64_type")}
{load_at("kind", "value", TYPE)}
  %is.float = icmp eq ptr %kind, %float_type
  %is.float64 = icmp eq ptr %kind, %float64_type
  %is.known = or i1 %is.float, %is.float64
  br i1 %is.known, label %put.number, label %slow
put.number:
{load_at("number.is", "value", VALUE, "double")}
  store double %number.is, ptr %first, align 8
  ret i32 0
block:
{_word("length0", "i64")}
{_word("length1", "i64")}
{_word("step0", "i64")}
{_word("step1", "i64")}
  %good = call i1 @fits(ptr %plan, ptr %value, i64 %axes, i64 %length0, i64 %length1, i32 {ALIGNED})
  br i1 %good, label %source, label %slow
source:
{load_at("from", "value", DATA)}
{load_at("steps", "value", STEPS)}
  %from0 = load i64, ptr %steps
  %is.plane = icmp eq i64 %axes, 2
  br i1 %is.plane, label %plane, label %line
plane:
{load_at("from.step1", "steps", WORD, "i64")}
  br label %line
line:
  %from1 = phi i64 [ 0, %source ], [ %from.step1, %plane ]
  br label %read.row
read.row:  ; all of it before anything is written: the value may be a part of the same array
  %i = phi i64 [ 0, %line ], [ %i.next, %read.end ]
  %k = phi i64 [ 0, %line ], [ %k.next, %read.end ]
  %from.row = phi ptr [ %from, %line ], [ %from.row.next, %read.end ]
  br label %read
read:
  %j = phi i64 [ 0, %read.row ], [ %j.next, %read ]
  %k.here = phi i64 [ %k, %read.row ], [ %k.next, %read ]
  %from.at = phi ptr [ %from.row, %read.row ], [ %from.next, %read ]
  %x = load double, ptr %from.at, align 8
  %place = getelementptr double, ptr %copy, i64 %k.here
  store double %x, ptr %place, align 8
  %from.next = getelementptr i8, ptr %from.at, i64 %from1
  %j.next = add nuw i64 %j, 1
  %k.next = add nuw i64 %k.here, 1
  %read.more = icmp ult i64 %j.next, %length1
  br i1 %read.more, label %read, label %read.end
read.end:
  %from.row.next = getelementptr i8, ptr %from.row, i64 %from0
  %i.next = add nuw i64 %i, 1
  %rows.more = icmp ult i64 %i.next, %length0
  br i1 %rows.more, label %read.row, label %write.row
write.row:
  %m = phi i64 [ 0, %read.end ], [ %m.next, %write.end ]
  %n = phi i64 [ 0, %read.end ], [ %n.next, %write.end ]
  %to.row = phi ptr [ %first, %read.end ], [ %to.row.next, %write.end ]
  br label %write
write:
  %p = phi i64 [ 0, %write.row ], [ %p.next, %write ]
  %n.here = phi i64 [ %n, %write.row ], [ %n.next, %write ]
  %to.at = phi ptr [ %to.row, %write.row ], [ %to.next, %write ]
  %kept = getelementptr double, ptr %copy, i64 %n.here
  %y = load double, ptr %kept, align 8
  store double %y, ptr %to.at, align 8
  %to.next = getelementptr i8, ptr %to.at, i64 %step1
  %p.next = add nuw i64 %p, 1
  %n.next = add nuw i64 %n.here, 1
  %write.more = icmp ult i64 %p.next, %length1
  br i1 %write.more, label %write, label %write.end
write.end:
  %to.row.next = getelementptr i8, ptr %to.row, i64 %step0
  %m.next = add nuw i64 %m, 1
  %write.rows = icmp ult i64 %m.next, %length0
  br i1 %write.rows, label %write.row, label %done
done:
  ret i32 0
slow:
{load_at("slow.set", "plan", _FIELDS.index("set") * WORD)}
  %state = call i32 %slow.set(ptr %self, ptr %object, ptr %value)
  ret i32 %state
}}
"""


def array_property(
    ordinary: property, kind: type, shape: tuple[int, ...], part: Callable[[Array], Array], reads: bool = True
) -> property:
    """A property that does what another one does, by machine code where the usual case is at hand.

    Args:
        ordinary: The other property: its functions are called in all other cases, and give the same answers.
        kind: The class whose instances it is of, with one slot, which holds a float64 array.
        shape: The shape of that array, of at most two axes.
        part: The view of such an array that is read and assigned: of at most two axes and 16 entries.
        reads: Whether reading gives that view, or the float where it is one number; else the function is called.

    Returns:
        The property; the other one where machine code cannot be called in this way.

    Raises:
        InputError: `part` gives no view, or one that is too large.
    """
    made_type = _own_type() if has_gil() and holder_slot(kind) else None
    if made_type is None:
        return ordinary
    probe = np.zeros(shape)
    view = part(probe)
    if not np.shares_memory(view, probe) or view.size > _MOST or max(view.ndim, len(shape)) > 2:
        raise InputError(
            f"`part` gives an array of shape {view.shape}; expected a view of at most 16 entries."
        )
    held, of_part = (*shape, 1, 1)[:2], (*view.shape, 1, 1)[:2]
    steps = (*view.strides, 0, 0)[:2]
    offset = view.__array_interface__["data"][0] - probe.__array_interface__["data"][0]
    words = (id(kind), len(shape), *held, view.ndim, *of_part, *steps, offset, int(reads), *_common_words())
    plan = array("Q", words)
    made = native_types.make_instance(made_type, {_PLAN: plan.buffer_info()[0]})
    property.__init__(made, ordinary.fget, ordinary.fset, ordinary.fdel, ordinary.__doc__)
    made.__doc__ = ordinary.__doc__
    _KEEP.append((made, kind, plan))
    return made


_KEEP: list[Any] = []


@functools.cache
def _own_type() -> type | None:
    """The type of these properties; None where machine code cannot be called."""
    code = jit.load_text(_FITS + _GET + _SET, ("get", "set"), has_loops=False)
    _KEEP.append(code)
    return native_types.make_property_type("array_property", code.address("get"), code.address("set"), 2)


@functools.cache
def _common_words() -> tuple[int, ...]:
    """The words that are the same in all plans."""
    return (
        native_types.slot_of(property, native_types.GET),
        native_types.slot_of(property, native_types.SET),
        id(np.ndarray),
        id(NUMPY_TYPE["double"]),
        id(float),
        id(np.float64),
        array_function(NEW_FROM_DESCRIPTOR),
        array_function(SET_BASE),
        *map(c_function, ("PyFloat_FromDouble", "Py_IncRef", "Py_DecRef")),
    )
