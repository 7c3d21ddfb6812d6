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
@batch.port1 = private unnamed_addr constant [6 x i64] [i64 1, i64 1, i64 1, i64 0, i64 0, i64 0], align 8
@batch.port2 = private unnamed_addr constant [6 x i64] [i64 1, i64 2, i64 1, i64 0, i64 0, i64 0], align 8
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
  %none = icmp eq i64 %n, 0
  br i1 %none, label %done, label %step
step:
  %i = phi i64 [ 0, %entry ], [ %next, %put3 ]
  %left = sub i64 %n, %i
  %last = sub i64 %left, 1
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
  br i1 %direct1, label %put2, label %put1.copy
put1.copy:
  %put1.o = mul i64 %i, %s1
  %put1.p = getelementptr i8, ptr %a1, i64 %put1.o
  call void @ulna.copy.rows(ptr %t1, ptr %put1.p, i64 %count, i64 %last, ptr %steps, ptr @batch.port1, i1 %dense1)
  br label %put2
put2:
  br i1 %direct2, label %put3, label %put2.copy
put2.copy:
  %put2.o = mul i64 %i, %s2
  %put2.p = getelementptr i8, ptr %a2, i64 %put2.o
  call void @ulna.copy.rows(ptr %t2, ptr %put2.p, i64 %count, i64 %last, ptr %steps, ptr @batch.port2, i1 %dense2)
  br label %put3
put3:
  %next = add i64 %i, %count
  %end = icmp eq i64 %next, %n
  br i1 %end, label %done, label %step
done:
  %flags = call i32 @feclearexcept(i32 -1)
  ret void
}


attributes #0 = { "prefer-vector-width"="512" "min-legal-vector-width"="512" "stackrealign" }
