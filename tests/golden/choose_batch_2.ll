declare <2 x double> @llvm.sqrt.v2f64(<2 x double>)
declare <2 x double> @llvm.fabs.v2f64(<2 x double>)
declare <2 x double> @llvm.minimum.v2f64(<2 x double>, <2 x double>)
declare i32 @feclearexcept(i32)

define internal void @block(ptr %i0, i64 %i0s, ptr %i1, i64 %i1s, ptr %o0, i64 %o0s, ptr %o1, i64 %o1s) noinline nounwind #0 {
entry:
  %i0.r1 = getelementptr i8, ptr %i0, i64 %i0s
  %p1 = getelementptr double, ptr %i0, i64 0
  %w2 = load double, ptr %p1, align 8
  %p3 = getelementptr double, ptr %i0.r1, i64 0
  %w4 = load double, ptr %p3, align 8
  %t5 = insertelement <2 x double> poison, double %w2, i32 0
  %t6 = insertelement <2 x double> %t5, double %w4, i32 1
  %i1.r1 = getelementptr i8, ptr %i1, i64 %i1s
  %p7 = getelementptr double, ptr %i1, i64 0
  %w8 = load double, ptr %p7, align 8
  %p9 = getelementptr double, ptr %i1.r1, i64 0
  %w10 = load double, ptr %p9, align 8
  %t11 = insertelement <2 x double> poison, double %w8, i32 0
  %t12 = insertelement <2 x double> %t11, double %w10, i32 1
  %o1.r1 = getelementptr i8, ptr %o1, i64 %o1s
  %t13 = extractelement <2 x double> %t12, i32 0
  %t14 = extractelement <2 x double> %t12, i32 1
  %p15 = getelementptr double, ptr %o1, i64 0
  store double %t13, ptr %p15, align 8
  %p16 = getelementptr double, ptr %o1.r1, i64 0
  store double %t14, ptr %p16, align 8
  %v2 = fcmp olt <2 x double> %t6, %t12
  %v4 = fcmp oeq <2 x double> %t12, splat (double 0x0000000000000000)
  %v5 = xor <2 x i1> %v4, splat (i1 true)
  %v6 = and <2 x i1> %v2, %v5
  %v7 = call <2 x double> @llvm.sqrt.v2f64(<2 x double> %t6)
  %v8 = call <2 x double> @llvm.fabs.v2f64(<2 x double> %t6)
  %v9 = call <2 x double> @llvm.minimum.v2f64(<2 x double> %t12, <2 x double> %v8)
  %v10 = select <2 x i1> %v6, <2 x double> %v7, <2 x double> %v9
  %o0.r1 = getelementptr i8, ptr %o0, i64 %o0s
  %t17 = extractelement <2 x double> %v10, i32 0
  %t18 = extractelement <2 x double> %v10, i32 1
  %p19 = getelementptr double, ptr %o0, i64 0
  store double %t17, ptr %p19, align 8
  %p20 = getelementptr double, ptr %o0.r1, i64 0
  store double %t18, ptr %p20, align 8
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
  %t0 = alloca double, i64 2
  %a1.p = getelementptr ptr, ptr %args, i64 1
  %a1 = load ptr, ptr %a1.p
  %s1.p = getelementptr i64, ptr %steps, i64 1
  %s1 = load i64, ptr %s1.p
  %dense1 = xor i1 false, true
  %t1 = alloca double, i64 2
  %a2.p = getelementptr ptr, ptr %args, i64 2
  %a2 = load ptr, ptr %a2.p
  %s2.p = getelementptr i64, ptr %steps, i64 2
  %s2 = load i64, ptr %s2.p
  %dense2 = xor i1 false, true
  %t2 = alloca double, i64 2
  %a3.p = getelementptr ptr, ptr %args, i64 3
  %a3 = load ptr, ptr %a3.p
  %s3.p = getelementptr i64, ptr %steps, i64 3
  %s3 = load i64, ptr %s3.p
  %dense3 = xor i1 false, true
  %t3 = alloca double, i64 2
  %none = icmp eq i64 %n, 0
  br i1 %none, label %done, label %step
step:
  %i = phi i64 [ 0, %entry ], [ %next, %put4 ]
  %left = sub i64 %n, %i
  %many = icmp uge i64 %left, 2
  %single = icmp eq i64 %left, 1
  %rows = select i1 %single, i64 1, i64 2
  %short = select i1 %single, i64 1, i64 %left
  %simple = or i1 %many, %single
  %count = select i1 %many, i64 2, i64 %short
  %direct0 = and i1 %dense0, %simple
  %direct1 = and i1 %dense1, %simple
  %direct2 = and i1 %dense2, %simple
  %direct3 = and i1 %dense3, %simple
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
  br i1 %direct1, label %get2, label %get1.row
get1.row:
  %get1.row.k = phi i64 [ 0, %get1 ], [ %get1.row.n, %get1.row.end ]
  %get1.row.here = add i64 %i, %get1.row.k
  %get1.row.beyond = icmp ugt i64 %get1.row.here, %last
  %get1.row.at = select i1 %get1.row.beyond, i64 %last, i64 %get1.row.here
  %get1.row.o = mul i64 %get1.row.at, %s1
  %get1.row.p = getelementptr i8, ptr %a1, i64 %get1.row.o
  %get1.s = getelementptr double, ptr %t1, i64 %get1.row.k
  %get1.v = load double, ptr %get1.row.p, align 8
  store double %get1.v, ptr %get1.s, align 8
  br label %get1.row.end
get1.row.end:
  %get1.row.n = add i64 %get1.row.k, 1
  %get1.row.over = icmp eq i64 %get1.row.n, %rows
  br i1 %get1.row.over, label %get2, label %get1.row
get2:
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
  %o3 = mul i64 %i, %s3
  %p3 = getelementptr i8, ptr %a3, i64 %o3
  %r3 = select i1 %direct3, ptr %p3, ptr %t3
  %d3 = select i1 %direct3, i64 %s3, i64 8
  %e3 = select i1 %single, i64 0, i64 %d3
  call void @block(ptr %r0, i64 %e0, ptr %r1, i64 %e1, ptr %r2, i64 %e2, ptr %r3, i64 %e3)
  br label %put2
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
  br i1 %direct3, label %put4, label %put3.row
put3.row:
  %put3.row.k = phi i64 [ 0, %put3 ], [ %put3.row.n, %put3.row.end ]
  %put3.row.here = add i64 %i, %put3.row.k
  %put3.row.beyond = icmp ugt i64 %put3.row.here, %last
  %put3.row.at = select i1 %put3.row.beyond, i64 %last, i64 %put3.row.here
  %put3.row.o = mul i64 %put3.row.at, %s3
  %put3.row.p = getelementptr i8, ptr %a3, i64 %put3.row.o
  %put3.s = getelementptr double, ptr %t3, i64 %put3.row.k
  %put3.v = load double, ptr %put3.s, align 8
  store double %put3.v, ptr %put3.row.p, align 8
  br label %put3.row.end
put3.row.end:
  %put3.row.n = add i64 %put3.row.k, 1
  %put3.row.over = icmp eq i64 %put3.row.n, %count
  br i1 %put3.row.over, label %put4, label %put3.row
put4:
  %next = add i64 %i, %count
  %end = icmp eq i64 %next, %n
  br i1 %end, label %done, label %step
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="128" "min-legal-vector-width"="128" "stackrealign" }
