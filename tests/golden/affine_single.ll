
define internal void @one(ptr %i0, ptr %o0) noinline nounwind {
entry:
  %p1 = getelementptr double, ptr %i0, i64 0
  %w2 = load double, ptr %p1, align 8
  %p3 = getelementptr double, ptr %i0, i64 1
  %w4 = load double, ptr %p3, align 8
  %p5 = getelementptr double, ptr %i0, i64 2
  %w6 = load double, ptr %p5, align 8
  %v4 = fmul contract double %w6, 0x4000000000000000
  %v5 = fmul contract double %w4, 0x4000000000000000
  %v6 = fmul contract double %w2, 0x4000000000000000
  %v7 = fadd contract double %w2, %v4
  %p7 = getelementptr double, ptr %o0, i64 0
  store double %v7, ptr %p7, align 8
  %v8 = fadd contract double %w2, %v5
  %p8 = getelementptr double, ptr %o0, i64 1
  store double %v8, ptr %p8, align 8
  %v9 = fadd contract double %w2, %v6
  %p9 = getelementptr double, ptr %o0, i64 2
  store double %v9, ptr %p9, align 8
  ret void
}

