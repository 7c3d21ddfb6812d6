declare i1 @llvm.vector.reduce.or.v8i1(<8 x i1>)
declare i32 @feclearexcept(i32)

define internal void @block(ptr %i0, i64 %i0s, ptr %o0, i64 %o0s, ptr %o1, i64 %o1s) noinline nounwind #0 {
entry:
  %i0.r1 = getelementptr i8, ptr %i0, i64 %i0s
  %i0.r2 = getelementptr i8, ptr %i0.r1, i64 %i0s
  %i0.r3 = getelementptr i8, ptr %i0.r2, i64 %i0s
  %i0.r4 = getelementptr i8, ptr %i0.r3, i64 %i0s
  %i0.r5 = getelementptr i8, ptr %i0.r4, i64 %i0s
  %i0.r6 = getelementptr i8, ptr %i0.r5, i64 %i0s
  %i0.r7 = getelementptr i8, ptr %i0.r6, i64 %i0s
  %p1 = getelementptr double, ptr %i0, i64 0
  %w2 = load double, ptr %p1, align 8
  %p3 = getelementptr double, ptr %i0.r1, i64 0
  %w4 = load double, ptr %p3, align 8
  %p5 = getelementptr double, ptr %i0.r2, i64 0
  %w6 = load double, ptr %p5, align 8
  %p7 = getelementptr double, ptr %i0.r3, i64 0
  %w8 = load double, ptr %p7, align 8
  %p9 = getelementptr double, ptr %i0.r4, i64 0
  %w10 = load double, ptr %p9, align 8
  %p11 = getelementptr double, ptr %i0.r5, i64 0
  %w12 = load double, ptr %p11, align 8
  %p13 = getelementptr double, ptr %i0.r6, i64 0
  %w14 = load double, ptr %p13, align 8
  %p15 = getelementptr double, ptr %i0.r7, i64 0
  %w16 = load double, ptr %p15, align 8
  %t17 = insertelement <8 x double> poison, double %w2, i32 0
  %t18 = insertelement <8 x double> %t17, double %w4, i32 1
  %t19 = insertelement <8 x double> %t18, double %w6, i32 2
  %t20 = insertelement <8 x double> %t19, double %w8, i32 3
  %t21 = insertelement <8 x double> %t20, double %w10, i32 4
  %t22 = insertelement <8 x double> %t21, double %w12, i32 5
  %t23 = insertelement <8 x double> %t22, double %w14, i32 6
  %t24 = insertelement <8 x double> %t23, double %w16, i32 7
  br label %L2.head
L2.head:
  %L2.n = phi i64 [ 0, %entry ], [ %L2.n1, %L2.body ]
  %L2.alive = phi <8 x i1> [ splat (i1 true), %entry ], [ %L2.active, %L2.body ]
  %L2.x0 = phi <8 x double> [ %t24, %entry ], [ %L2.y0, %L2.body ]
  %L2.x1 = phi <8 x double> [ splat (double 0x0000000000000000), %entry ], [ %L2.y1, %L2.body ]
  %L2.v7 = fcmp olt <8 x double> splat (double 0x3FF0000000000000), %L2.x0
  %L2.active = and <8 x i1> %L2.alive, %L2.v7
  %L2.any = call i1 @llvm.vector.reduce.or.v8i1(<8 x i1> %L2.active)
  %L2.more = icmp ult i64 %L2.n, 20
  %L2.go = and i1 %L2.any, %L2.more
  br i1 %L2.go, label %L2.body, label %L2.after
L2.body:
  %L2.v3 = fmul contract <8 x double> %L2.x0, splat (double 0x3FE0000000000000)
  %L2.v5 = fadd contract <8 x double> %L2.x1, %t24
  %L2.y0 = select <8 x i1> %L2.active, <8 x double> %L2.v3, <8 x double> %L2.x0
  %L2.y1 = select <8 x i1> %L2.active, <8 x double> %L2.v5, <8 x double> %L2.x1
  %L2.n1 = add i64 %L2.n, 1
  br label %L2.head
L2.after:
  %o0.r1 = getelementptr i8, ptr %o0, i64 %o0s
  %o0.r2 = getelementptr i8, ptr %o0.r1, i64 %o0s
  %o0.r3 = getelementptr i8, ptr %o0.r2, i64 %o0s
  %o0.r4 = getelementptr i8, ptr %o0.r3, i64 %o0s
  %o0.r5 = getelementptr i8, ptr %o0.r4, i64 %o0s
  %o0.r6 = getelementptr i8, ptr %o0.r5, i64 %o0s
  %o0.r7 = getelementptr i8, ptr %o0.r6, i64 %o0s
  %t25 = extractelement <8 x double> %L2.x0, i32 0
  %t26 = extractelement <8 x double> %L2.x0, i32 1
  %t27 = extractelement <8 x double> %L2.x0, i32 2
  %t28 = extractelement <8 x double> %L2.x0, i32 3
  %t29 = extractelement <8 x double> %L2.x0, i32 4
  %t30 = extractelement <8 x double> %L2.x0, i32 5
  %t31 = extractelement <8 x double> %L2.x0, i32 6
  %t32 = extractelement <8 x double> %L2.x0, i32 7
  %p33 = getelementptr double, ptr %o0, i64 0
  store double %t25, ptr %p33, align 8
  %p34 = getelementptr double, ptr %o0.r1, i64 0
  store double %t26, ptr %p34, align 8
  %p35 = getelementptr double, ptr %o0.r2, i64 0
  store double %t27, ptr %p35, align 8
  %p36 = getelementptr double, ptr %o0.r3, i64 0
  store double %t28, ptr %p36, align 8
  %p37 = getelementptr double, ptr %o0.r4, i64 0
  store double %t29, ptr %p37, align 8
  %p38 = getelementptr double, ptr %o0.r5, i64 0
  store double %t30, ptr %p38, align 8
  %p39 = getelementptr double, ptr %o0.r6, i64 0
  store double %t31, ptr %p39, align 8
  %p40 = getelementptr double, ptr %o0.r7, i64 0
  store double %t32, ptr %p40, align 8
  %o1.r1 = getelementptr i8, ptr %o1, i64 %o1s
  %o1.r2 = getelementptr i8, ptr %o1.r1, i64 %o1s
  %o1.r3 = getelementptr i8, ptr %o1.r2, i64 %o1s
  %o1.r4 = getelementptr i8, ptr %o1.r3, i64 %o1s
  %o1.r5 = getelementptr i8, ptr %o1.r4, i64 %o1s
  %o1.r6 = getelementptr i8, ptr %o1.r5, i64 %o1s
  %o1.r7 = getelementptr i8, ptr %o1.r6, i64 %o1s
  %t41 = extractelement <8 x double> %L2.x1, i32 0
  %t42 = extractelement <8 x double> %L2.x1, i32 1
  %t43 = extractelement <8 x double> %L2.x1, i32 2
  %t44 = extractelement <8 x double> %L2.x1, i32 3
  %t45 = extractelement <8 x double> %L2.x1, i32 4
  %t46 = extractelement <8 x double> %L2.x1, i32 5
  %t47 = extractelement <8 x double> %L2.x1, i32 6
  %t48 = extractelement <8 x double> %L2.x1, i32 7
  %p49 = getelementptr double, ptr %o1, i64 0
  store double %t41, ptr %p49, align 8
  %p50 = getelementptr double, ptr %o1.r1, i64 0
  store double %t42, ptr %p50, align 8
  %p51 = getelementptr double, ptr %o1.r2, i64 0
  store double %t43, ptr %p51, align 8
  %p52 = getelementptr double, ptr %o1.r3, i64 0
  store double %t44, ptr %p52, align 8
  %p53 = getelementptr double, ptr %o1.r4, i64 0
  store double %t45, ptr %p53, align 8
  %p54 = getelementptr double, ptr %o1.r5, i64 0
  store double %t46, ptr %p54, align 8
  %p55 = getelementptr double, ptr %o1.r6, i64 0
  store double %t47, ptr %p55, align 8
  %p56 = getelementptr double, ptr %o1.r7, i64 0
  store double %t48, ptr %p56, align 8
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
  %dense0 = xor i1 false, true
  %t0 = alloca double, i64 8
  %a1.p = getelementptr ptr, ptr %args, i64 1
  %a1 = load ptr, ptr %a1.p
  %s1.p = getelementptr i64, ptr %steps, i64 1
  %s1 = load i64, ptr %s1.p
  %dense1 = xor i1 false, true
  %t1 = alloca double, i64 8
  %a2.p = getelementptr ptr, ptr %args, i64 2
  %a2 = load ptr, ptr %a2.p
  %s2.p = getelementptr i64, ptr %steps, i64 2
  %s2 = load i64, ptr %s2.p
  %dense2 = xor i1 false, true
  %t2 = alloca double, i64 8
  %none = icmp eq i64 %n, 0
  br i1 %none, label %done, label %step
step:
  %i = phi i64 [ 0, %entry ], [ %next, %put3 ]
  %left = sub i64 %n, %i
  %many = icmp uge i64 %left, 8
  %single = icmp eq i64 %left, 1
  %rows = select i1 %single, i64 1, i64 8
  %short = select i1 %single, i64 1, i64 %left
  %simple = or i1 %many, %single
  %count = select i1 %many, i64 8, i64 %short
  %direct0 = and i1 %dense0, %simple
  %direct1 = and i1 %dense1, %simple
  %direct2 = and i1 %dense2, %simple
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
  %get0.s = getelementptr double, ptr %t0, i64 %get0.row.k
  %get0.v = load double, ptr %get0.row.p, align 8
  store double %get0.v, ptr %get0.s, align 8
  br label %get0.row.end
get0.row.end:
  %get0.row.n = add i64 %get0.row.k, 1
  %get0.row.over = icmp eq i64 %get0.row.n, %rows
  br i1 %get0.row.over, label %get1, label %get0.row
get1:
  %o0 = mul i64 %i, %s0
  %p0 = getelementptr i8, ptr %a0, i64 %o0
  %r0 = select i1 %direct0, ptr %p0, ptr %t0
  %d0 = select i1 %direct0, i64 %s0, i64 8
  %e0 = select i1 %single, i64 0, i64 %d0
  %o1 = mul i64 %i, %s1
  %p1 = getelementptr i8, ptr %a1, i64 %o1
  %r1 = select i1 %direct1, ptr %p1, ptr %t1
  %d1 = select i1 %direct1, i64 %s1, i64 8
  %e1 = select i1 %single, i64 0, i64 %d1
  %o2 = mul i64 %i, %s2
  %p2 = getelementptr i8, ptr %a2, i64 %o2
  %r2 = select i1 %direct2, ptr %p2, ptr %t2
  %d2 = select i1 %direct2, i64 %s2, i64 8
  %e2 = select i1 %single, i64 0, i64 %d2
  call void @block(ptr %r0, i64 %e0, ptr %r1, i64 %e1, ptr %r2, i64 %e2)
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
  %put1.s = getelementptr double, ptr %t1, i64 %put1.row.k
  %put1.v = load double, ptr %put1.s, align 8
  store double %put1.v, ptr %put1.row.p, align 8
  br label %put1.row.end
put1.row.end:
  %put1.row.n = add i64 %put1.row.k, 1
  %put1.row.over = icmp eq i64 %put1.row.n, %count
  br i1 %put1.row.over, label %put2, label %put1.row
put2:
  br i1 %direct2, label %put3, label %put2.row
put2.row:
  %put2.row.k = phi i64 [ 0, %put2 ], [ %put2.row.n, %put2.row.end ]
  %put2.row.here = add i64 %i, %put2.row.k
  %put2.row.beyond = icmp ugt i64 %put2.row.here, %last
  %put2.row.at = select i1 %put2.row.beyond, i64 %last, i64 %put2.row.here
  %put2.row.o = mul i64 %put2.row.at, %s2
  %put2.row.p = getelementptr i8, ptr %a2, i64 %put2.row.o
  %put2.s = getelementptr double, ptr %t2, i64 %put2.row.k
  %put2.v = load double, ptr %put2.s, align 8
  store double %put2.v, ptr %put2.row.p, align 8
  br label %put2.row.end
put2.row.end:
  %put2.row.n = add i64 %put2.row.k, 1
  %put2.row.over = icmp eq i64 %put2.row.n, %count
  br i1 %put2.row.over, label %put3, label %put2.row
put3:
  %next = add i64 %i, %count
  %end = icmp eq i64 %next, %n
  br i1 %end, label %done, label %step
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="512" "min-legal-vector-width"="512" "stackrealign" }
