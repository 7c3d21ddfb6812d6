declare float @llvm.sqrt.f32(float)
declare float @llvm.fabs.f32(float)
declare float @llvm.minimum.f32(float, float)

define internal void @one(ptr %i0, ptr %i1, ptr %o0, ptr %o1) noinline nounwind {
entry:
  %p1 = getelementptr float, ptr %i0, i64 0
  %w2 = load float, ptr %p1, align 4
  %p3 = getelementptr float, ptr %i1, i64 0
  %w4 = load float, ptr %p3, align 4
  %p5 = getelementptr float, ptr %o1, i64 0
  store float %w4, ptr %p5, align 4
  %v2 = fcmp olt float %w2, %w4
  %v4 = fcmp oeq float %w4, 0x0000000000000000
  %v5 = xor i1 %v4, true
  %v6 = and i1 %v2, %v5
  %v7 = call float @llvm.sqrt.f32(float %w2)
  %v8 = call float @llvm.fabs.f32(float %w2)
  %v9 = call float @llvm.minimum.f32(float %w4, float %v8)
  %v10 = select i1 %v6, float %v7, float %v9
  %p6 = getelementptr float, ptr %o0, i64 0
  store float %v10, ptr %p6, align 4
  ret void
}

