"""The function that copies rows of an array of any strides into contiguous ones, or back, for loops over batches.

It is marked as rarely called: kernels share it (`rare_functions.py`), so that their own loops are short.
"""

from __future__ import annotations

from ulna.compiler.codegen.ir_text import BYTES, DType

NAME = "ulna.copy.rows"

_LOOP = """\
number:
  %j = phi i64 [ %size, %numbers ], [ %j.n, %number ]
  %from.j = phi ptr [ %from, %numbers ], [ %from.n, %number ]
  %to.j = phi ptr [ %to, %numbers ], [ %to.n, %number ]
  %v = load ELEMENT, ptr %from.j, align SIZE
  store ELEMENT %v, ptr %to.j, align SIZE
  %from.n = getelementptr i8, ptr %from.j, i64 %from.stride
  %to.n = getelementptr i8, ptr %to.j, i64 %to.stride
  %j.n = sub i64 %j, 1
  %j.over = icmp eq i64 %j.n, 0
  br i1 %j.over, label %copied, label %number
"""
"""Copies `%size` numbers, more than none, from `%from` to `%to`."""
_AXIS = """\
define internal ptr @NAME.axis(ptr %s, ptr %p, ptr %steps, ptr %axes, i1 %out) RARE {
entry:
  %size = load i64, ptr %axes
  %at.p = getelementptr i64, ptr %axes, i64 1
  %at = load i64, ptr %at.p
  %stride.p = getelementptr i64, ptr %steps, i64 %at
  %stride = load i64, ptr %stride.p
  %inner = getelementptr i64, ptr %axes, i64 2
  %inner.size = load i64, ptr %inner
  %is.last = icmp eq i64 %inner.size, 0
  br i1 %is.last, label %numbers, label %more
numbers:
  %from = select i1 %out, ptr %s, ptr %p
  %to = select i1 %out, ptr %p, ptr %s
  %from.stride = select i1 %out, i64 SIZE, i64 %stride
  %to.stride = select i1 %out, i64 %stride, i64 SIZE
  %beyond = getelementptr ELEMENT, ptr %s, i64 %size
  br label %number
LOOPcopied:
  ret ptr %beyond
more:
  %k = phi i64 [ 0, %entry ], [ %k.n, %more ]
  %s.k = phi ptr [ %s, %entry ], [ %s.n, %more ]
  %p.k = phi ptr [ %p, %entry ], [ %p.n, %more ]
  %s.n = call ptr @NAME.axis(ptr %s.k, ptr %p.k, ptr %steps, ptr %inner, i1 %out)
  %p.n = getelementptr i8, ptr %p.k, i64 %stride
  %k.n = add i64 %k, 1
  %over = icmp eq i64 %k.n, %size
  br i1 %over, label %done, label %more
done:
  ret ptr %s.n
}
"""
_ROWS = """\
define internal void @NAME(ptr %scratch, ptr %row, i64 %rows, i64 %last, ptr %steps, ptr %port, i1 %dense) RARE {
entry:
  %is.output = load i64, ptr %port
  %out = icmp ne i64 %is.output, 0
  %at.p = getelementptr i64, ptr %port, i64 1
  %at = load i64, ptr %at.p
  %stride.p = getelementptr i64, ptr %steps, i64 %at
  %stride = load i64, ptr %stride.p
  %size.p = getelementptr i64, ptr %port, i64 2
  %size = load i64, ptr %size.p
  %axes = getelementptr i64, ptr %port, i64 3
  %first.p = getelementptr i64, ptr %port, i64 4
  %first = load i64, ptr %first.p
  %inside.p = getelementptr i64, ptr %steps, i64 %first
  %inside = load i64, ptr %inside.p
  %second.p = getelementptr i64, ptr %port, i64 5
  %second = load i64, ptr %second.p
  %is.line = icmp eq i64 %second, 0
  %is.even = or i1 %dense, %is.line
  %between = select i1 %dense, i64 SIZE, i64 %inside
  %from.stride = select i1 %out, i64 SIZE, i64 %between
  %to.stride = select i1 %out, i64 %between, i64 SIZE
  br label %next
next:
  %k = phi i64 [ 0, %entry ], [ %k.n, %copied ]
  %s = phi ptr [ %scratch, %entry ], [ %s.n, %copied ]
  %p = phi ptr [ %row, %entry ], [ %p.n, %copied ]
  br i1 %is.even, label %numbers, label %axis
numbers:
  %from = select i1 %out, ptr %s, ptr %p
  %to = select i1 %out, ptr %p, ptr %s
  br label %number
LOOPaxis:
  %s.axis = call ptr @NAME.axis(ptr %s, ptr %p, ptr %steps, ptr %axes, i1 %out)
  br label %copied
copied:
  %s.n = getelementptr ELEMENT, ptr %s, i64 %size
  %is.before = icmp ult i64 %k, %last
  %step = select i1 %is.before, i64 %stride, i64 0
  %p.n = getelementptr i8, ptr %p, i64 %step
  %k.n = add i64 %k, 1
  %over = icmp eq i64 %k.n, %rows
  br i1 %over, label %done, label %next
done:
  ret void
}
"""


def copying(element: DType) -> str:
    """`void copy(ptr scratch, ptr row, i64 rows, i64 last, ptr steps, ptr port, i1 dense)` and what it calls.

    It copies rows into the scratch, or out of it to an output, and takes row `last` for those after it, too. `axis`
    copies what lies along some axes, and returns where the scratch goes on. `port` has whether the port is an output,
    where in steps the stride of its rows is, how many numbers a row has, of each axis its length and where its stride
    is, and a zero; for numbers two zeros stand for an axis. `dense` says that a row has no gaps.

    Args:
        element: Type of the array elements, "double" or "float".

    Returns:
        The text of the definitions.
    """
    words = {
        "LOOP": _LOOP,
        "NAME": NAME,
        "ELEMENT": element,
        "SIZE": str(BYTES[element]),
        "RARE": "noinline cold nounwind",
    }
    text = _AXIS + _ROWS
    for word, meaning in words.items():
        text = text.replace(word, meaning)
    return text
