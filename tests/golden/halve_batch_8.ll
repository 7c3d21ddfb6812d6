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
  %i0.0.0 = load double, ptr %p1, align 8
  %t2 = insertelement <8 x double> poison, double %i0.0.0, i32 0
  %p3 = getelementptr double, ptr %i0.r1, i64 0
  %i0.0.1 = load double, ptr %p3, align 8
  %t4 = insertelement <8 x double> %t2, double %i0.0.1, i32 1
  %p5 = getelementptr double, ptr %i0.r2, i64 0
  %i0.0.2 = load double, ptr %p5, align 8
  %t6 = insertelement <8 x double> %t4, double %i0.0.2, i32 2
  %p7 = getelementptr double, ptr %i0.r3, i64 0
  %i0.0.3 = load double, ptr %p7, align 8
  %t8 = insertelement <8 x double> %t6, double %i0.0.3, i32 3
  %p9 = getelementptr double, ptr %i0.r4, i64 0
  %i0.0.4 = load double, ptr %p9, align 8
  %t10 = insertelement <8 x double> %t8, double %i0.0.4, i32 4
  %p11 = getelementptr double, ptr %i0.r5, i64 0
  %i0.0.5 = load double, ptr %p11, align 8
  %t12 = insertelement <8 x double> %t10, double %i0.0.5, i32 5
  %p13 = getelementptr double, ptr %i0.r6, i64 0
  %i0.0.6 = load double, ptr %p13, align 8
  %t14 = insertelement <8 x double> %t12, double %i0.0.6, i32 6
  %p15 = getelementptr double, ptr %i0.r7, i64 0
  %i0.0.7 = load double, ptr %p15, align 8
  %t16 = insertelement <8 x double> %t14, double %i0.0.7, i32 7
  br label %L2.head
L2.head:
  %L2.n = phi i64 [ 0, %entry ], [ %L2.n1, %L2.body ]
  %L2.alive = phi <8 x i1> [ splat (i1 true), %entry ], [ %L2.active, %L2.body ]
  %L2.x0 = phi <8 x double> [ %t16, %entry ], [ %L2.y0, %L2.body ]
  %L2.x1 = phi <8 x double> [ splat (double 0x0000000000000000), %entry ], [ %L2.y1, %L2.body ]
  %L2.v7 = fcmp olt <8 x double> splat (double 0x3FF0000000000000), %L2.x0
  %L2.active = and <8 x i1> %L2.alive, %L2.v7
  %L2.any = call i1 @llvm.vector.reduce.or.v8i1(<8 x i1> %L2.active)
  %L2.more = icmp ult i64 %L2.n, 20
  %L2.go = and i1 %L2.any, %L2.more
  br i1 %L2.go, label %L2.body, label %L2.after
L2.body:
  %L2.v3 = fmul contract <8 x double> %L2.x0, splat (double 0x3FE0000000000000)
  %L2.v5 = fadd contract <8 x double> %L2.x1, %t16
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
  %t17 = extractelement <8 x double> %L2.x0, i32 0
  %t18 = extractelement <8 x double> %L2.x0, i32 1
  %t19 = extractelement <8 x double> %L2.x0, i32 2
  %t20 = extractelement <8 x double> %L2.x0, i32 3
  %t21 = extractelement <8 x double> %L2.x0, i32 4
  %t22 = extractelement <8 x double> %L2.x0, i32 5
  %t23 = extractelement <8 x double> %L2.x0, i32 6
  %t24 = extractelement <8 x double> %L2.x0, i32 7
  %p25 = getelementptr double, ptr %o0, i64 0
  store double %t17, ptr %p25, align 8
  %p26 = getelementptr double, ptr %o0.r1, i64 0
  store double %t18, ptr %p26, align 8
  %p27 = getelementptr double, ptr %o0.r2, i64 0
  store double %t19, ptr %p27, align 8
  %p28 = getelementptr double, ptr %o0.r3, i64 0
  store double %t20, ptr %p28, align 8
  %p29 = getelementptr double, ptr %o0.r4, i64 0
  store double %t21, ptr %p29, align 8
  %p30 = getelementptr double, ptr %o0.r5, i64 0
  store double %t22, ptr %p30, align 8
  %p31 = getelementptr double, ptr %o0.r6, i64 0
  store double %t23, ptr %p31, align 8
  %p32 = getelementptr double, ptr %o0.r7, i64 0
  store double %t24, ptr %p32, align 8
  %o1.r1 = getelementptr i8, ptr %o1, i64 %o1s
  %o1.r2 = getelementptr i8, ptr %o1.r1, i64 %o1s
  %o1.r3 = getelementptr i8, ptr %o1.r2, i64 %o1s
  %o1.r4 = getelementptr i8, ptr %o1.r3, i64 %o1s
  %o1.r5 = getelementptr i8, ptr %o1.r4, i64 %o1s
  %o1.r6 = getelementptr i8, ptr %o1.r5, i64 %o1s
  %o1.r7 = getelementptr i8, ptr %o1.r6, i64 %o1s
  %t33 = extractelement <8 x double> %L2.x1, i32 0
  %t34 = extractelement <8 x double> %L2.x1, i32 1
  %t35 = extractelement <8 x double> %L2.x1, i32 2
  %t36 = extractelement <8 x double> %L2.x1, i32 3
  %t37 = extractelement <8 x double> %L2.x1, i32 4
  %t38 = extractelement <8 x double> %L2.x1, i32 5
  %t39 = extractelement <8 x double> %L2.x1, i32 6
  %t40 = extractelement <8 x double> %L2.x1, i32 7
  %p41 = getelementptr double, ptr %o1, i64 0
  store double %t33, ptr %p41, align 8
  %p42 = getelementptr double, ptr %o1.r1, i64 0
  store double %t34, ptr %p42, align 8
  %p43 = getelementptr double, ptr %o1.r2, i64 0
  store double %t35, ptr %p43, align 8
  %p44 = getelementptr double, ptr %o1.r3, i64 0
  store double %t36, ptr %p44, align 8
  %p45 = getelementptr double, ptr %o1.r4, i64 0
  store double %t37, ptr %p45, align 8
  %p46 = getelementptr double, ptr %o1.r5, i64 0
  store double %t38, ptr %p46, align 8
  %p47 = getelementptr double, ptr %o1.r6, i64 0
  store double %t39, ptr %p47, align 8
  %p48 = getelementptr double, ptr %o1.r7, i64 0
  store double %t40, ptr %p48, align 8
  ret void
}

define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {
entry:
  %n = load i64, ptr %dims
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
  %shared.0 = icmp eq ptr %a0, %a1
  %shared.or0 = or i1 false, %shared.0
  %shared.1 = icmp eq ptr %a0, %a2
  %shared.or1 = or i1 %shared.or0, %shared.1
  %last = sub i64 %n, 8
  %enough = icmp uge i64 %n, 8
  %none = icmp eq i64 %n, 0
  br i1 %none, label %done, label %step
step:
  %i = phi i64 [ 0, %entry ], [ %j, %again ]
  %wide = phi i1 [ %enough, %entry ], [ %still, %again ]
  %count = select i1 %wide, i64 8, i64 1
  br label %get0
get0:
  br i1 %dense0, label %get1, label %get0.row
get0.row:
  %get0.row.k = phi i64 [ 0, %get0 ], [ %get0.row.n, %get0.row.end ]
  %get0.row.at = add i64 %i, %get0.row.k
  %get0.row.o = mul i64 %get0.row.at, %s0
  %get0.row.p = getelementptr i8, ptr %a0, i64 %get0.row.o
  %get0.s = getelementptr double, ptr %t0, i64 %get0.row.k
  %get0.v = load double, ptr %get0.row.p, align 8
  store double %get0.v, ptr %get0.s, align 8
  br label %get0.row.end
get0.row.end:
  %get0.row.n = add i64 %get0.row.k, 1
  %get0.row.over = icmp eq i64 %get0.row.n, %count
  br i1 %get0.row.over, label %get1, label %get0.row
get1:
  %o0 = mul i64 %i, %s0
  %p0 = getelementptr i8, ptr %a0, i64 %o0
  %r0 = select i1 %dense0, ptr %p0, ptr %t0
  %d0 = select i1 %dense0, i64 %s0, i64 8
  %e0 = select i1 %wide, i64 %d0, i64 0
  %o1 = mul i64 %i, %s1
  %p1 = getelementptr i8, ptr %a1, i64 %o1
  %r1 = select i1 %dense1, ptr %p1, ptr %t1
  %d1 = select i1 %dense1, i64 %s1, i64 8
  %e1 = select i1 %wide, i64 %d1, i64 0
  %o2 = mul i64 %i, %s2
  %p2 = getelementptr i8, ptr %a2, i64 %o2
  %r2 = select i1 %dense2, ptr %p2, ptr %t2
  %d2 = select i1 %dense2, i64 %s2, i64 8
  %e2 = select i1 %wide, i64 %d2, i64 0
  call void @block(ptr %r0, i64 %e0, ptr %r1, i64 %e1, ptr %r2, i64 %e2)
  br label %put1
put1:
  br i1 %dense1, label %put2, label %put1.row
put1.row:
  %put1.row.k = phi i64 [ 0, %put1 ], [ %put1.row.n, %put1.row.end ]
  %put1.row.at = add i64 %i, %put1.row.k
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
  br i1 %dense2, label %put3, label %put2.row
put2.row:
  %put2.row.k = phi i64 [ 0, %put2 ], [ %put2.row.n, %put2.row.end ]
  %put2.row.at = add i64 %i, %put2.row.k
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
  %left = sub i64 %n, %next
  %end = icmp eq i64 %left, 0
  br i1 %end, label %done, label %again
again:
  %fits = icmp uge i64 %left, 8
  %free = xor i1 %shared.or1, true
  %may = or i1 %fits, %free
  %still = and i1 %wide, %may
  %short = xor i1 %fits, true
  %back = and i1 %still, %short
  %j = select i1 %back, i64 %last, i64 %next
  br label %step
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="512" "min-legal-vector-width"="512" }
