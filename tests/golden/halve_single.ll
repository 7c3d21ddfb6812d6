
define internal void @one(ptr %i0, ptr %o0, ptr %o1) noinline nounwind {
entry:
  %p1 = getelementptr double, ptr %i0, i64 0
  %w2 = load double, ptr %p1, align 8
  br label %L2.head
L2.head:
  %L2.n = phi i64 [ 0, %entry ], [ %L2.n1, %L2.body ]
  %L2.alive = phi i1 [ true, %entry ], [ %L2.active, %L2.body ]
  %L2.x0 = phi double [ %w2, %entry ], [ %L2.y0, %L2.body ]
  %L2.x1 = phi double [ 0x0000000000000000, %entry ], [ %L2.y1, %L2.body ]
  %L2.v7 = fcmp olt double 0x3FF0000000000000, %L2.x0
  %L2.active = and i1 %L2.alive, %L2.v7
  %L2.more = icmp ult i64 %L2.n, 20
  %L2.go = and i1 %L2.active, %L2.more
  br i1 %L2.go, label %L2.body, label %L2.after
L2.body:
  %L2.v3 = fmul contract double %L2.x0, 0x3FE0000000000000
  %L2.v5 = fadd contract double %L2.x1, %w2
  %L2.y0 = select i1 %L2.active, double %L2.v3, double %L2.x0
  %L2.y1 = select i1 %L2.active, double %L2.v5, double %L2.x1
  %L2.n1 = add i64 %L2.n, 1
  br label %L2.head
L2.after:
  %p3 = getelementptr double, ptr %o0, i64 0
  store double %L2.x0, ptr %p3, align 8
  %p4 = getelementptr double, ptr %o1, i64 0
  store double %L2.x1, ptr %p4, align 8
  ret void
}

