"""The code by which threads share the rows of a batch, from the post of a batch to the last row, without Python.

A helper waits in `help` for batches that `run` posts to its box, a few words of memory. Whoever calls `run` is the only
one that posts to these boxes meanwhile, and returns when no helper reads the batch any more.
"""

from __future__ import annotations

WORDS = ("loop", "arrays", "block", "threads", "data", "steps", "ends", "next")
"""The words of 64 bits that describe a batch: NumPy's inner loop, how many arrays it is passed, how many rows a block
has, how many threads there are; then addresses: of the arrays' addresses, of their steps, of where the rows of each
thread end, and of the next row of each."""

APART = 8
"""Words between the numbers of the next rows, so that threads do not write to the same line of a cache."""

BOX = ("state", "batch", "thread", "asleep", "wake", "done", "acquire", "release", "idle")
"""The words of a box: its state, the batch and the number of the thread in it, whether the helper sleeps, CPython's
lock that wakes the helper, the one that wakes the caller, the functions that take a lock and release it, and how long a
helper waits before it ends [us]."""

IDLE, POSTED, TAKEN, AWAITED, FINISHED, ENDED = range(6)
"""States of a box: no batch, a batch that the helper has not begun, one that it computes, one whose caller sleeps until
then, one that it is done with, and no helper any more."""

_LONGEST_SPIN = 50_000  # loads of about a nanosecond: as long as it takes to sleep and to be woken
_SOON = 2_000  # us: a helper that is woken within this time looks for the next batch before it sleeps again


_POINTERS = ("loop", "data", "steps", "ends", "next", "batch", "wake", "done", "acquire", "release")


def word_type(name: str) -> str:
    """The type of a word of a batch or a box.

    Args:
        name: Its name in `WORDS` or `BOX`.

    Returns:
        The type as LLVM spells it.
    """
    return "ptr" if name in _POINTERS else "i64"


def _words(of: str, names: tuple[str, ...], *wanted: str) -> str:
    """Instructions that load words of a table of them."""
    return "\n".join(
        f"  %{name}.p = getelementptr i64, ptr %{of}, i64 {names.index(name)}\n"
        f"  %{name} = load {word_type(name)}, ptr %{name}.p"
        for name in wanted or names
    )


_SHARE = f"""
; Computes blocks of rows, first those of one thread, until all are taken.
define internal void @share(ptr %batch, i64 %first) nounwind {{
entry:
{_words("batch", WORDS)}
  %own.data = alloca i64, i64 %arrays
  %rows.p = alloca i64
  br label %thread
thread:  ; first the rows of its own, then what other threads have not begun
  %turn = phi i64 [ 0, %entry ], [ %turn1, %thread.done ]
  %shifted = add i64 %first, %turn
  %of = urem i64 %shifted, %threads
  %place = mul i64 %of, {APART}
  %row.p = getelementptr i64, ptr %next, i64 %place
  %stop.p = getelementptr i64, ptr %ends, i64 %of
  %end = load i64, ptr %stop.p
  br label %take
take:
  %row = atomicrmw add ptr %row.p, i64 %block monotonic
  %remain = sub i64 %end, %row
  %none = icmp sle i64 %remain, 0
  br i1 %none, label %thread.done, label %rows
rows:
  %short = icmp slt i64 %remain, %block
  %count = select i1 %short, i64 %remain, i64 %block
  store i64 %count, ptr %rows.p
  br label %array
array:
  %k = phi i64 [ 0, %rows ], [ %k1, %array ]
  %data.from = getelementptr i64, ptr %data, i64 %k
  %step.from = getelementptr i64, ptr %steps, i64 %k
  %data.to = getelementptr i64, ptr %own.data, i64 %k
  %start = load i64, ptr %data.from
  %step = load i64, ptr %step.from
  %offset = mul i64 %row, %step
  %moved = add i64 %start, %offset
  store i64 %moved, ptr %data.to
  %k1 = add i64 %k, 1
  %last = icmp eq i64 %k1, %arrays
  br i1 %last, label %compute, label %array
compute:
  call void %loop(ptr %own.data, ptr %rows.p, ptr %steps, ptr null)
  br label %take
thread.done:
  %turn1 = add i64 %turn, 1
  %all = icmp eq i64 %turn1, %threads
  br i1 %all, label %done, label %thread
done:
  ret void
}}
"""

_HELP = f"""
; Computes rows of the batches that are posted to a box, until none came for as long as the box says.
define void @help(ptr %box) nounwind {{
entry:
{_words("box", BOX, "wake", "done", "acquire", "release", "idle")}
  %asleep.p = getelementptr i64, ptr %box, i64 {BOX.index("asleep")}
  br label %sleep
spin:  ; another batch may come at once, and to sleep and to be woken takes as long as this
  %spins = phi i64 [ 0, %finished ], [ %spins1, %spin.on ]
  %seen = load atomic i64, ptr %box acquire, align 8
  %is.here = icmp eq i64 %seen, {POSTED}
  br i1 %is.here, label %take, label %spin.more
spin.more:
  %spins1 = add i64 %spins, 1
  %enough = icmp eq i64 %spins1, {_LONGEST_SPIN}
  br i1 %enough, label %sleep, label %spin.on
spin.on:
  br label %spin
sleep:
  %was.awake = atomicrmw xchg ptr %asleep.p, i64 1 seq_cst
  %seen.last = load atomic i64, ptr %box seq_cst, align 8
  %is.late = icmp eq i64 %seen.last, {POSTED}
  br i1 %is.late, label %awake, label %sleep.short
sleep.short:
  %woken.soon = call i32 %acquire(ptr %wake, i64 {_SOON}, i32 0)
  %is.soon = icmp eq i32 %woken.soon, 1
  br i1 %is.soon, label %awake, label %sleep.long
sleep.long:
  %woken = call i32 %acquire(ptr %wake, i64 %idle, i32 0)
  %is.woken = icmp eq i32 %woken, 1
  br i1 %is.woken, label %awake, label %leave
leave:
  %left = cmpxchg ptr %box, i64 {IDLE}, i64 {ENDED} seq_cst seq_cst
  %has.left = extractvalue {{ i64, i1 }} %left, 1
  br i1 %has.left, label %end, label %awake
awake:
  %soon.here = phi i64 [ 1, %sleep ], [ 1, %sleep.short ], [ 0, %sleep.long ], [ 0, %leave ]
  %was.asleep = atomicrmw xchg ptr %asleep.p, i64 0 seq_cst
  br label %take
take:
  %soon = phi i64 [ 1, %spin ], [ %soon.here, %awake ]
  %taken = cmpxchg ptr %box, i64 {POSTED}, i64 {TAKEN} seq_cst seq_cst
  %is.taken = extractvalue {{ i64, i1 }} %taken, 1
  br i1 %is.taken, label %work, label %sleep
work:
{_words("box", BOX, "batch", "thread")}
  call void @share(ptr %batch, i64 %thread)
  %before = atomicrmw xchg ptr %box, i64 {FINISHED} seq_cst
  %is.awaited = icmp eq i64 %before, {AWAITED}
  br i1 %is.awaited, label %signal, label %finished
signal:
  call void %release(ptr %done)
  br label %finished
finished:
  %is.frequent = icmp eq i64 %soon, 1
  br i1 %is.frequent, label %spin, label %sleep
end:
  ret void
}}
"""

_RUN = f"""
; Computes a batch together with the helpers of some boxes; returns when none of them reads it any more.
define void @run(ptr %all, ptr %boxes, i64 %count) nounwind {{
entry:
  %none = icmp eq i64 %count, 0
  br i1 %none, label %alone, label %post
alone:
  call void @share(ptr %all, i64 0)
  ret void
post:
  %k = phi i64 [ 0, %entry ], [ %k1, %posted ]
  %k1 = add i64 %k, 1
  %to.p = getelementptr ptr, ptr %boxes, i64 %k
  %to = load ptr, ptr %to.p
  %batch.p = getelementptr i64, ptr %to, i64 {BOX.index("batch")}
  %thread.p = getelementptr i64, ptr %to, i64 {BOX.index("thread")}
  store ptr %all, ptr %batch.p
  store i64 %k1, ptr %thread.p
  %put = cmpxchg ptr %to, i64 {IDLE}, i64 {POSTED} seq_cst seq_cst
  %is.put = extractvalue {{ i64, i1 }} %put, 1
  br i1 %is.put, label %wake.helper, label %posted
wake.helper:
  %asleep.p = getelementptr i64, ptr %to, i64 {BOX.index("asleep")}
  %asleep = atomicrmw xchg ptr %asleep.p, i64 0 seq_cst
  %is.asleep = icmp eq i64 %asleep, 1
  br i1 %is.asleep, label %call, label %posted
call:
{_words("to", BOX, "wake", "release")}
  call void %release(ptr %wake)
  br label %posted
posted:
  %is.last = icmp eq i64 %k1, %count
  br i1 %is.last, label %own, label %post
own:
  call void @share(ptr %all, i64 0)
  br label %collect
collect:
  %j = phi i64 [ 0, %own ], [ %j1, %collected ]
  %j1 = add i64 %j, 1
  %box.p = getelementptr ptr, ptr %boxes, i64 %j
  %box = load ptr, ptr %box.p
  %back = cmpxchg ptr %box, i64 {POSTED}, i64 {IDLE} seq_cst seq_cst
  %held = extractvalue {{ i64, i1 }} %back, 0
  %is.taken = icmp eq i64 %held, {TAKEN}
  %is.finished = icmp eq i64 %held, {FINISHED}
  %is.theirs = or i1 %is.taken, %is.finished
  br i1 %is.theirs, label %wait, label %collected
wait:  ; for a block of rows, which takes less long than sleeping
  %spins = phi i64 [ 0, %collect ], [ %spins1, %wait.on ]
  %now = load atomic i64, ptr %box acquire, align 8
  %ended = icmp eq i64 %now, {FINISHED}
  br i1 %ended, label %reset, label %wait.more
wait.more:
  %spins1 = add i64 %spins, 1
  %long = icmp eq i64 %spins1, {_LONGEST_SPIN}
  br i1 %long, label %say, label %wait.on
wait.on:
  br label %wait
say:
  %said = cmpxchg ptr %box, i64 {TAKEN}, i64 {AWAITED} seq_cst seq_cst
  %is.said = extractvalue {{ i64, i1 }} %said, 1
  br i1 %is.said, label %sleep, label %reset
sleep:
{_words("box", BOX, "done", "acquire")}
  %got = call i32 %acquire(ptr %done, i64 -1, i32 0)
  br label %reset
reset:
  store atomic i64 {IDLE}, ptr %box seq_cst, align 8
  br label %collected
collected:
  %is.end = icmp eq i64 %j1, %count
  br i1 %is.end, label %end, label %collect
end:
  ret void
}}
"""

SHARE_IR = _SHARE + _HELP + _RUN
"""IR of `void help(ptr box)` and `void run(ptr batch, ptr boxes, i64 count)`."""
