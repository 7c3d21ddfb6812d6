declare i32 @feclearexcept(i32)

define internal void @block(ptr %i0, i64 %i0s, ptr %o0, i64 %o0s) noinline nounwind #0 {
entry:
  %i0.r1 = getelementptr i8, ptr %i0, i64 %i0s
  %i0.r2 = getelementptr i8, ptr %i0.r1, i64 %i0s
  %i0.r3 = getelementptr i8, ptr %i0.r2, i64 %i0s
  %p1 = getelementptr double, ptr %i0, i64 0
  %i0.0.0 = load double, ptr %p1, align 8
  %t2 = insertelement <4 x double> poison, double %i0.0.0, i32 0
  %p3 = getelementptr double, ptr %i0.r1, i64 0
  %i0.0.1 = load double, ptr %p3, align 8
  %t4 = insertelement <4 x double> %t2, double %i0.0.1, i32 1
  %p5 = getelementptr double, ptr %i0.r2, i64 0
  %i0.0.2 = load double, ptr %p5, align 8
  %t6 = insertelement <4 x double> %t4, double %i0.0.2, i32 2
  %p7 = getelementptr double, ptr %i0.r3, i64 0
  %i0.0.3 = load double, ptr %p7, align 8
  %t8 = insertelement <4 x double> %t6, double %i0.0.3, i32 3
  %p9 = getelementptr double, ptr %i0, i64 1
  %i0.1.0 = load double, ptr %p9, align 8
  %t10 = insertelement <4 x double> poison, double %i0.1.0, i32 0
  %p11 = getelementptr double, ptr %i0.r1, i64 1
  %i0.1.1 = load double, ptr %p11, align 8
  %t12 = insertelement <4 x double> %t10, double %i0.1.1, i32 1
  %p13 = getelementptr double, ptr %i0.r2, i64 1
  %i0.1.2 = load double, ptr %p13, align 8
  %t14 = insertelement <4 x double> %t12, double %i0.1.2, i32 2
  %p15 = getelementptr double, ptr %i0.r3, i64 1
  %i0.1.3 = load double, ptr %p15, align 8
  %t16 = insertelement <4 x double> %t14, double %i0.1.3, i32 3
  %p17 = getelementptr double, ptr %i0, i64 2
  %i0.2.0 = load double, ptr %p17, align 8
  %t18 = insertelement <4 x double> poison, double %i0.2.0, i32 0
  %p19 = getelementptr double, ptr %i0.r1, i64 2
  %i0.2.1 = load double, ptr %p19, align 8
  %t20 = insertelement <4 x double> %t18, double %i0.2.1, i32 1
  %p21 = getelementptr double, ptr %i0.r2, i64 2
  %i0.2.2 = load double, ptr %p21, align 8
  %t22 = insertelement <4 x double> %t20, double %i0.2.2, i32 2
  %p23 = getelementptr double, ptr %i0.r3, i64 2
  %i0.2.3 = load double, ptr %p23, align 8
  %t24 = insertelement <4 x double> %t22, double %i0.2.3, i32 3
  %v4 = fmul contract <4 x double> %t24, splat (double 0x4000000000000000)
  %v5 = fmul contract <4 x double> %t16, splat (double 0x4000000000000000)
  %v6 = fmul contract <4 x double> %t8, splat (double 0x4000000000000000)
  %v7 = fadd contract <4 x double> %t8, %v4
  %v8 = fadd contract <4 x double> %t8, %v5
  %v9 = fadd contract <4 x double> %t8, %v6
  %o0.r1 = getelementptr i8, ptr %o0, i64 %o0s
  %o0.r2 = getelementptr i8, ptr %o0.r1, i64 %o0s
  %o0.r3 = getelementptr i8, ptr %o0.r2, i64 %o0s
  %t25 = shufflevector <4 x double> %v7, <4 x double> %v8, <4 x i32> <i32 0, i32 4, i32 1, i32 5>
  %t26 = shufflevector <4 x double> %v7, <4 x double> %v8, <4 x i32> <i32 2, i32 6, i32 3, i32 7>
  %t27 = shufflevector <4 x double> %t25, <4 x double> poison, <2 x i32> <i32 0, i32 1>
  %t28 = shufflevector <4 x double> %t25, <4 x double> poison, <2 x i32> <i32 2, i32 3>
  %t29 = shufflevector <4 x double> %t26, <4 x double> poison, <2 x i32> <i32 0, i32 1>
  %t30 = shufflevector <4 x double> %t26, <4 x double> poison, <2 x i32> <i32 2, i32 3>
  %p31 = getelementptr double, ptr %o0, i64 0
  store <2 x double> %t27, ptr %p31, align 8
  %p32 = getelementptr double, ptr %o0.r1, i64 0
  store <2 x double> %t28, ptr %p32, align 8
  %p33 = getelementptr double, ptr %o0.r2, i64 0
  store <2 x double> %t29, ptr %p33, align 8
  %p34 = getelementptr double, ptr %o0.r3, i64 0
  store <2 x double> %t30, ptr %p34, align 8
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
  %a0.p = getelementptr ptr, ptr %args, i64 0
  %a0 = load ptr, ptr %a0.p
  %s0.p = getelementptr i64, ptr %steps, i64 0
  %s0 = load i64, ptr %s0.p
  %c0.0.p = getelementptr i64, ptr %steps, i64 2
  %c0.0 = load i64, ptr %c0.0.p
  %c0.0.ok = icmp eq i64 %c0.0, 8
  %a1.p = getelementptr ptr, ptr %args, i64 1
  %a1 = load ptr, ptr %a1.p
  %s1.p = getelementptr i64, ptr %steps, i64 1
  %s1 = load i64, ptr %s1.p
  %c1.0.p = getelementptr i64, ptr %steps, i64 3
  %c1.0 = load i64, ptr %c1.0.p
  %c1.0.ok = icmp eq i64 %c1.0, 8
  %ok0 = and i1 true, %c0.0.ok
  %ok1 = and i1 %ok0, %c1.0.ok
  br i1 %ok1, label %dense, label %sparse
dense:
  %many = icmp uge i64 %n, 4
  br i1 %many, label %full, label %few
full:
  %same0 = icmp eq ptr %a0, %a1
  %shared0 = or i1 false, %same0
  %last = sub i64 %n, 4
  br label %step
step:
  %i = phi i64 [ 0, %full ], [ %j, %move ]
  %b.o0 = mul i64 %i, %s0
  %b.r0 = getelementptr i8, ptr %a0, i64 %b.o0
  %b.o1 = mul i64 %i, %s1
  %b.r1 = getelementptr i8, ptr %a1, i64 %b.o1
  call void @block(ptr %b.r0, i64 %s0, ptr %b.r1, i64 %s1)
  %next = add i64 %i, 4
  %end = icmp eq i64 %i, %last
  br i1 %end, label %done, label %more
more:
  %over = icmp ugt i64 %next, %last
  %alone = and i1 %over, %shared0
  br i1 %alone, label %row, label %move
move:
  %j = select i1 %over, i64 %last, i64 %next
  br label %step
few:
  %none = icmp eq i64 %n, 0
  br i1 %none, label %done, label %row
row:
  %k = phi i64 [ 0, %few ], [ %next, %more ], [ %k1, %row ]
  %f.o0 = mul i64 %k, %s0
  %f.r0 = getelementptr i8, ptr %a0, i64 %f.o0
  %f.o1 = mul i64 %k, %s1
  %f.r1 = getelementptr i8, ptr %a1, i64 %f.o1
  call void @block(ptr %f.r0, i64 0, ptr %f.r1, i64 0)
  %k1 = add i64 %k, 1
  %kend = icmp eq i64 %k1, %n
  br i1 %kend, label %done, label %row
sparse:
  %t0 = alloca double, i64 3
  %t1 = alloca double, i64 3
  %empty = icmp eq i64 %n, 0
  br i1 %empty, label %done, label %gather
gather:
  %g = phi i64 [ 0, %sparse ], [ %g1, %scattered ]
  %in0.off = mul i64 %g, %s0
  %in0.at = getelementptr i8, ptr %a0, i64 %in0.off
  br label %in0.h0
in0.h0:
  %in0.k0 = phi i64 [ 0, %gather ], [ %in0.n0, %in0.l0 ]
  %in0.d0 = mul i64 %in0.k0, %c0.0
  %in0.q0 = getelementptr i8, ptr %in0.at, i64 %in0.d0
  %in0.m0 = mul i64 0, 3
  %in0.f0 = add i64 %in0.m0, %in0.k0
  %in0.s = getelementptr double, ptr %t0, i64 %in0.f0
  %in0.v = load double, ptr %in0.q0, align 8
  store double %in0.v, ptr %in0.s, align 8
  br label %in0.l0
in0.l0:
  %in0.n0 = add i64 %in0.k0, 1
  %in0.e0 = icmp eq i64 %in0.n0, 3
  br i1 %in0.e0, label %in0.x0, label %in0.h0
in0.x0:
  call void @block(ptr %t0, i64 0, ptr %t1, i64 0)
  %out1.off = mul i64 %g, %s1
  %out1.at = getelementptr i8, ptr %a1, i64 %out1.off
  br label %out1.h0
out1.h0:
  %out1.k0 = phi i64 [ 0, %in0.x0 ], [ %out1.n0, %out1.l0 ]
  %out1.d0 = mul i64 %out1.k0, %c1.0
  %out1.q0 = getelementptr i8, ptr %out1.at, i64 %out1.d0
  %out1.m0 = mul i64 0, 3
  %out1.f0 = add i64 %out1.m0, %out1.k0
  %out1.s = getelementptr double, ptr %t1, i64 %out1.f0
  %out1.v = load double, ptr %out1.s, align 8
  store double %out1.v, ptr %out1.q0, align 8
  br label %out1.l0
out1.l0:
  %out1.n0 = add i64 %out1.k0, 1
  %out1.e0 = icmp eq i64 %out1.n0, 3
  br i1 %out1.e0, label %out1.x0, label %out1.h0
out1.x0:
  br label %scattered
scattered:
  %g1 = add i64 %g, 1
  %gend = icmp eq i64 %g1, %n
  br i1 %gend, label %done, label %gather
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="256" "min-legal-vector-width"="256" }
