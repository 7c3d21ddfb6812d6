
define internal void @one(ptr %i0, ptr noalias %o0) nounwind {
entry:
  %p1 = getelementptr double, ptr %i0, i64 0
  %i0.0.0 = load double, ptr %p1, align 8
  %p2 = getelementptr double, ptr %i0, i64 1
  %i0.1.0 = load double, ptr %p2, align 8
  %p3 = getelementptr double, ptr %i0, i64 2
  %i0.2.0 = load double, ptr %p3, align 8
  %v4 = fmul contract double %i0.2.0, 0x4000000000000000
  %v5 = fmul contract double %i0.1.0, 0x4000000000000000
  %v6 = fmul contract double %i0.0.0, 0x4000000000000000
  %v7 = fadd contract double %i0.0.0, %v4
  %v8 = fadd contract double %i0.0.0, %v5
  %v9 = fadd contract double %i0.0.0, %v6
  %p4 = getelementptr double, ptr %o0, i64 0
  store double %v7, ptr %p4, align 8
  %p5 = getelementptr double, ptr %o0, i64 1
  store double %v8, ptr %p5, align 8
  %p6 = getelementptr double, ptr %o0, i64 2
  store double %v9, ptr %p6, align 8
  ret void
}

