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

define internal ptr @ulna.copy.rows.axis(ptr %s, ptr %p, ptr %steps, ptr %axes, i1 %out) noinline cold nounwind {
entry:
  %size = load i64, ptr %axes
  %at.p = getelementptr i64, ptr %axes, i64 1
  %at = load i64, ptr %at.p
  %stride.p = getelementptr i64, ptr %steps, i64 %at
  %stride = load i64, ptr %stride.p
  %inner = getelementptr i64, ptr %axes, i64 2
  %inner.size = load i64, ptr %inner
  %is.last = icmp eq i64 %inner.size, 0
  br i1 %is.last, label %numbers, label %more
numbers:
  %from = select i1 %out, ptr %s, ptr %p
  %to = select i1 %out, ptr %p, ptr %s
  %from.stride = select i1 %out, i64 8, i64 %stride
  %to.stride = select i1 %out, i64 %stride, i64 8
  %beyond = getelementptr double, ptr %s, i64 %size
  br label %number
number:
  %j = phi i64 [ %size, %numbers ], [ %j.n, %number ]
  %from.j = phi ptr [ %from, %numbers ], [ %from.n, %number ]
  %to.j = phi ptr [ %to, %numbers ], [ %to.n, %number ]
  %v = load double, ptr %from.j, align 8
  store double %v, ptr %to.j, align 8
  %from.n = getelementptr i8, ptr %from.j, i64 %from.stride
  %to.n = getelementptr i8, ptr %to.j, i64 %to.stride
  %j.n = sub i64 %j, 1
  %j.over = icmp eq i64 %j.n, 0
  br i1 %j.over, label %copied, label %number
copied:
  ret ptr %beyond
more:
  %k = phi i64 [ 0, %entry ], [ %k.n, %more ]
  %s.k = phi ptr [ %s, %entry ], [ %s.n, %more ]
  %p.k = phi ptr [ %p, %entry ], [ %p.n, %more ]
  %s.n = call ptr @ulna.copy.rows.axis(ptr %s.k, ptr %p.k, ptr %steps, ptr %inner, i1 %out)
  %p.n = getelementptr i8, ptr %p.k, i64 %stride
  %k.n = add i64 %k, 1
  %over = icmp eq i64 %k.n, %size
  br i1 %over, label %done, label %more
done:
  ret ptr %s.n
}
define internal void @ulna.copy.rows(ptr %scratch, ptr %row, i64 %rows, i64 %last, ptr %steps, ptr %port, i1 %dense) noinline cold nounwind {
entry:
  %is.output = load i64, ptr %port
  %out = icmp ne i64 %is.output, 0
  %at.p = getelementptr i64, ptr %port, i64 1
  %at = load i64, ptr %at.p
  %stride.p = getelementptr i64, ptr %steps, i64 %at
  %stride = load i64, ptr %stride.p
  %size.p = getelementptr i64, ptr %port, i64 2
  %size = load i64, ptr %size.p
  %axes = getelementptr i64, ptr %port, i64 3
  %first.p = getelementptr i64, ptr %port, i64 4
  %first = load i64, ptr %first.p
  %inside.p = getelementptr i64, ptr %steps, i64 %first
  %inside = load i64, ptr %inside.p
  %second.p = getelementptr i64, ptr %port, i64 5
  %second = load i64, ptr %second.p
  %is.line = icmp eq i64 %second, 0
  %is.even = or i1 %dense, %is.line
  %between = select i1 %dense, i64 8, i64 %inside
  %from.stride = select i1 %out, i64 8, i64 %between
  %to.stride = select i1 %out, i64 %between, i64 8
  br label %next
next:
  %k = phi i64 [ 0, %entry ], [ %k.n, %copied ]
  %s = phi ptr [ %scratch, %entry ], [ %s.n, %copied ]
  %p = phi ptr [ %row, %entry ], [ %p.n, %copied ]
  br i1 %is.even, label %numbers, label %axis
numbers:
  %from = select i1 %out, ptr %s, ptr %p
  %to = select i1 %out, ptr %p, ptr %s
  br label %number
number:
  %j = phi i64 [ %size, %numbers ], [ %j.n, %number ]
  %from.j = phi ptr [ %from, %numbers ], [ %from.n, %number ]
  %to.j = phi ptr [ %to, %numbers ], [ %to.n, %number ]
  %v = load double, ptr %from.j, align 8
  store double %v, ptr %to.j, align 8
  %from.n = getelementptr i8, ptr %from.j, i64 %from.stride
  %to.n = getelementptr i8, ptr %to.j, i64 %to.stride
  %j.n = sub i64 %j, 1
  %j.over = icmp eq i64 %j.n, 0
  br i1 %j.over, label %copied, label %number
axis:
  %s.axis = call ptr @ulna.copy.rows.axis(ptr %s, ptr %p, ptr %steps, ptr %axes, i1 %out)
  br label %copied
copied:
  %s.n = getelementptr double, ptr %s, i64 %size
  %is.before = icmp ult i64 %k, %last
  %step = select i1 %is.before, i64 %stride, i64 0
  %p.n = getelementptr i8, ptr %p, i64 %step
  %k.n = add i64 %k, 1
  %over = icmp eq i64 %k.n, %rows
  br i1 %over, label %done, label %next
done:
  ret void
}
@batch.port0 = private unnamed_addr constant [6 x i64] [i64 0, i64 0, i64 1, i64 0, i64 0, i64 0], align 8
@batch.port1 = private unnamed_addr constant [6 x i64] [i64 0, i64 1, i64 1, i64 0, i64 0, i64 0], align 8
@batch.port2 = private unnamed_addr constant [6 x i64] [i64 1, i64 2, i64 1, i64 0, i64 0, i64 0], align 8
@batch.port3 = private unnamed_addr constant [6 x i64] [i64 1, i64 3, i64 1, i64 0, i64 0, i64 0], align 8
define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {
entry:
  %n = load i64, ptr %dims
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
  %last = sub i64 %left, 1
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
  br i1 %direct0, label %get1, label %get0.copy
get0.copy:
  %get0.o = mul i64 %i, %s0
  %get0.p = getelementptr i8, ptr %a0, i64 %get0.o
  call void @ulna.copy.rows(ptr %t0, ptr %get0.p, i64 %rows, i64 %last, ptr %steps, ptr @batch.port0, i1 %dense0)
  br label %get1
get1:
  br i1 %direct1, label %get2, label %get1.copy
get1.copy:
  %get1.o = mul i64 %i, %s1
  %get1.p = getelementptr i8, ptr %a1, i64 %get1.o
  call void @ulna.copy.rows(ptr %t1, ptr %get1.p, i64 %rows, i64 %last, ptr %steps, ptr @batch.port1, i1 %dense1)
  br label %get2
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
  br i1 %direct2, label %put3, label %put2.copy
put2.copy:
  %put2.o = mul i64 %i, %s2
  %put2.p = getelementptr i8, ptr %a2, i64 %put2.o
  call void @ulna.copy.rows(ptr %t2, ptr %put2.p, i64 %count, i64 %last, ptr %steps, ptr @batch.port2, i1 %dense2)
  br label %put3
put3:
  br i1 %direct3, label %put4, label %put3.copy
put3.copy:
  %put3.o = mul i64 %i, %s3
  %put3.p = getelementptr i8, ptr %a3, i64 %put3.o
  call void @ulna.copy.rows(ptr %t3, ptr %put3.p, i64 %count, i64 %last, ptr %steps, ptr @batch.port3, i1 %dense3)
  br label %put4
put4:
  %next = add i64 %i, %count
  %end = icmp eq i64 %next, %n
  br i1 %end, label %done, label %step
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="128" "min-legal-vector-width"="128" "stackrealign" }
