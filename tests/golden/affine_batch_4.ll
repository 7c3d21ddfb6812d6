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
@batch.port0 = private unnamed_addr constant [6 x i64] [i64 0, i64 0, i64 3, i64 3, i64 2, i64 0], align 8
@batch.port1 = private unnamed_addr constant [6 x i64] [i64 1, i64 1, i64 3, i64 3, i64 3, i64 0], align 8
define void @batch(ptr %args, ptr %dims, ptr %steps, ptr %data) nounwind {
entry:
  %n = load i64, ptr %dims
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
  %last = sub i64 %left, 1
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
  br i1 %direct0, label %get1, label %get0.copy
get0.copy:
  %get0.o = mul i64 %i, %s0
  %get0.p = getelementptr i8, ptr %a0, i64 %get0.o
  call void @ulna.copy.rows(ptr %t0, ptr %get0.p, i64 %rows, i64 %last, ptr %steps, ptr @batch.port0, i1 %dense0)
  br label %get1
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
  br i1 %direct1, label %put2, label %put1.copy
put1.copy:
  %put1.o = mul i64 %i, %s1
  %put1.p = getelementptr i8, ptr %a1, i64 %put1.o
  call void @ulna.copy.rows(ptr %t1, ptr %put1.p, i64 %count, i64 %last, ptr %steps, ptr @batch.port1, i1 %dense1)
  br label %put2
put2:
  %next = add i64 %i, %count
  %end = icmp eq i64 %next, %n
  br i1 %end, label %done, label %step
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="256" "min-legal-vector-width"="256" "stackrealign" }
