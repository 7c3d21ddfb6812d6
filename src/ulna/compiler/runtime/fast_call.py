"""IR of the calls by which kernels write into existing arrays: `out=`, and arrays bound for good (see `bound`).

One piece of code serves all kernels: it reads what it must know of a kernel from a table of words, its plan. As in
`entry`, what is not exactly an array of the right type and shape goes to a Python callable, which converts or refuses.
Bound arrays are examined like arguments at every call: `resize(refcheck=False)`, `setflags`, `__setstate__` and the
setters of shape and dtype change an array in place, and NumPy refuses none of them while a buffer is exported.
"""

from __future__ import annotations

from ulna.compiler.runtime.entry_point import PLAN, SLOW
from ulna.compiler.runtime.object_layout import (
    ALIGNED,
    ARRAY_DESCRIPTOR,
    DATA,
    FLAGS,
    LENGTHS,
    NDIM,
    OWNED,
    READABLE,
    STEPS,
    TUPLE_ITEMS,
    TUPLE_SIZE,
    TYPE,
    TYPE_NUMBER,
    VALUE,
    WEAK_REFERENCES,
    WORD,
    WRITEABLE,
)

FIELDS = (
    "inputs", "givens", "outputs", "work",  # how many, and the kernel's code
    "returns_tuple",  # whether the result is a tuple; that of a function with one output need not be
    # tables of PORT words: axes, lengths, whether a float may stand for the array, the array's descriptor, the class
    # whose instances are passed, with the array in their one slot, or 0
    "ports_in", "ports_given", "ports_out",
    "given_arrays", "targets",  # tables of bound arrays
    "watch_count", "watched",  # how many, and a table of WATCH words: array, array, words to compare, a port for each
    "return_count", "returned",  # how many, and a table of RETURN words: axes, lengths, number of the pointer, bytes
    "array_type", "type_number", "float_type", "float64_type", "tuple_type", "out", "none",
    "array_new", "scalar_new", "descriptor", "tuple_new", "incref", "call",
    "holder", "allocate",  # the class that holds the one result, or 0, and what makes an instance
    "condition",  # 1 plus the number of the pointer to what must be above zero, or 0
    "pool", "decref",  # REUSED places for the last instances, or 0
    "float_new", "bool_type", "true", "false",
    "holders", "get_member", "member", "clear", "mutex", "lock", "unlock",  # only of `free_threaded_call`
)  # fmt: skip
"""The words of a plan."""
PORT, RETURN = 5, 4
WATCH = 3 + 2 * PORT
MOST_GATHERED = 16
"""So many entries may an array with gaps have for a bound kernel to take it without Python."""
REUSED = 2
"""So many of the last instances are written to again when nobody else has them: two, for `x = f()` in a loop."""


def _word(name: str, kind: str = "ptr") -> str:
    """Lines that load a word of the plan as `%name`."""
    at = FIELDS.index(name) * WORD
    return f"  %{name}.p = getelementptr i8, ptr %plan, i64 {at}\n  %{name} = load {kind}, ptr %{name}.p"


def load_at(name: str, base: str, offset: int, kind: str = "ptr") -> str:
    """Lines of IR that load a word.

    Args:
        name: What the word is called, `%name`.
        base: The pointer that it lies behind, `%base`.
        offset: How far behind [byte].
        kind: Its type.

    Returns:
        The lines.
    """
    return (
        f"  %{name}.p = getelementptr i8, ptr %{base}, i64 {offset}\n  %{name} = load {kind}, ptr %{name}.p"
    )


_TAKE = f"""
; The data of an object that is exactly an array of a port's shape, or holds one where it should, and of a number where
; one may stand; else null.
define internal ptr @take(ptr %plan, ptr %port, ptr %object, i32 %wanted) alwaysinline nounwind {{
entry:
{load_at("kind", "object", TYPE)}
{_word("array_type")}
{load_at("holder", "port", 4 * WORD)}
  %is.array = icmp eq ptr %kind, %array_type
  %is.bare = icmp eq ptr %holder, null
  %is.plain = and i1 %is.array, %is.bare
  br i1 %is.plain, label %fields, label %other
other:
  %is.held = icmp eq ptr %kind, %holder
  br i1 %is.held, label %inside, label %number
inside:
{load_at("inner", "object", VALUE)}
  %is.empty = icmp eq ptr %inner, null
  br i1 %is.empty, label %refused, label %content
content:
{load_at("inner.kind", "inner", TYPE)}
  %is.array.too = icmp eq ptr %inner.kind, %array_type
  br i1 %is.array.too, label %fields, label %refused
number:
{load_at("free", "port", 2 * WORD, "i64")}
{_word("float_type")}
{_word("float64_type")}
  %may = icmp ne i64 %free, 0
  %is.float = icmp eq ptr %kind, %float_type
  %is.float64 = icmp eq ptr %kind, %float64_type
  %is.number = or i1 %is.float, %is.float64
  %is.taken = and i1 %is.number, %may
  %value = getelementptr i8, ptr %object, i64 {VALUE}
  %found = select i1 %is.taken, ptr %value, ptr null
  ret ptr %found
fields:
  %array = phi ptr [ %object, %entry ], [ %inner, %content ]
{load_at("descr", "array", ARRAY_DESCRIPTOR)}
{load_at("ndim", "array", NDIM, "i32")}
{load_at("flags", "array", FLAGS, "i32")}
{load_at("axes", "port", 0, "i64")}
{load_at("descriptor", "port", 3 * WORD)}
  %descr.ok = icmp eq ptr %descr, %descriptor
  %axes.32 = trunc i64 %axes to i32
  %ndim.ok = icmp eq i32 %ndim, %axes.32
  %got = and i32 %flags, %wanted
  %flags.ok = icmp eq i32 %got, %wanted
  %both = and i1 %descr.ok, %ndim.ok
  %all = and i1 %both, %flags.ok
  br i1 %all, label %shape, label %refused
shape:
{load_at("given", "array", LENGTHS)}
{load_at("expected", "port", WORD)}
{load_at("data", "array", DATA)}
  br label %axis
axis:
  %k = phi i64 [ 0, %shape ], [ %next, %length ]
  %more = icmp ult i64 %k, %axes
  br i1 %more, label %length, label %taken
length:
  %given.p2 = getelementptr i64, ptr %given, i64 %k
  %given.k = load i64, ptr %given.p2
  %expected.p2 = getelementptr i64, ptr %expected, i64 %k
  %expected.k = load i64, ptr %expected.p2
  %next = add nuw i64 %k, 1
  %same = icmp eq i64 %given.k, %expected.k
  br i1 %same, label %axis, label %refused
taken:
  ret ptr %data
refused:
  ret ptr null
}}
"""


_GATHERED = f"""
; Copies a small float64 array with gaps, such as a column of a matrix; says whether it is of a port's shape.
define internal i1 @gathered(ptr %plan, ptr %port, ptr %object, ptr %to) noinline nounwind {{
entry:
{_word("array_type")}
{_word("type_number", "i64")}
{load_at("kind", "object", TYPE)}
{load_at("holder", "port", 4 * WORD)}
{load_at("axes", "port", 0, "i64")}
  %is.array = icmp eq ptr %kind, %array_type
  %is.bare = icmp eq ptr %holder, null
  %is.double = icmp eq i64 %type_number, {TYPE_NUMBER["double"]}
  %axes.0 = sub i64 %axes, 1
  %axes.ok = icmp ult i64 %axes.0, 2
  %plain = and i1 %is.array, %is.bare
  %known = and i1 %is.double, %axes.ok
  %may = and i1 %plain, %known
  br i1 %may, label %fields, label %no
fields:
{load_at("descr", "object", ARRAY_DESCRIPTOR)}
{load_at("ndim", "object", NDIM, "i32")}
{load_at("flags", "object", FLAGS, "i32")}
{load_at("descriptor", "port", 3 * WORD)}
  %descr.ok = icmp eq ptr %descr, %descriptor
  %axes.32 = trunc i64 %axes to i32
  %ndim.ok = icmp eq i32 %ndim, %axes.32
  %got = and i32 %flags, {ALIGNED}
  %flags.ok = icmp eq i32 %got, {ALIGNED}
  %both = and i1 %descr.ok, %ndim.ok
  %all = and i1 %both, %flags.ok
  br i1 %all, label %first, label %no
first:
{load_at("given", "object", LENGTHS)}
{load_at("steps", "object", STEPS)}
{load_at("expected", "port", WORD)}
{load_at("data", "object", DATA)}
  %rows = load i64, ptr %given
  %wanted0 = load i64, ptr %expected
  %same0 = icmp eq i64 %rows, %wanted0
  %step0 = load i64, ptr %steps
  %is.plane = icmp eq i64 %axes, 2
  br i1 %same0, label %second, label %no
second:
  br i1 %is.plane, label %plane, label %sizes
plane:
{load_at("given1", "given", WORD, "i64")}
{load_at("wanted1", "expected", WORD, "i64")}
{load_at("step1", "steps", WORD, "i64")}
  %same1 = icmp eq i64 %given1, %wanted1
  br i1 %same1, label %sizes, label %no
sizes:
  %columns = phi i64 [ 1, %second ], [ %given1, %plane ]
  %step.in.row = phi i64 [ 0, %second ], [ %step1, %plane ]
  %rows.0 = sub i64 %rows, 1
  %columns.0 = sub i64 %columns, 1
  %rows.ok = icmp ult i64 %rows.0, {MOST_GATHERED}
  %columns.ok = icmp ult i64 %columns.0, {MOST_GATHERED}
  %sizes.ok = and i1 %rows.ok, %columns.ok
  %size = mul i64 %rows, %columns
  %size.ok = icmp ule i64 %size, {MOST_GATHERED}
  %small = and i1 %sizes.ok, %size.ok
  br i1 %small, label %row, label %no
row:
  %i = phi i64 [ 0, %sizes ], [ %i.next, %row.end ]
  %at.row = phi ptr [ %data, %sizes ], [ %at.row.next, %row.end ]
  %to.row = phi ptr [ %to, %sizes ], [ %to.next, %row.end ]
  br label %entry.of
entry.of:
  %j = phi i64 [ 0, %row ], [ %j.next, %entry.of ]
  %at = phi ptr [ %at.row, %row ], [ %at.next, %entry.of ]
  %to.at = phi ptr [ %to.row, %row ], [ %to.next, %entry.of ]
  %x = load double, ptr %at, align 8
  store double %x, ptr %to.at, align 8
  %at.next = getelementptr i8, ptr %at, i64 %step.in.row
  %to.next = getelementptr double, ptr %to.at, i64 1
  %j.next = add nuw i64 %j, 1
  %j.more = icmp ult i64 %j.next, %columns
  br i1 %j.more, label %entry.of, label %row.end
row.end:
  %at.row.next = getelementptr i8, ptr %at.row, i64 %step0
  %i.next = add nuw i64 %i, 1
  %i.more = icmp ult i64 %i.next, %rows
  br i1 %i.more, label %row, label %yes
yes:
  ret i1 true
no:
  ret i1 false
}}
"""


def _collect(
    table: str,
    count: str,
    source: str,
    wanted: int,
    label: str,
    then: str,
    first: str = "0",
    gathers: bool = False,
) -> str:
    """Lines that take `%count` objects from `%source` into `%pointers`, from place `first` on; a loop named `label`.

    With `gathers`, small arrays with gaps are copied to the stack, and taken there.
    """
    otherwise, data, gather = "slow", f"{label}.data", ""
    if gathers:
        otherwise, data = f"{label}.gaps", f"{label}.chosen"
        gather = f"""{label}.gaps:
  %{label}.copy = alloca [{MOST_GATHERED} x double]
  %{label}.is.copied = call i1 @gathered(ptr %plan, ptr %{label}.port, ptr %{label}.object, ptr %{label}.copy)
  br i1 %{label}.is.copied, label %{label}.good, label %slow
"""
    chosen = f"  %{data} = phi ptr [ %{label}.data, %{label}.one ], [ %{label}.copy, %{label}.gaps ]\n"
    return f"""  br label %{label}
{label}:
  %{label}.k = phi i64 [ 0, %{label}.from ], [ %{label}.next, %{label}.good ]
  %{label}.more = icmp ult i64 %{label}.k, %{count}
  br i1 %{label}.more, label %{label}.one, label %{then}
{label}.one:
  %{label}.object.p = getelementptr ptr, ptr %{source}, i64 %{label}.k
  %{label}.object = load ptr, ptr %{label}.object.p
  %{label}.at = mul nuw i64 %{label}.k, {PORT * WORD}
  %{label}.port = getelementptr i8, ptr %{table}, i64 %{label}.at
  %{label}.data = call ptr @take(ptr %plan, ptr %{label}.port, ptr %{label}.object, i32 {wanted})
  %{label}.bad = icmp eq ptr %{label}.data, null
  br i1 %{label}.bad, label %{otherwise}, label %{label}.good
{gather}{label}.good:
{chosen if gathers else ""}  %{label}.place = add nuw i64 %{label}.k, {first}
  %{label}.to = getelementptr ptr, ptr %pointers, i64 %{label}.place
  store ptr %{data}, ptr %{label}.to
  %{label}.next = add nuw i64 %{label}.k, 1
  br label %{label}"""


_HEAD = f"""(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
{load_at("plan", "self", PLAN)}
{_word("inputs", "i64")}
{_word("givens", "i64")}
{_word("outputs", "i64")}
{_word("ports_in")}
  %count = and i64 %flagged, 9223372036854775807
  %count.ok = icmp eq i64 %count, %inputs
  %read = add nuw i64 %inputs, %givens
  %total = add nuw i64 %read, %outputs
  %pointers = alloca ptr, i64 %total"""
SLOW_IR = f"""slow:
{_word("call")}
{load_at("callable", "self", SLOW)}
  %result.slowly = call ptr %call(ptr %callable, ptr %args, i64 %flagged, ptr %keywords)
  ret ptr %result.slowly
}}
"""
"""The block that passes a call on to the Python callable, and the end of a definition."""

_GIVEN = f"""
; A kernel called otherwise than plainly: writes into `out`, one array or a tuple of arrays, where all is exact.
define ptr @with_out{_HEAD}
  %plain = icmp eq ptr %keywords, null
  br i1 %plain, label %slow, label %named
named:
{load_at("names", "keywords", TUPLE_SIZE, "i64")}
{load_at("name", "keywords", TUPLE_ITEMS)}
{_word("out")}
  %names.ok = icmp eq i64 %names, 1
  %name.ok = icmp eq ptr %name, %out
  %form = and i1 %names.ok, %name.ok
  %begin = and i1 %form, %count.ok
  br i1 %begin, label %into, label %slow
into:
  %target.p = getelementptr ptr, ptr %args, i64 %inputs
  %target = load ptr, ptr %target.p
{load_at("kind", "target", TYPE)}
{_word("tuple_type")}
  %is.tuple = icmp eq ptr %kind, %tuple_type
  br i1 %is.tuple, label %several, label %single
several:
{load_at("size", "target", TUPLE_SIZE, "i64")}
  %items = getelementptr i8, ptr %target, i64 {TUPLE_ITEMS}
  %size.ok = icmp eq i64 %size, %outputs
  br i1 %size.ok, label %in.from, label %slow
single:
{_word("returns_tuple", "i64")}
  %is.bare = icmp eq i64 %returns_tuple, 0
  br i1 %is.bare, label %in.from, label %slow
in.from:
  %source = phi ptr [ %items, %several ], [ %target.p, %single ]
{_collect("ports_in", "inputs", "args", READABLE, "in", "to.from")}
to.from:
{_word("ports_out")}
{_collect("ports_out", "outputs", "source", WRITEABLE, "to", "run", "%inputs")}
run:
{_word("work")}
{_word("incref")}
  %refused = call i32 %work(ptr %pointers)
  %done = icmp eq i32 %refused, 0
  br i1 %done, label %answer, label %slow
answer:
  %first = load ptr, ptr %source
{_word("returns_tuple", "i64").replace("%returns_tuple", "%tuples")}
  %is.whole = icmp ne i64 %tuples, 0
  %result = select i1 %is.whole, ptr %target, ptr %first
  call void %incref(ptr %result)
  ret ptr %result
{SLOW_IR}"""

_BOUND = f"""
  %plain = icmp eq ptr %keywords, null
  %begin = and i1 %plain, %count.ok
  br i1 %begin, label %in.from, label %slow
in.from:
{_collect("ports_in", "inputs", "args", READABLE, "in", "watch.from", gathers=True)}
watch.from:
{_word("watch_count", "i64")}
{_word("watched")}
  br label %watch
watch:
  %w = phi i64 [ 0, %watch.from ], [ %w.next, %compared ]
  %w.more = icmp ult i64 %w, %watch_count
  br i1 %w.more, label %compare, label %given.from
compare:
  %w.at = mul nuw i64 %w, {WATCH * WORD}
  %pair = getelementptr i8, ptr %watched, i64 %w.at
{load_at("live.array", "pair", 0)}
{load_at("kept.array", "pair", WORD)}
{load_at("words", "pair", 2 * WORD, "i64")}
  %live.port = getelementptr i8, ptr %pair, i64 {3 * WORD}
  %kept.port = getelementptr i8, ptr %pair, i64 {(3 + PORT) * WORD}
  %live = call ptr @take(ptr %plan, ptr %live.port, ptr %live.array, i32 {READABLE})
  %live.bad = icmp eq ptr %live, null
  br i1 %live.bad, label %slow, label %other
other:
  %kept = call ptr @take(ptr %plan, ptr %kept.port, ptr %kept.array, i32 {READABLE})
  %kept.bad = icmp eq ptr %kept, null
  br i1 %kept.bad, label %slow, label %both
both:
  %differ = call i1 @differ(ptr %live, ptr %kept, i64 %words)
  %w.next = add nuw i64 %w, 1
  br i1 %differ, label %slow, label %compared
compared:
  br label %watch
given.from:
{_word("ports_given")}
{_word("given_arrays")}
{_collect("ports_given", "givens", "given_arrays", READABLE, "given", "target.from", "%inputs")}
target.from:
{_word("ports_out")}
{_word("targets")}
{_collect("ports_out", "outputs", "targets", WRITEABLE, "target", "run", "%read")}
run:
{_word("work")}
{_word("return_count", "i64")}
{_word("returned")}
  %refused = call i32 %work(ptr %pointers)
  %done = icmp eq i32 %refused, 0
  br i1 %done, label %finished, label %slow
finished:
{_word("condition", "i64")}
  %unconditional = icmp eq i64 %condition, 0
  br i1 %unconditional, label %answer, label %examine
examine:
  %condition.k = sub nuw i64 %condition, 1
  %condition.p2 = getelementptr ptr, ptr %pointers, i64 %condition.k
  %condition.at = load ptr, ptr %condition.p2
  %condition.value = load double, ptr %condition.at
  %holds = fcmp ogt double %condition.value, 0.0
  br i1 %holds, label %answer, label %slow
answer:
  switch i64 %return_count, label %several [ i64 0, label %nothing
                                        i64 1, label %single ]
nothing:
{_word("none")}
{_word("incref")}
  call void %incref(ptr %none)
  ret ptr %none
single:
{_word("holder")}
{_word("float_type")}
  %is.float = icmp eq ptr %holder, %float_type
{_word("bool_type")}
  %is.bool = icmp eq ptr %holder, %bool_type
  %is.number = or i1 %is.float, %is.bool
  br i1 %is.number, label %one.number, label %array
one.number:
{_word("float_new")}
{load_at("number.place", "returned", 2 * WORD, "i64")}
  %number.p2 = getelementptr ptr, ptr %pointers, i64 %number.place
  %number.at = load ptr, ptr %number.p2
  %value = load double, ptr %number.at
  br i1 %is.float, label %python.float, label %python.bool
python.float:
  %float = call ptr %float_new(double %value)
  ret ptr %float
python.bool:
  %is.nan = fcmp uno double %value, %value
  br i1 %is.nan, label %slow, label %truth
truth:
{_word("true")}
{_word("false")}
{_word("incref").replace("%incref", "%incref.it")}
  %is.true = fcmp une double %value, 0.0
  %bool = select i1 %is.true, ptr %true, ptr %false
  call void %incref.it(ptr %bool)
  ret ptr %bool
array:
  %is.bare = icmp eq ptr %holder, null
{_word("pool")}
  %no.pool = icmp eq ptr %pool, null
  br i1 %no.pool, label %new, label %old
old:
  %again = call ptr @reused(ptr %plan, ptr %pool, ptr %pointers)
  %is.again = icmp ne ptr %again, null
  br i1 %is.again, label %reuse, label %new
reuse:
  ret ptr %again
new:
  %one = call ptr @copied(ptr %plan, ptr %returned, ptr %pointers)
  %no.one = icmp eq ptr %one, null
  %is.done = or i1 %is.bare, %no.one
  br i1 %is.done, label %alone, label %hold
alone:
  ret ptr %one
hold:
{_word("allocate")}
  %held = call ptr %allocate(ptr %holder, i64 0)
  %no.held = icmp eq ptr %held, null
  br i1 %no.held, label %failed, label %fill
fill:
  %slot = getelementptr i8, ptr %held, i64 {VALUE}
  store ptr %one, ptr %slot
  br i1 %no.pool, label %filled.it, label %remember
remember:
{_word("incref").replace("%incref", "%incref.held")}
{_word("decref")}
  %first.held = load ptr, ptr %pool
  %last.p = getelementptr ptr, ptr %pool, i64 1
  %last.held = load ptr, ptr %last.p
  call void %incref.held(ptr %held)
  store ptr %held, ptr %pool
  store ptr %first.held, ptr %last.p
  call void %decref(ptr %last.held)
  br label %filled.it
filled.it:
  ret ptr %held
several:
{_word("tuple_new")}
  %tuple = call ptr %tuple_new(i64 %return_count)
  %no.tuple = icmp eq ptr %tuple, null
  br i1 %no.tuple, label %failed, label %item
item:
  %r = phi i64 [ 0, %several ], [ %r.next, %filled ]
  %r.at = mul nuw i64 %r, {RETURN * WORD}
  %r.source = getelementptr i8, ptr %returned, i64 %r.at
  %r.copy = call ptr @copied(ptr %plan, ptr %r.source, ptr %pointers)
  %no.copy = icmp eq ptr %r.copy, null
  br i1 %no.copy, label %failed, label %filled
filled:
  %r.place = getelementptr i8, ptr %tuple, i64 {TUPLE_ITEMS}
  %r.to = getelementptr ptr, ptr %r.place, i64 %r
  store ptr %r.copy, ptr %r.to
  %r.next = add nuw i64 %r, 1
  %r.more = icmp ult i64 %r.next, %return_count
  br i1 %r.more, label %item, label %full
full:
  ret ptr %tuple
failed:
  ret ptr null
"""

_DIFFER = """
; Whether two blocks differ in any bit.
define internal i1 @differ(ptr %a, ptr %b, i64 %words) nounwind {
entry:
  %whole = and i64 %words, -8
  br label %block
block:
  %k = phi i64 [ 0, %entry ], [ %k.next, %look ]
  %sum = phi <8 x i64> [ zeroinitializer, %entry ], [ %sum.next, %look ]
  %more = icmp ult i64 %k, %whole
  br i1 %more, label %look, label %rest.from
look:
  %a.p = getelementptr i64, ptr %a, i64 %k
  %b.p = getelementptr i64, ptr %b, i64 %k
  %a.v = load <8 x i64>, ptr %a.p, align 8
  %b.v = load <8 x i64>, ptr %b.p, align 8
  %gap = xor <8 x i64> %a.v, %b.v
  %sum.next = or <8 x i64> %sum, %gap
  %k.next = add nuw i64 %k, 8
  br label %block
rest.from:
  %found = call i64 @llvm.vector.reduce.or.v8i64(<8 x i64> %sum)
  br label %rest
rest:
  %j = phi i64 [ %whole, %rest.from ], [ %j.next, %one ]
  %total = phi i64 [ %found, %rest.from ], [ %total.next, %one ]
  %j.more = icmp ult i64 %j, %words
  br i1 %j.more, label %one, label %end
one:
  %a.p1 = getelementptr i64, ptr %a, i64 %j
  %b.p1 = getelementptr i64, ptr %b, i64 %j
  %a.1 = load i64, ptr %a.p1
  %b.1 = load i64, ptr %b.p1
  %gap.1 = xor i64 %a.1, %b.1
  %total.next = or i64 %total, %gap.1
  %j.next = add nuw i64 %j, 1
  br label %rest
end:
  %differ = icmp ne i64 %total, 0
  ret i1 %differ
}
declare i64 @llvm.vector.reduce.or.v8i64(<8 x i64>)
"""

_COPIED = f"""
; A new array with what lies in a bound one, a NumPy scalar where it has no axes; null without memory.
define internal ptr @copied(ptr %plan, ptr %source, ptr %pointers) nounwind {{
entry:
{load_at("axes", "source", 0, "i64")}
{load_at("lengths", "source", WORD)}
{load_at("place", "source", 2 * WORD, "i64")}
  %from.p = getelementptr ptr, ptr %pointers, i64 %place
  %from = load ptr, ptr %from.p
  %scalar = icmp eq i64 %axes, 0
  br i1 %scalar, label %number, label %whole
number:
{_word("scalar_new")}
{_word("descriptor")}
  %value = call ptr %scalar_new(ptr %from, ptr %descriptor, ptr null)
  ret ptr %value
whole:
{load_at("bytes", "source", 3 * WORD, "i64")}
{_word("array_type")}
{_word("array_new")}
{_word("type_number", "i64")}
  %axes.32 = trunc i64 %axes to i32
  %number.32 = trunc i64 %type_number to i32
  %array = call ptr %array_new(ptr %array_type, i32 %axes.32, ptr %lengths, i32 %number.32,
                               ptr null, ptr null, i32 0, i32 0, ptr null)
  %bad = icmp eq ptr %array, null
  br i1 %bad, label %failed, label %made
made:
{load_at("data", "array", DATA)}
  call void @llvm.memcpy.p0.p0.i64(ptr %data, ptr %from, i64 %bytes, i1 false)
  ret ptr %array
failed:
  ret ptr null
}}
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
"""

_REUSED = f"""
; One of the last instances, filled anew, if nobody else refers to it or to its array, which is as it was made; or null.
define internal ptr @reused(ptr %plan, ptr %pool, ptr %pointers) nounwind {{
entry:
{_word("holder")}
{_word("returned")}
{_word("array_type")}
{load_at("place", "returned", 2 * WORD, "i64")}
{load_at("bytes", "returned", 3 * WORD, "i64")}
{_word("inputs", "i64")}
{_word("givens", "i64")}
{_word("ports_out")}
  %first = add nuw i64 %inputs, %givens
  %number = sub nuw i64 %place, %first
  %at = mul nuw i64 %number, {PORT * WORD}
  %port = getelementptr i8, ptr %ports_out, i64 %at
  br label %next
next:
  %k = phi i64 [ 0, %entry ], [ %k.next, %other ]
  %more = icmp ult i64 %k, {REUSED}
  br i1 %more, label %one, label %none.left
one:
  %held.p = getelementptr ptr, ptr %pool, i64 %k
  %held = load ptr, ptr %held.p
{load_at("kind", "held", TYPE)}
  %references = load i32, ptr %held
  %kind.ok = icmp eq ptr %kind, %holder
  %alone = icmp eq i32 %references, 1
  %free = and i1 %kind.ok, %alone
  br i1 %free, label %content, label %other
content:
{load_at("array", "held", VALUE)}
  %empty = icmp eq ptr %array, null
  br i1 %empty, label %other, label %inner
inner:
{load_at("array.kind", "array", TYPE)}
  %array.references = load i32, ptr %array
  %array.ok = icmp eq ptr %array.kind, %array_type
  %array.alone = icmp eq i32 %array.references, 1
  %array.free = and i1 %array.ok, %array.alone
  br i1 %array.free, label %fields, label %other
fields:
{load_at("flags", "array", FLAGS, "i32")}
{load_at("weak", "array", WEAK_REFERENCES)}
  %owned = and i32 %flags, {OWNED}
  %flags.ok = icmp eq i32 %owned, {OWNED}
  %weak.ok = icmp eq ptr %weak, null
  %usable = and i1 %flags.ok, %weak.ok
  br i1 %usable, label %shape, label %other
shape:
  %data = call ptr @take(ptr %plan, ptr %port, ptr %array, i32 {WRITEABLE})
  %changed = icmp eq ptr %data, null
  br i1 %changed, label %other, label %fill
other:
  %k.next = add nuw i64 %k, 1
  br label %next
fill:
{_word("incref")}
  %from.p = getelementptr ptr, ptr %pointers, i64 %place
  %from = load ptr, ptr %from.p
  call void @llvm.memcpy.p0.p0.i64(ptr %data, ptr %from, i64 %bytes, i1 false)
  call void %incref(ptr %held)
  ret ptr %held
none.left:
  ret ptr null
}}
"""


def bound_ir(define: str, slow: str) -> str:
    """IR of a kernel bound to arrays, with what it calls.

    Args:
        define: How its definition begins: linkage and name.
        slow: The block `slow`, where calls end that it does not answer, and the end of the definition.

    Returns:
        The definitions.
    """
    bound = f"""
; A kernel bound to arrays: compares what is watched, writes into the arrays, returns copies of some of them.
; Nothing of Python runs between the examination of the arrays and their last use.
{define}{_HEAD}{_BOUND}{slow}"""
    return _TAKE + _GATHERED + _DIFFER + _COPIED + _REUSED + bound


_PASSED_ON = f"""
; A call that goes to the Python callable, whatever its arguments.
define ptr @passed_on(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
{load_at("plan", "self", PLAN)}
  br label %slow
{SLOW_IR}"""

FAST_CALL_IR = {
    "passed_on": _PASSED_ON,
    "with_out": _TAKE + _GIVEN,
    "bound": bound_ir("define ptr @bound", SLOW_IR),
}
"""By the name of the call. The first kernel of a process waits for `passed_on`; the others are compiled when needed."""
