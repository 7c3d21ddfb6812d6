"""IR of calls of kernels bound to arrays on a Python without a global lock, where other threads run meanwhile.

Two calls of one bound kernel write into the same arrays. So one waits for the other, from the first array that is
written to the last copy that is made, as they do for the global lock elsewhere. And an array that an object holds is
freed where another thread gives the object another one: so a call has a reference of its own to each that it reads.
"""

from __future__ import annotations

from ulna.compiler.runtime.entry_point import PLAN
from ulna.compiler.runtime.fast_call import FIELDS, SLOW_IR, bound_ir, load_at
from ulna.compiler.runtime.object_layout import TYPE, WORD


def _word(name: str, kind: str = "ptr") -> str:
    return load_at(name, "plan", FIELDS.index(name) * WORD, kind)


_LEFT = """slow:  ; never a result
  ret ptr %self
}
"""
_GUARDED = f"""
; The same with a lock, and with references to the arrays that arguments hold.
define ptr @bound(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {{
entry:
{load_at("plan", "self", PLAN)}
{_word("inputs", "i64")}
{_word("holders")}
{_word("mutex")}
{_word("lock")}
{_word("unlock")}
{_word("decref")}
  %count = and i64 %flagged, 9223372036854775807
  %count.ok = icmp eq i64 %count, %inputs
  %plain = icmp eq ptr %keywords, null
  %begin = and i1 %count.ok, %plain
  br i1 %begin, label %known, label %slow
known:
  %passed = alloca ptr, i64 %inputs
  %bare = icmp eq ptr %holders, null
  br i1 %bare, label %run, label %own.from
own.from:
{_word("get_member")}
{_word("member")}
  br label %own
own:  ; what is passed in place of each argument
  %k = phi i64 [ 0, %own.from ], [ %k.next, %owned ]
  %more = icmp ult i64 %k, %inputs
  br i1 %more, label %one, label %run
one:
  %object.p = getelementptr ptr, ptr %args, i64 %k
  %object = load ptr, ptr %object.p
  %holder.p = getelementptr ptr, ptr %holders, i64 %k
  %holder = load ptr, ptr %holder.p
  %is.bare = icmp eq ptr %holder, null
  br i1 %is.bare, label %owned, label %holding
holding:
{load_at("kind", "object", TYPE)}
  %is.held = icmp eq ptr %kind, %holder
  br i1 %is.held, label %inside, label %refused
inside:
  %array = call ptr %get_member(ptr %object, ptr %member)
  %is.empty = icmp eq ptr %array, null
  br i1 %is.empty, label %empty, label %owned
empty:  ; an AttributeError
{_word("clear")}
  call void %clear()
  br label %refused
owned:
  %value = phi ptr [ %object, %one ], [ %array, %inside ]
  %value.p = getelementptr ptr, ptr %passed, i64 %k
  store ptr %value, ptr %value.p
  %k.next = add nuw i64 %k, 1
  br label %own
refused:
  br label %release
run:
  %source = phi ptr [ %args, %known ], [ %passed, %own ]
  call void %lock(ptr %mutex)
  %answer = call ptr @unguarded(ptr %self, ptr %source, i64 %count, ptr null)
  call void %unlock(ptr %mutex)
  br i1 %bare, label %released, label %release
release:
  %result = phi ptr [ %self, %refused ], [ %answer, %run ]
  %taken = phi i64 [ %k, %refused ], [ %inputs, %run ]
  br label %next
next:
  %r = phi i64 [ 0, %release ], [ %r.next, %dropped ]
  %r.more = icmp ult i64 %r, %taken
  br i1 %r.more, label %drop, label %released
drop:
  %r.holder.p = getelementptr ptr, ptr %holders, i64 %r
  %r.holder = load ptr, ptr %r.holder.p
  %r.bare = icmp eq ptr %r.holder, null
  br i1 %r.bare, label %dropped, label %decref.it
decref.it:
  %r.value.p = getelementptr ptr, ptr %passed, i64 %r
  %r.value = load ptr, ptr %r.value.p
  call void %decref(ptr %r.value)
  br label %dropped
dropped:
  %r.next = add nuw i64 %r, 1
  br label %next
released:
  %end = phi ptr [ %answer, %run ], [ %result, %next ]
  %is.left = icmp eq ptr %end, %self
  br i1 %is.left, label %slow, label %done
done:
  ret ptr %end
{SLOW_IR}"""

GUARDED_BOUND_IR = bound_ir("define internal ptr @unguarded", _LEFT) + _GUARDED
"""In place of `FAST_CALL_IR["bound"]`."""
