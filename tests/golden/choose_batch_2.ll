declare <2 x double> @llvm.sqrt.v2f64(<2 x double>)
declare <2 x double> @llvm.fabs.v2f64(<2 x double>)
declare <2 x double> @llvm.minimum.v2f64(<2 x double>, <2 x double>)
declare i32 @feclearexcept(i32)

define internal void @block(ptr %i0, i64 %i0s, ptr %i1, i64 %i1s, ptr %o0, i64 %o0s, ptr %o1, i64 %o1s) noinline nounwind #0 {
entry:
  %i0.r1 = getelementptr i8, ptr %i0, i64 %i0s
  %p1 = getelementptr double, ptr %i0, i64 0
  %i0.0.0 = load double, ptr %p1, align 8
  %t2 = insertelement <2 x double> poison, double %i0.0.0, i32 0
  %p3 = getelementptr double, ptr %i0.r1, i64 0
  %i0.0.1 = load double, ptr %p3, align 8
  %t4 = insertelement <2 x double> %t2, double %i0.0.1, i32 1
  %i1.r1 = getelementptr i8, ptr %i1, i64 %i1s
  %p5 = getelementptr double, ptr %i1, i64 0
  %i1.0.0 = load double, ptr %p5, align 8
  %t6 = insertelement <2 x double> poison, double %i1.0.0, i32 0
  %p7 = getelementptr double, ptr %i1.r1, i64 0
  %i1.0.1 = load double, ptr %p7, align 8
  %t8 = insertelement <2 x double> %t6, double %i1.0.1, i32 1
  %v2 = fcmp olt <2 x double> %t4, %t8
  %v4 = fcmp oeq <2 x double> %t8, splat (double 0x0000000000000000)
  %v5 = xor <2 x i1> %v4, splat (i1 true)
  %v6 = and <2 x i1> %v2, %v5
  %v7 = call <2 x double> @llvm.sqrt.v2f64(<2 x double> %t4)
  %v8 = call <2 x double> @llvm.fabs.v2f64(<2 x double> %t4)
  %v9 = call <2 x double> @llvm.minimum.v2f64(<2 x double> %t8, <2 x double> %v8)
  %v10 = select <2 x i1> %v6, <2 x double> %v7, <2 x double> %v9
  %o0.r1 = getelementptr i8, ptr %o0, i64 %o0s
  %t9 = extractelement <2 x double> %v10, i32 0
  %t10 = extractelement <2 x double> %v10, i32 1
  %p11 = getelementptr double, ptr %o0, i64 0
  store double %t9, ptr %p11, align 8
  %p12 = getelementptr double, ptr %o0.r1, i64 0
  store double %t10, ptr %p12, align 8
  %o1.r1 = getelementptr i8, ptr %o1, i64 %o1s
  %t13 = extractelement <2 x double> %t8, i32 0
  %t14 = extractelement <2 x double> %t8, i32 1
  %p15 = getelementptr double, ptr %o1, i64 0
  store double %t13, ptr %p15, align 8
  %p16 = getelementptr double, ptr %o1.r1, i64 0
  store double %t14, ptr %p16, align 8
  ret void
}

define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {
entry:
  %n = load i64, ptr %dims
  %a0.p = getelementptr ptr, ptr %args, i64 0
  %a0 = load ptr, ptr %a0.p
  %s0.p = getelementptr i64, ptr %steps, i64 0
  %s0 = load i64, ptr %s0.p
  %a1.p = getelementptr ptr, ptr %args, i64 1
  %a1 = load ptr, ptr %a1.p
  %s1.p = getelementptr i64, ptr %steps, i64 1
  %s1 = load i64, ptr %s1.p
  %a2.p = getelementptr ptr, ptr %args, i64 2
  %a2 = load ptr, ptr %a2.p
  %s2.p = getelementptr i64, ptr %steps, i64 2
  %s2 = load i64, ptr %s2.p
  %a3.p = getelementptr ptr, ptr %args, i64 3
  %a3 = load ptr, ptr %a3.p
  %s3.p = getelementptr i64, ptr %steps, i64 3
  %s3 = load i64, ptr %s3.p
  br i1 true, label %dense, label %sparse
dense:
  %many = icmp uge i64 %n, 2
  br i1 %many, label %full, label %few
full:
  %same0 = icmp eq ptr %a0, %a2
  %shared0 = or i1 false, %same0
  %same1 = icmp eq ptr %a0, %a3
  %shared1 = or i1 %shared0, %same1
  %same2 = icmp eq ptr %a1, %a2
  %shared2 = or i1 %shared1, %same2
  %same3 = icmp eq ptr %a1, %a3
  %shared3 = or i1 %shared2, %same3
  %last = sub i64 %n, 2
  br label %step
step:
  %i = phi i64 [ 0, %full ], [ %j, %move ]
  %b.o0 = mul i64 %i, %s0
  %b.r0 = getelementptr i8, ptr %a0, i64 %b.o0
  %b.o1 = mul i64 %i, %s1
  %b.r1 = getelementptr i8, ptr %a1, i64 %b.o1
  %b.o2 = mul i64 %i, %s2
  %b.r2 = getelementptr i8, ptr %a2, i64 %b.o2
  %b.o3 = mul i64 %i, %s3
  %b.r3 = getelementptr i8, ptr %a3, i64 %b.o3
  call void @block(ptr %b.r0, i64 %s0, ptr %b.r1, i64 %s1, ptr %b.r2, i64 %s2, ptr %b.r3, i64 %s3)
  %next = add i64 %i, 2
  %end = icmp eq i64 %i, %last
  br i1 %end, label %done, label %more
more:
  %over = icmp ugt i64 %next, %last
  %alone = and i1 %over, %shared3
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
  %f.o2 = mul i64 %k, %s2
  %f.r2 = getelementptr i8, ptr %a2, i64 %f.o2
  %f.o3 = mul i64 %k, %s3
  %f.r3 = getelementptr i8, ptr %a3, i64 %f.o3
  call void @block(ptr %f.r0, i64 0, ptr %f.r1, i64 0, ptr %f.r2, i64 0, ptr %f.r3, i64 0)
  %k1 = add i64 %k, 1
  %kend = icmp eq i64 %k1, %n
  br i1 %kend, label %done, label %row
sparse:
  %t0 = alloca double, i64 1
  %t1 = alloca double, i64 1
  %t2 = alloca double, i64 1
  %t3 = alloca double, i64 1
  %empty = icmp eq i64 %n, 0
  br i1 %empty, label %done, label %gather
gather:
  %g = phi i64 [ 0, %sparse ], [ %g1, %scattered ]
  %in0.off = mul i64 %g, %s0
  %in0.at = getelementptr i8, ptr %a0, i64 %in0.off
  %in0.s = getelementptr double, ptr %t0, i64 0
  %in0.v = load double, ptr %in0.at, align 8
  store double %in0.v, ptr %in0.s, align 8
  %in1.off = mul i64 %g, %s1
  %in1.at = getelementptr i8, ptr %a1, i64 %in1.off
  %in1.s = getelementptr double, ptr %t1, i64 0
  %in1.v = load double, ptr %in1.at, align 8
  store double %in1.v, ptr %in1.s, align 8
  call void @block(ptr %t0, i64 0, ptr %t1, i64 0, ptr %t2, i64 0, ptr %t3, i64 0)
  %out2.off = mul i64 %g, %s2
  %out2.at = getelementptr i8, ptr %a2, i64 %out2.off
  %out2.s = getelementptr double, ptr %t2, i64 0
  %out2.v = load double, ptr %out2.s, align 8
  store double %out2.v, ptr %out2.at, align 8
  %out3.off = mul i64 %g, %s3
  %out3.at = getelementptr i8, ptr %a3, i64 %out3.off
  %out3.s = getelementptr double, ptr %t3, i64 0
  %out3.v = load double, ptr %out3.s, align 8
  store double %out3.v, ptr %out3.at, align 8
  br label %scattered
scattered:
  %g1 = add i64 %g, 1
  %gend = icmp eq i64 %g1, %n
  br i1 %gend, label %done, label %gather
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="128" "min-legal-vector-width"="128" }
