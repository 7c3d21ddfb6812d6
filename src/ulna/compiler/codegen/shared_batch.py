"""The code by which threads share the rows of a batch."""

from __future__ import annotations

WORDS = ("loop", "arrays", "block", "threads", "data", "steps", "ends", "next", "left")
"""The words of 64 bits that describe a batch: NumPy's inner loop, how many arrays it is passed, how many rows a block
has, how many threads there are; then addresses: of the arrays' addresses, of their steps, of where the rows of each
thread end, and of the next row of each; and how many rows are not computed yet."""

APART = 8
"""Words between the numbers of the next rows, so that threads do not write to the same line of a cache."""

_LONGEST_SPIN = 50_000  # loads of about a nanosecond: as long as it takes to sleep and to be woken


def _words() -> str:
    """Instructions that load the words."""
    return "\n".join(
        f"  %{name}.p = getelementptr i64, ptr %batch, i64 {k}\n  %{name} = load i64, ptr %{name}.p"
        for k, name in enumerate(WORDS)
    )


SHARE_IR = f"""
define void @share(ptr %batch, i64 %first) nounwind {{
entry:
{_words()}
  %call = inttoptr i64 %loop to ptr
  %all.data = inttoptr i64 %data to ptr
  %all.steps = inttoptr i64 %steps to ptr
  %all.ends = inttoptr i64 %ends to ptr
  %all.next = inttoptr i64 %next to ptr
  %own.data = alloca i64, i64 %arrays
  %rows.p = alloca i64
  br label %thread
thread:  ; first the rows of its own, then what other threads have not begun
  %turn = phi i64 [ 0, %entry ], [ %turn1, %thread.done ]
  %shifted = add i64 %first, %turn
  %of = urem i64 %shifted, %threads
  %place = mul i64 %of, {APART}
  %row.p = getelementptr i64, ptr %all.next, i64 %place
  %stop.p = getelementptr i64, ptr %all.ends, i64 %of
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
  %data.from = getelementptr i64, ptr %all.data, i64 %k
  %step.from = getelementptr i64, ptr %all.steps, i64 %k
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
  call void %call(ptr %own.data, ptr %rows.p, ptr %all.steps, ptr null)
  atomicrmw sub ptr %left.p, i64 %count release
  br label %take
thread.done:
  %turn1 = add i64 %turn, 1
  %all = icmp eq i64 %turn1, %threads
  br i1 %all, label %own, label %thread
own:  ; the calling thread waits for the blocks that others compute, which takes less long than sleeping
  %is.caller = icmp eq i64 %first, 0
  br i1 %is.caller, label %wait, label %done
wait:
  %spins = phi i64 [ 0, %own ], [ %spins1, %wait.on ]
  %waits = load atomic i64, ptr %left.p acquire, align 8
  %ended = icmp eq i64 %waits, 0
  %long = icmp eq i64 %spins, {_LONGEST_SPIN}
  %enough = or i1 %ended, %long
  br i1 %enough, label %done, label %wait.on
wait.on:
  %spins1 = add i64 %spins, 1
  br label %wait
done:
  ret void
}}
"""
"""IR of `void share(ptr batch, i64 first)`: computes blocks of rows, first those of one thread, until all are taken."""
