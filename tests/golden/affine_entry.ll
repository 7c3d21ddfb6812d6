
define internal void @one(ptr %i0, ptr %o0) noinline nounwind {
entry:
  %p1 = getelementptr double, ptr %i0, i64 0
  %w2 = load double, ptr %p1, align 8
  %p3 = getelementptr double, ptr %i0, i64 1
  %w4 = load double, ptr %p3, align 8
  %p5 = getelementptr double, ptr %i0, i64 2
  %w6 = load double, ptr %p5, align 8
  %v4 = fmul contract double %w6, 0x4000000000000000
  %v5 = fmul contract double %w4, 0x4000000000000000
  %v6 = fmul contract double %w2, 0x4000000000000000
  %v7 = fadd contract double %w2, %v4
  %p7 = getelementptr double, ptr %o0, i64 0
  store double %v7, ptr %p7, align 8
  %v8 = fadd contract double %w2, %v5
  %p8 = getelementptr double, ptr %o0, i64 1
  store double %v8, ptr %p8, align 8
  %v9 = fadd contract double %w2, %v6
  %p9 = getelementptr double, ptr %o0, i64 2
  store double %v9, ptr %p9, align 8
  ret void
}

@lengths0 = private constant [1 x i64] [i64 3]
define ptr @entry(ptr %self, ptr %args, i64 %flagged, ptr %keywords) nounwind {
entry:
  %count = and i64 %flagged, 9223372036854775807
  %count.ok = icmp eq i64 %count, 1
  %plain = icmp eq ptr %keywords, null
  %begin = and i1 %count.ok, %plain
  %array_type.p = getelementptr i8, ptr %self, i64 64
  %array_type = load ptr, ptr %array_type.p
  %descriptor.p = getelementptr i8, ptr %self, i64 72
  %descriptor = load ptr, ptr %descriptor.p
  %array_new.p = getelementptr i8, ptr %self, i64 80
  %array_new = load ptr, ptr %array_new.p
  br i1 %begin, label %type0, label %general
type0:
  %arg0.p = getelementptr ptr, ptr %args, i64 0
  %arg0 = load ptr, ptr %arg0.p
  %kind0.p = getelementptr i8, ptr %arg0, i64 8
  %kind0 = load ptr, ptr %kind0.p
  %kind0.ok = icmp eq ptr %kind0, %array_type
  br i1 %kind0.ok, label %fields0, label %general
fields0:
  %descr0.p = getelementptr i8, ptr %arg0, i64 56
  %descr0 = load ptr, ptr %descr0.p
  %ndim0.p = getelementptr i8, ptr %arg0, i64 24
  %ndim0 = load i32, ptr %ndim0.p
  %flags0.p = getelementptr i8, ptr %arg0, i64 64
  %flags0 = load i32, ptr %flags0.p
  %data0.p = getelementptr i8, ptr %arg0, i64 16
  %data0 = load ptr, ptr %data0.p
  %lengths0.p = getelementptr i8, ptr %arg0, i64 32
  %lengths0 = load ptr, ptr %lengths0.p
  %descr0.ok = icmp eq ptr %descr0, %descriptor
  %ndim0.ok = icmp eq i32 %ndim0, 1
  %wanted0 = and i32 %flags0, 257
  %flags0.ok = icmp eq i32 %wanted0, 257
  %a0.ok = and i1 %descr0.ok, %ndim0.ok
  %b0.ok = and i1 %a0.ok, %flags0.ok
  br i1 %b0.ok, label %shape0, label %general
shape0:
  %n0.0.p = getelementptr i64, ptr %lengths0, i64 0
  %n0.0 = load i64, ptr %n0.0.p
  %n0.0.ok = icmp eq i64 %n0.0, 3
  %all0.0 = and i1 true, %n0.0.ok
  br i1 %all0.0, label %work, label %general
work:
  %invalid = call i1 @invalid(ptr %data0)
  br i1 %invalid, label %general, label %valid
valid:
  %out0 = call ptr %array_new(ptr %array_type, i32 1, ptr @lengths0, i32 12, ptr null, ptr null, i32 0, i32 0, ptr null)
  %bad0 = icmp eq ptr %out0, null
  br i1 %bad0, label %failed, label %made0
made0:
  %res0.p = getelementptr i8, ptr %out0, i64 16
  %res0 = load ptr, ptr %res0.p
  call void @one(ptr %data0, ptr %res0)
  ret ptr %out0
failed:
  ret ptr null
general:
  %other.p = getelementptr i8, ptr %self, i64 56
  %other = load ptr, ptr %other.p
  %slow = call ptr %other(ptr %self, ptr %args, i64 %flagged, ptr %keywords)
  ret ptr %slow
}

define i32 @work(ptr %pointers) nounwind {
entry:
  %data0.p = getelementptr ptr, ptr %pointers, i64 0
  %data0 = load ptr, ptr %data0.p
  %res0.p = getelementptr ptr, ptr %pointers, i64 1
  %res0 = load ptr, ptr %res0.p
  %invalid = call i1 @invalid(ptr %data0)
  br i1 %invalid, label %refused, label %valid
refused:
  ret i32 1
valid:
  call void @one(ptr %data0, ptr %res0)
  ret i32 0
}

define internal i1 @invalid(ptr %data0) noinline nounwind {
entry:
  %f0.0.p = getelementptr double, ptr %data0, i64 0
  %f0.0 = load double, ptr %f0.0.p, align 8
  %f0.0.z = fmul double %f0.0, 0.0
  %f0.0.s = fadd reassoc double 0.0, %f0.0.z
  %f0.1.p = getelementptr double, ptr %data0, i64 1
  %f0.1 = load double, ptr %f0.1.p, align 8
  %f0.1.z = fmul double %f0.1, 0.0
  %f0.1.s = fadd reassoc double %f0.0.s, %f0.1.z
  %f0.2.p = getelementptr double, ptr %data0, i64 2
  %f0.2 = load double, ptr %f0.2.p, align 8
  %f0.2.z = fmul double %f0.2, 0.0
  %f0.2.s = fadd reassoc double %f0.1.s, %f0.2.z
  %infinite = fcmp uno double %f0.2.s, 0.0
  br i1 %infinite, label %general, label %finite
finite:
  ret i1 false
general:
  ret i1 true
}
