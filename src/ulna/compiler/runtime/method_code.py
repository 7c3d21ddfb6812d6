"""IR of methods that call kernels, `method`, and of what they are as attributes, `bind`; see `method_call`.

One piece of code serves all methods: it reads what it must know of one from a table of words, its plan.
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.compiler.runtime.entry_point import PLAN, SLOW, VECTORCALL
from ulna.compiler.runtime.fast_call import load_at
from ulna.compiler.runtime.object_layout import TUPLE_ITEMS, TUPLE_SIZE, TYPE, WORD

FIELDS = (
    "kind", "owner", "is_subtype",  # the class of most instances, and one that it derives from
    "kernels", "kernel",  # where they have the table of kernels, and where that table has the kernel
    "tables", "name", "by_options",  # where they have the dictionaries, the key, and whether they are to be used
    "arrays", "options", "parameters", "names", "defaults",  # how many, their names, default values or 0
    "takes_out", "kernel_type", "out_names", "none", "call", "get", "occurred", "matches", "type_error", "clear",
    "method_new", "incref",
)  # fmt: skip
"""The words of a plan."""


def _word(name: str, kind: str = "ptr") -> str:
    return load_at(name, "plan", FIELDS.index(name) * WORD, kind)


_FIND = f"""
define ptr @method(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
{load_at("plan", "self", PLAN)}
{_word("kind")}
{_word("kernels", "i64")}
{_word("kernel", "i64")}
{_word("arrays", "i64")}
{_word("kernel_type")}
  %count = and i64 %flagged, 9223372036854775807
  %some = icmp ne i64 %count, 0
  br i1 %some, label %look, label %slow
look:
  %object = load ptr, ptr %args
{load_at("type", "object", TYPE)}
  %type.ok = icmp eq ptr %type, %kind
  br i1 %type.ok, label %table.of, label %derived
derived:
{_word("owner")}
{_word("is_subtype")}
  %derives = call i32 %is_subtype(ptr %type, ptr %owner)
  %is.other = icmp eq i32 %derives, 0
  br i1 %is.other, label %slow, label %table.of
table.of:
  %table.p = getelementptr i8, ptr %object, i64 %kernels
  %table = load ptr, ptr %table.p
  %no.table = icmp eq ptr %table, null
  br i1 %no.table, label %slow, label %default.of
default.of:
  %default.p = getelementptr i8, ptr %table, i64 %kernel
  %default = load ptr, ptr %default.p
  %made = icmp ne ptr %default, null
  %positional = sub i64 %count, 1
  %exact = icmp eq i64 %positional, %arrays
  %no.keywords = icmp eq ptr %keywords, null
  %simple = and i1 %exact, %no.keywords
  %plain = and i1 %simple, %made
  %first = getelementptr ptr, ptr %args, i64 1
  br i1 %plain, label %known, label %general
known:
  %kernel.chosen = phi ptr [ %default, %default.of ], [ %found, %no.out ], [ %found, %out.set ]
  %source = phi ptr [ %first, %default.of ], [ %values, %no.out ], [ %values, %out.set ]
  %named = phi ptr [ null, %default.of ], [ null, %no.out ], [ %out_names, %out.set ]
{load_at("kernel.is", "kernel.chosen", TYPE)}
  %is.native = icmp eq ptr %kernel.is, %kernel_type
  br i1 %is.native, label %run, label %slow
run:  ; the object owns its kernels for as long as it lives, and the caller the object
{load_at("code", "kernel.chosen", VECTORCALL)}
  %result = call ptr %code(ptr %kernel.chosen, ptr %source, i64 %arrays, ptr %named)
  ret ptr %result
general:
{_word("parameters", "i64")}
{_word("names")}
{_word("defaults")}
{_word("options", "i64")}
  %too.many = icmp ugt i64 %positional, %parameters
  br i1 %too.many, label %slow, label %fill.from
fill.from:
  %room = add nuw i64 %parameters, 1
  %values = alloca ptr, i64 %room
  br label %fill
"""
_SORT = f"""
fill:  ; arguments by position, then default values
  %k = phi i64 [ 0, %fill.from ], [ %k.next, %filled ]
  %k.more = icmp ult i64 %k, %parameters
  br i1 %k.more, label %one, label %keyword.from
one:
  %passed = icmp ult i64 %k, %positional
  %from = select i1 %passed, ptr %first, ptr %defaults
  %from.p = getelementptr ptr, ptr %from, i64 %k
  %value = load ptr, ptr %from.p
  %to.p = getelementptr ptr, ptr %values, i64 %k
  store ptr %value, ptr %to.p
  br label %filled
filled:
  %k.next = add nuw i64 %k, 1
  br label %fill
keyword.from:
  br i1 %no.keywords, label %array.from, label %keyword.count
keyword.count:
{load_at("keyword.total", "keywords", TUPLE_SIZE, "i64")}
  br label %keyword
keyword:  ; arguments by name, each of a parameter that has no argument by position
  %w = phi i64 [ 0, %keyword.count ], [ %w.next, %placed ]
  %w.more = icmp ult i64 %w, %keyword.total
  br i1 %w.more, label %name.of, label %array.from
name.of:
  %word.p0 = getelementptr i8, ptr %keywords, i64 {TUPLE_ITEMS}
  %word.p = getelementptr ptr, ptr %word.p0, i64 %w
  %word = load ptr, ptr %word.p
  br label %search
search:
  %s = phi i64 [ %positional, %name.of ], [ %s.next, %other ]
  %s.more = icmp ult i64 %s, %parameters
  br i1 %s.more, label %compare, label %slow
compare:
  %parameter.p = getelementptr ptr, ptr %names, i64 %s
  %parameter = load ptr, ptr %parameter.p
  %is.it = icmp eq ptr %parameter, %word
  br i1 %is.it, label %placed, label %other
other:
  %s.next = add nuw i64 %s, 1
  br label %search
placed:
  %place = getelementptr ptr, ptr %values, i64 %s
  %argument.k = add nuw i64 %count, %w
  %argument.p = getelementptr ptr, ptr %args, i64 %argument.k
  %argument = load ptr, ptr %argument.p
  store ptr %argument, ptr %place
  %w.next = add nuw i64 %w, 1
  br label %keyword
array.from:
  br label %array
array:
  %a = phi i64 [ 0, %array.from ], [ %a.next, %there ]
  %a.more = icmp ult i64 %a, %arrays
  br i1 %a.more, label %is.there, label %option.from
is.there:
  %a.p = getelementptr ptr, ptr %values, i64 %a
  %a.value = load ptr, ptr %a.p
  %missing = icmp eq ptr %a.value, null
  %a.next = add nuw i64 %a, 1
  br i1 %missing, label %slow, label %there
there:
  br label %array
"""
_CHOOSE = f"""
option.from:
  %end = add nuw i64 %arrays, %options
  br label %option
option:
  %o = phi i64 [ %arrays, %option.from ], [ %o.next, %is.default ]
  %o.more = icmp ult i64 %o, %end
  br i1 %o.more, label %option.of, label %all.default
option.of:
  %o.p = getelementptr ptr, ptr %values, i64 %o
  %o.value = load ptr, ptr %o.p
  %d.p = getelementptr ptr, ptr %defaults, i64 %o
  %d.value = load ptr, ptr %d.p
  %same = icmp eq ptr %o.value, %d.value
  %o.next = add nuw i64 %o, 1
  br i1 %same, label %is.default, label %chosen
is.default:
  br label %option
all.default:
  br i1 %made, label %out.from, label %slow
chosen:
{_word("by_options", "i64")}
  %may.look = icmp ne i64 %by_options, 0
  br i1 %may.look, label %tables.of, label %slow
tables.of:
{_word("tables", "i64")}
{_word("name")}
{_word("get")}
  %tables.p2 = getelementptr i8, ptr %object, i64 %tables
  %all = load ptr, ptr %tables.p2
  %of.name = call ptr %get(ptr %all, ptr %name)
  br label %level
level:
  %l = phi i64 [ %arrays, %tables.of ], [ %l.next, %deeper ]
  %dictionary = phi ptr [ %of.name, %tables.of ], [ %item, %deeper ]
  %nothing = icmp eq ptr %dictionary, null
  br i1 %nothing, label %refused, label %next
next:
  %l.more = icmp ult i64 %l, %end
  br i1 %l.more, label %deeper, label %out.from
deeper:
  %key.p = getelementptr ptr, ptr %values, i64 %l
  %key = load ptr, ptr %key.p
  %item = call ptr %get(ptr %dictionary, ptr %key)
  %l.next = add nuw i64 %l, 1
  br label %level
refused:  ; not made yet, or an option that is no key; other errors, such as that of Ctrl-C, are passed on
{_word("occurred")}
  %error = call ptr %occurred()
  %no.error = icmp eq ptr %error, null
  br i1 %no.error, label %slow, label %which
which:
{_word("matches")}
{_word("type_error")}
  %is.type.error = call i32 %matches(ptr %type_error)
  %forget = icmp ne i32 %is.type.error, 0
  br i1 %forget, label %clear.it, label %failed
clear.it:
{_word("clear")}
  call void %clear()
  br label %slow
failed:
  ret ptr null
out.from:
  %found = phi ptr [ %default, %all.default ], [ %dictionary, %next ]
{_word("takes_out", "i64")}
{_word("none")}
  %can.have.out = icmp ne i64 %takes_out, 0
  br i1 %can.have.out, label %threads.of, label %no.out
threads.of:
  %out.p = getelementptr ptr, ptr %values, i64 %end
  %out = load ptr, ptr %out.p
  %threads.k = add nuw i64 %end, 1
  %threads.p = getelementptr ptr, ptr %values, i64 %threads.k
  %threads = load ptr, ptr %threads.p
  %one.thread = icmp eq ptr %threads, %none
  br i1 %one.thread, label %out.of, label %slow
out.of:
  %no.out.there = icmp eq ptr %out, %none
  br i1 %no.out.there, label %no.out, label %out.set
no.out:
  br label %known
out.set:
{_word("out_names")}
  %out.to = getelementptr ptr, ptr %values, i64 %arrays
  store ptr %out, ptr %out.to
  br label %known
slow:
{_word("call")}
{load_at("callable", "self", SLOW)}
  %result.slowly = tail call ptr %call(ptr %callable, ptr %args, i64 %flagged, ptr %keywords)
  ret ptr %result.slowly
}}
"""


def bind_ir(fields: Sequence[str], bound: str = "function") -> str:
    """IR of what such an object is as an attribute, `bind`: the function, or a method of it bound to an instance.

    Args:
        fields: The words of its plan, among them `incref` and `method_new`.
        bound: What a bound method is of: the "function", or the object itself, "self".

    Returns:
        The definition.
    """
    incref, method_new = (
        load_at(name, "plan", fields.index(name) * WORD) for name in ("incref", "method_new")
    )
    return f"""
define ptr @bind(ptr %self, ptr %object, ptr %owner) nounwind {{
entry:
{load_at("plan", "self", PLAN)}
{load_at("function", "self", SLOW)}
  %of.class = icmp eq ptr %object, null
  br i1 %of.class, label %bare, label %bound
bare:
{incref}
  call void %incref(ptr %function)
  ret ptr %function
bound:
{method_new}
  %method = call ptr %method_new(ptr %{bound}, ptr %object)
  ret ptr %method
}}
"""


METHOD_IR = _FIND + _SORT + _CHOOSE + bind_ir(FIELDS)
