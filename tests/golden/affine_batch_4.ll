declare i32 @feclearexcept(i32)

define internal void @block(ptr %i0, i64 %i0s, ptr %o0, i64 %o0s) noinline nounwind #0 {
entry:
  %i0.r1 = getelementptr i8, ptr %i0, i64 %i0s
  %i0.r2 = getelementptr i8, ptr %i0.r1, i64 %i0s
  %i0.r3 = getelementptr i8, ptr %i0.r2, i64 %i0s
  %p1 = getelementptr double, ptr %i0, i64 0
  %w2 = load <2 x double>, ptr %p1, align 8
  %p3 = getelementptr double, ptr %i0.r1, i64 0
  %w4 = load <2 x double>, ptr %p3, align 8
  %p5 = getelementptr double, ptr %i0.r2, i64 0
  %w6 = load <2 x double>, ptr %p5, align 8
  %p7 = getelementptr double, ptr %i0.r3, i64 0
  %w8 = load <2 x double>, ptr %p7, align 8
  %t9 = shufflevector <2 x double> %w2, <2 x double> %w6, <4 x i32> <i32 0, i32 1, i32 2, i32 3>
  %t10 = shufflevector <2 x double> %w4, <2 x double> %w8, <4 x i32> <i32 0, i32 1, i32 2, i32 3>
  %t11 = shufflevector <4 x double> %t9, <4 x double> %t10, <4 x i32> <i32 0, i32 4, i32 2, i32 6>
  %t12 = shufflevector <4 x double> %t9, <4 x double> %t10, <4 x i32> <i32 1, i32 5, i32 3, i32 7>
  %p13 = getelementptr double, ptr %i0, i64 2
  %w14 = load double, ptr %p13, align 8
  %p15 = getelementptr double, ptr %i0.r1, i64 2
  %w16 = load double, ptr %p15, align 8
  %p17 = getelementptr double, ptr %i0.r2, i64 2
  %w18 = load double, ptr %p17, align 8
  %p19 = getelementptr double, ptr %i0.r3, i64 2
  %w20 = load double, ptr %p19, align 8
  %t21 = insertelement <4 x double> poison, double %w14, i32 0
  %t22 = insertelement <4 x double> %t21, double %w16, i32 1
  %t23 = insertelement <4 x double> %t22, double %w18, i32 2
  %t24 = insertelement <4 x double> %t23, double %w20, i32 3
  %v4 = fmul contract <4 x double> %t24, splat (double 0x4000000000000000)
  %v5 = fmul contract <4 x double> %t12, splat (double 0x4000000000000000)
  %v6 = fmul contract <4 x double> %t11, splat (double 0x4000000000000000)
  %v7 = fadd contract <4 x double> %t11, %v4
  %v8 = fadd contract <4 x double> %t11, %v5
  %o0.r1 = getelementptr i8, ptr %o0, i64 %o0s
  %o0.r2 = getelementptr i8, ptr %o0.r1, i64 %o0s
  %o0.r3 = getelementptr i8, ptr %o0.r2, i64 %o0s
  %t25 = shufflevector <4 x double> %v7, <4 x double> %v8, <4 x i32> <i32 0, i32 4, i32 2, i32 6>
  %t26 = shufflevector <4 x double> %v7, <4 x double> %v8, <4 x i32> <i32 1, i32 5, i32 3, i32 7>
  %t27 = shufflevector <4 x double> %t25, <4 x double> poison, <2 x i32> <i32 0, i32 1>
  %t28 = shufflevector <4 x double> %t26, <4 x double> poison, <2 x i32> <i32 0, i32 1>
  %t29 = shufflevector <4 x double> %t25, <4 x double> poison, <2 x i32> <i32 2, i32 3>
  %t30 = shufflevector <4 x double> %t26, <4 x double> poison, <2 x i32> <i32 2, i32 3>
  %p31 = getelementptr double, ptr %o0, i64 0
  store <2 x double> %t27, ptr %p31, align 8
  %p32 = getelementptr double, ptr %o0.r1, i64 0
  store <2 x double> %t28, ptr %p32, align 8
  %p33 = getelementptr double, ptr %o0.r2, i64 0
  store <2 x double> %t29, ptr %p33, align 8
  %p34 = getelementptr double, ptr %o0.r3, i64 0
  store <2 x double> %t30, ptr %p34, align 8
  %v9 = fadd contract <4 x double> %t11, %v6
  %t35 = extractelement <4 x double> %v9, i32 0
  %t36 = extractelement <4 x double> %v9, i32 1
  %t37 = extractelement <4 x double> %v9, i32 2
  %t38 = extractelement <4 x double> %v9, i32 3
  %p39 = getelementptr double, ptr %o0, i64 2
  store double %t35, ptr %p39, align 8
  %p40 = getelementptr double, ptr %o0.r1, i64 2
  store double %t36, ptr %p40, align 8
  %p41 = getelementptr double, ptr %o0.r2, i64 2
  store double %t37, ptr %p41, align 8
  %p42 = getelementptr double, ptr %o0.r3, i64 2
  store double %t38, ptr %p42, align 8
  ret void
}

define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {
entry:
  %n = load i64, ptr %dims
  %last = sub i64 %n, 1
  %a0.p = getelementptr ptr, ptr %args, i64 0
  %a0 = load ptr, ptr %a0.p
  %s0.p = getelementptr i64, ptr %steps, i64 0
  %s0 = load i64, ptr %s0.p
  %c0.0.p = getelementptr i64, ptr %steps, i64 2
  %c0.0 = load i64, ptr %c0.0.p
  %odd0.0 = icmp ne i64 %c0.0, 8
  %odd0.or0 = or i1 false, %odd0.0
  %dense0 = xor i1 %odd0.or0, true
  %t0 = alloca double, i64 12
  %a1.p = getelementptr ptr, ptr %args, i64 1
  %a1 = load ptr, ptr %a1.p
  %s1.p = getelementptr i64, ptr %steps, i64 1
  %s1 = load i64, ptr %s1.p
  %c1.0.p = getelementptr i64, ptr %steps, i64 3
  %c1.0 = load i64, ptr %c1.0.p
  %odd1.0 = icmp ne i64 %c1.0, 8
  %odd1.or0 = or i1 false, %odd1.0
  %dense1 = xor i1 %odd1.or0, true
  %t1 = alloca double, i64 12
  %none = icmp eq i64 %n, 0
  br i1 %none, label %done, label %step
step:
  %i = phi i64 [ 0, %entry ], [ %next, %put2 ]
  %left = sub i64 %n, %i
  %many = icmp uge i64 %left, 4
  %single = icmp eq i64 %left, 1
  %rows = select i1 %single, i64 1, i64 4
  %short = select i1 %single, i64 1, i64 %left
  %simple = or i1 %many, %single
  %count = select i1 %many, i64 4, i64 %short
  %direct0 = and i1 %dense0, %simple
  %direct1 = and i1 %dense1, %simple
  br label %get0
get0:
  br i1 %direct0, label %get1, label %get0.row
get0.row:
  %get0.row.k = phi i64 [ 0, %get0 ], [ %get0.row.n, %get0.row.end ]
  %get0.row.here = add i64 %i, %get0.row.k
  %get0.row.beyond = icmp ugt i64 %get0.row.here, %last
  %get0.row.at = select i1 %get0.row.beyond, i64 %last, i64 %get0.row.here
  %get0.row.o = mul i64 %get0.row.at, %s0
  %get0.row.p = getelementptr i8, ptr %a0, i64 %get0.row.o
  br label %get0.x0
get0.x0:
  %get0.x0.k = phi i64 [ 0, %get0.row ], [ %get0.x0.n, %get0.x0.end ]
  %get0.x0.m = mul i64 %get0.row.k, 3
  %get0.x0.f = add i64 %get0.x0.m, %get0.x0.k
  %get0.x0.o = mul i64 %get0.x0.k, %c0.0
  %get0.x0.p = getelementptr i8, ptr %get0.row.p, i64 %get0.x0.o
  %get0.s = getelementptr double, ptr %t0, i64 %get0.x0.f
  %get0.v = load double, ptr %get0.x0.p, align 8
  store double %get0.v, ptr %get0.s, align 8
  br label %get0.x0.end
get0.x0.end:
  %get0.x0.n = add i64 %get0.x0.k, 1
  %get0.x0.over = icmp eq i64 %get0.x0.n, 3
  br i1 %get0.x0.over, label %get0.row.end, label %get0.x0
get0.row.end:
  %get0.row.n = add i64 %get0.row.k, 1
  %get0.row.over = icmp eq i64 %get0.row.n, %rows
  br i1 %get0.row.over, label %get1, label %get0.row
get1:
  %o0 = mul i64 %i, %s0
  %p0 = getelementptr i8, ptr %a0, i64 %o0
  %r0 = select i1 %direct0, ptr %p0, ptr %t0
  %d0 = select i1 %direct0, i64 %s0, i64 24
  %e0 = select i1 %single, i64 0, i64 %d0
  %o1 = mul i64 %i, %s1
  %p1 = getelementptr i8, ptr %a1, i64 %o1
  %r1 = select i1 %direct1, ptr %p1, ptr %t1
  %d1 = select i1 %direct1, i64 %s1, i64 24
  %e1 = select i1 %single, i64 0, i64 %d1
  call void @block(ptr %r0, i64 %e0, ptr %r1, i64 %e1)
  br label %put1
put1:
  br i1 %direct1, label %put2, label %put1.row
put1.row:
  %put1.row.k = phi i64 [ 0, %put1 ], [ %put1.row.n, %put1.row.end ]
  %put1.row.here = add i64 %i, %put1.row.k
  %put1.row.beyond = icmp ugt i64 %put1.row.here, %last
  %put1.row.at = select i1 %put1.row.beyond, i64 %last, i64 %put1.row.here
  %put1.row.o = mul i64 %put1.row.at, %s1
  %put1.row.p = getelementptr i8, ptr %a1, i64 %put1.row.o
  br label %put1.x0
put1.x0:
  %put1.x0.k = phi i64 [ 0, %put1.row ], [ %put1.x0.n, %put1.x0.end ]
  %put1.x0.m = mul i64 %put1.row.k, 3
  %put1.x0.f = add i64 %put1.x0.m, %put1.x0.k
  %put1.x0.o = mul i64 %put1.x0.k, %c1.0
  %put1.x0.p = getelementptr i8, ptr %put1.row.p, i64 %put1.x0.o
  %put1.s = getelementptr double, ptr %t1, i64 %put1.x0.f
  %put1.v = load double, ptr %put1.s, align 8
  store double %put1.v, ptr %put1.x0.p, align 8
  br label %put1.x0.end
put1.x0.end:
  %put1.x0.n = add i64 %put1.x0.k, 1
  %put1.x0.over = icmp eq i64 %put1.x0.n, 3
  br i1 %put1.x0.over, label %put1.row.end, label %put1.x0
put1.row.end:
  %put1.row.n = add i64 %put1.row.k, 1
  %put1.row.over = icmp eq i64 %put1.row.n, %count
  br i1 %put1.row.over, label %put2, label %put1.row
put2:
  %next = add i64 %i, %count
  %end = icmp eq i64 %next, %n
  br i1 %end, label %done, label %step
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="256" "min-legal-vector-width"="256" "stackrealign" }
