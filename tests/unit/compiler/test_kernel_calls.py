"""What a kernel takes and returns: shapes, strides, types, `out=`, threads, and the messages of what it refuses."""

from __future__ import annotations

import re
import sys

import numpy as np
import pytest

from ulna.compiler import compile, trace
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError, TraceError, UnknownName


def _f(q, m):
    """Mixes everything, so that a misplaced number shows."""
    w = np.array([1.0, 10.0, 100.0])
    return (m @ q) * 2.0 + np.sin(q[0]) + w * q[2], m.T @ m


def plain(q, m):
    q, m = np.asarray(q, float), np.asarray(m, float)
    w = np.array([1.0, 10.0, 100.0])
    a = (m @ q[..., None])[..., 0] * 2.0 + np.sin(q[..., :1]) + w * q[..., 2:]
    return a, np.swapaxes(m, -1, -2) @ m + 0.0 * q[..., :1, None] * 0.0


class _Subclass(np.ndarray):
    pass


@pytest.fixture(scope="module")
def unit_kernel():
    return compile(lambda q: 0.5 * q @ q, checked=True, unit_entries=((0, (0, 1)),), q=(3,))


@pytest.fixture(scope="module")
def kernel():
    return compile(_f, q=(3,), m=(3, 3))


@pytest.fixture(scope="module")
def double():
    return compile(lambda q: 2.0 * q + 1.0, q=(3,))


def data(*batch: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(*batch, 3)), rng.normal(size=(*batch, 3, 3))


def check(kernel, q, m, **options):
    got, expected = kernel(q, m, **options), plain(q, m)
    assert isinstance(got, tuple)
    for g, e in zip(got, expected, strict=True):
        assert type(g) is np.ndarray
        assert g.dtype == np.float64
        assert (
            g.shape
            == np.broadcast_shapes(np.shape(q)[:-1], np.shape(m)[:-2])
            + e.shape[-(2 if e is expected[1] else 1) :]
        )
        np.testing.assert_allclose(g, np.broadcast_to(e, g.shape), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("rows", [*range(21), 64, 1000])
def test_any_number_of_rows(kernel, rows):
    check(kernel, *data(rows))


@pytest.mark.parametrize("batch", [(), (1,), (2, 3), (4, 1, 5), (2, 0, 3), (1, 1, 1, 1), (3, 2, 2, 3)])
def test_any_leading_axes(kernel, batch):
    check(kernel, *data(*batch))


@pytest.mark.parametrize(
    ("a", "b"), [((), (5,)), ((5,), ()), ((4, 1), (6,)), ((2, 1, 3), (5, 1)), ((1,), (9,)), ((0,), (1,))]
)
def test_leading_axes_broadcast(kernel, a, b):
    check(kernel, data(*a)[0], data(*b)[1])


def test_strides_of_every_kind(kernel):
    q, m = data(12)
    check(kernel, q[::-1], m[::-1])
    check(kernel, q[::3], m[::3])
    check(kernel, q[:, ::-1], m[:, ::-1, ::-1])
    check(kernel, np.asfortranarray(q), np.asfortranarray(m))
    check(kernel, q, np.swapaxes(m, -1, -2))
    check(
        kernel,
        np.repeat(q, 2, axis=-1)[:, ::2],
        np.moveaxis(np.ascontiguousarray(np.moveaxis(m, 0, -1)), -1, 0),
    )
    check(kernel, np.broadcast_to(q[0], (9, 3)), np.broadcast_to(m[0, 0], (9, 3, 3)))
    check(kernel, np.broadcast_to(q[:, :1], (12, 3)), m)
    check(kernel, q[0, ::-1], m[0].T)
    check(kernel, np.broadcast_to(1.5, (3,)), np.broadcast_to(2.0, (3, 3)))
    wide = np.zeros((12, 7))
    wide[:, 2:5] = q
    check(kernel, wide[:, 2:5], m)


def test_what_is_not_an_array_of_doubles_is_converted(kernel):
    q, m = data()
    check(kernel, q.tolist(), m.tolist())
    check(kernel, tuple(q), [tuple(row) for row in m])
    check(kernel, [1, 2, 3], np.arange(9).reshape(3, 3))
    check(kernel, np.array([1, 0, 1], bool), np.eye(3, dtype=np.uint8))
    check(kernel, q.astype(np.float32), m.astype(np.float16))
    check(kernel, q.astype(">f8"), m.astype(">f4"))
    check(kernel, np.array([1, 2.5, np.float32(3)], dtype=object), m.astype(object))
    for batch in (2, 30):
        q, m = data(batch)
        check(kernel, q.astype(np.float32), m.astype(">f8"))
        check(kernel, q.tolist(), m.astype(np.longdouble))


def test_doubles_that_the_fast_call_cannot_read(kernel):
    """Each of these equals float64 or looks contiguous, and still needs the general path, without end or harm."""
    q, m = data()
    marked = np.dtype("f8", metadata={"unit": "rad"})
    check(kernel, q.astype(marked), m.astype(marked))
    raw = np.zeros(25, np.uint8)
    raw[1:] = q.view(np.uint8)
    unaligned = np.frombuffer(raw.tobytes(), "f8", 3, 1)
    assert not unaligned.flags.aligned
    check(kernel, unaligned, m)
    record = np.zeros(4, np.dtype([("c", "u1"), ("q", "f8", 3)]))
    record["q"] = q
    check(kernel, record["q"], m)
    check(kernel, record[1]["q"], m)
    one = compile(lambda x: 3.0 * x, x=())
    assert one(np.ndarray((), "f8", raw.tobytes(), 1)) == 3.0 * q[0]
    assert one(np.array(2.0, marked)) == 6.0


def test_read_only_inputs(kernel):
    q, m = data(10)
    q.flags.writeable = m.flags.writeable = False
    check(kernel, q, m)
    check(kernel, q[0], m[0])


def test_arguments_by_name(kernel):
    q, m = data(4)
    for got in (kernel(q=q, m=m), kernel(m=m, q=q), kernel(q, m=m)):
        np.testing.assert_array_equal(got[0], kernel(q, m)[0])
    with pytest.raises(TypeError, match=r"_f\(q, m\) got `q` twice"):
        kernel(q, m, q=q)
    with pytest.raises(
        TypeError, match=r"_f\(q, m\) has no argument 'dtype'; besides its inputs it takes `out`"
    ):
        kernel(q, m, dtype=float)
    with pytest.raises(TypeError, match=r"_f\(q, m\) takes 2 arguments; 1 were given"):
        kernel(m=m)


def test_numbers_in_and_out():
    kernel = compile(lambda x, y: x / y, x=(), y=())
    for got in (
        kernel(1.0, 4.0),
        kernel(np.float64(1.0), np.array(4.0)),
        kernel(1, 4),
        kernel(np.float32(1), 4.0),
    ):
        assert type(got) is np.float64
        assert got == 0.25
    assert kernel(np.ones(5), 4.0).tolist() == [0.25] * 5
    assert kernel(np.ones((2, 1)), np.ones(3)).shape == (2, 3)


def test_several_numbers_leave_as_a_tuple():
    kernel = compile(lambda x: (x + 1.0, x * 2.0, np.array([x, x])), x=())
    got = kernel(3.0)
    assert [type(g) for g in got] == [np.float64, np.float64, np.ndarray]
    assert (got[0], got[1], got[2].tolist()) == (4.0, 6.0, [3.0, 3.0])
    assert [g.shape for g in kernel(np.ones(9))] == [(9,), (9,), (9, 2)]
    one = compile(lambda x: (x + 1.0,), x=())
    assert one(1.0) == (2.0,)
    assert one(np.ones(9))[0].tolist() == [2.0] * 9


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_numbers_are_new_objects_that_go_with_their_last_reference(dtype):
    kernel = compile(lambda q: (q @ q, q[0] * q, q[1] - q[0]), dtype, q=(2,))
    bound = kernel.into(np.zeros((), dtype), np.zeros(2, dtype), np.zeros((), dtype), returns=(0, 2))
    q = np.array([3.0, 4.0], dtype)
    first, one = kernel(q), bound(q)
    q[0] = 1.0
    assert [type(x) for x in (first[0], first[2], *one)] == [dtype] * 4
    assert (float(first[0]), float(first[2])) == tuple(map(float, one)) == (25.0, 1.0)
    assert (float(kernel(q)[0]), float(bound(q)[1])) == (17.0, 3.0)
    blocks = sys.getallocatedblocks()
    for _ in range(1000):
        kernel(q), bound(q)
    assert sys.getallocatedblocks() - blocks < 100


@pytest.mark.parametrize("batch", [(), (1,), (7,), (3, 20)])
def test_out(kernel, batch):
    q, m = data(*batch)
    out = np.full((*batch, 3), np.nan), np.full((*batch, 3, 3), np.nan)
    got = kernel(q, m, out=out)
    assert got[0] is out[0]
    assert got[1] is out[1]
    check(kernel, q, m, out=out)
    check(kernel, q, m, out=(out[0][..., ::-1], np.swapaxes(out[1], -1, -2)))


def test_out_of_a_single_output(double):
    q, out = np.arange(3.0), np.zeros(3)
    assert double(q, out=out) is out
    assert out.tolist() == [1.0, 3.0, 5.0]
    many = np.zeros((20, 3))
    double(np.ones((20, 3)), out=many[:, ::-1])
    assert (many == 3.0).all()
    single = np.zeros(3, np.float32)
    double(q, out=single)
    assert single.tolist() == [1.0, 3.0, 5.0]


@pytest.mark.parametrize("rows", [(), (3,)])
def test_a_tuple_of_one_stays_a_tuple(rows):
    """As from a plain call, however `out` is passed and whether arguments are converted or not."""
    kernel, out = compile(lambda q: (2.0 * q,), q=(2,)), np.zeros((*rows, 2))
    for q in (np.ones((*rows, 2)), np.ones((*rows, 2)).tolist()):
        for found in (kernel(q), kernel(q, out=out), kernel(q, out=(out,))):
            assert isinstance(found, tuple)
            np.testing.assert_array_equal(found[0], 2.0 * np.ones((*rows, 2)))
        assert kernel(q, out=out)[0] is out


@pytest.mark.parametrize("rows", [1, 5, 16, 17, 5000])
@pytest.mark.parametrize("threads", [None, 3])
def test_out_may_overlap_the_inputs(double, rows, threads):
    whole = np.arange(3.0 * (rows + 2)).reshape(rows + 2, 3)
    for source, target in (
        (slice(rows), slice(rows)),
        (slice(rows), slice(2, None)),
        (slice(2, None), slice(rows)),
    ):
        buffer = whole.copy()
        expected = 2.0 * buffer[source] + 1.0
        double(buffer[source], out=buffer[target], threads=threads)
        np.testing.assert_array_equal(buffer[target], expected)
    buffer = whole.copy()
    double(buffer[::-1], out=buffer, threads=threads)
    np.testing.assert_array_equal(buffer, 2.0 * whole[::-1] + 1.0)


@pytest.mark.parametrize("batch", [(5000,), (2049,), (3, 2000), (2000, 3), (70, 70), (10,), ()])
@pytest.mark.parametrize("threads", [2, 5, 64])
def test_threads_change_nothing(kernel, batch, threads):
    q, m = data(*batch)
    for got, expected in zip(kernel(q, m, threads=threads), kernel(q, m), strict=True):
        np.testing.assert_allclose(got, expected, rtol=1e-14, atol=1e-14)
    out = np.zeros((*batch, 3)), np.zeros((*batch, 3, 3))
    kernel(q, m, out=out, threads=threads)
    np.testing.assert_allclose(out[1], kernel(q, m)[1], rtol=1e-14, atol=1e-14)


def test_threads_with_broadcast_inputs_and_wider_outputs(kernel, double):
    q, m = data(4000)
    check(kernel, q, m[0], threads=4)
    check(kernel, q[:, None], m[:2], threads=4)
    wide = np.zeros((2, 4000, 3))
    double(q, out=wide, threads=4)
    np.testing.assert_array_equal(wide[1], double(q))
    with pytest.raises(ShapeError, match=r"`out` has shape \(5, 3\); expected \(4000, 3\)\."):
        double(q, out=np.zeros((5, 3)), threads=4)


@pytest.mark.parametrize("threads", [0, -1, 1.5, "two"])
def test_an_invalid_number_of_threads_is_refused(double, threads):
    with pytest.raises(InputError, match="expected a whole number, 1 or more"):
        double(np.ones((4, 3)), threads=threads)


def test_subclasses_of_arrays_keep_their_kind(double):
    q = np.arange(3.0)
    assert isinstance(double(q[None].view(np.matrix)), np.matrix)
    assert double(np.ma.array([q, q]))[1].tolist() == [1.0, 3.0, 5.0]
    with pytest.raises(
        InputError, match="masked"
    ):  # a mask says nothing about what was computed from many entries
        double(np.ma.array([q, q], mask=[[0, 1, 0], [0, 0, 0]]))

    class Tagged(np.ndarray):
        pass

    assert type(double(q.view(Tagged))) is Tagged
    assert type(double(np.ones((20, 3)).view(Tagged))) is Tagged


def test_arrays_of_other_libraries_take_part_through_array_ufunc(double):
    class Lazy:
        def __array_ufunc__(self, ufunc, method, *inputs, **kwargs):
            return (ufunc.signature, method)

    assert double(Lazy()) == ("(3)->(3)", "__call__")


def test_axes_of_length_zero():
    nothing_in = compile(lambda a, b: b * 2.0 + a.sum(), a=(0,), b=(2,))
    assert nothing_in(np.zeros(0), np.ones(2)).tolist() == [2.0, 2.0]
    assert nothing_in(np.zeros((5, 0)), np.ones(2)).shape == (5, 2)
    nothing_out = compile(lambda a: (np.zeros((0, 4, 4)), a), a=(2,))
    assert [r.shape for r in nothing_out(np.zeros(2))] == [(0, 4, 4), (2,)]
    assert [r.shape for r in nothing_out(np.zeros((7, 2)))] == [(7, 0, 4, 4), (7, 2)]
    out = np.zeros((7, 0, 4, 4)), np.zeros((7, 2))
    assert nothing_out(np.ones((7, 2)), out=out)[1] is out[1]
    assert (out[1] == 1.0).all()
    constant = compile(lambda: np.array([1.0, 2.0]))
    assert constant().tolist() == [1.0, 2.0]
    assert compile(lambda a: (), a=(2,))(np.zeros((5, 2))) == ()


def test_more_arrays_than_a_ufunc_takes():
    shapes = {f"a{k}": () for k in range(70)}
    kernel = compile(lambda *a: sum(a), **shapes)
    assert kernel(*range(70)) == 2415.0
    assert kernel(*[np.ones(9)] * 70).tolist() == [70.0] * 9


def test_no_floating_point_error_is_reported_and_none_is_left_behind():
    kernel = compile(lambda x: 1.0 / x + np.exp(1e6 * x) * np.sqrt(x - 1.0), x=(1,))
    with np.errstate(all="raise"):
        for rows in ((1,), (3, 1), (20, 1)):
            assert not np.isfinite(kernel(np.zeros(rows))).any()
            assert np.ones(3).sum() * np.float64(2.0) == 6.0


def test_unused_inputs_and_constant_outputs():
    kernel = compile(lambda a, b: np.array([1.0, b[0], 2.5]), a=(4,), b=(1,))
    assert kernel(np.full(4, np.nan), [7.0]).tolist() == [1.0, 7.0, 2.5]
    assert kernel(np.zeros((9, 4)), np.ones((9, 1))).tolist() == [[1.0, 1.0, 2.5]] * 9


def test_an_input_handed_out_as_it_is():
    kernel = compile(lambda a: (a, a[::-1]), a=(5,))
    a = np.arange(50.0).reshape(10, 5)
    np.testing.assert_array_equal(kernel(a)[1], a[:, ::-1])
    got = kernel(a[0])
    assert not np.shares_memory(got[0], a)


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 33])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_every_width_of_sample_is_transposed_right(size, dtype):
    kernel = compile(trace(lambda a: a[::-1] + a[0], a=(size,)), dtype)
    for rows in (1, 7, 8, 16, 21):
        a = np.arange(rows * size, dtype=dtype).reshape(rows, size)
        np.testing.assert_array_equal(kernel(a), a[:, ::-1] + a[:, :1])
        # Neighbours of the array are neither read into results nor written.
        frame = np.full((rows + 2, size), -7, dtype)
        kernel(a, out=frame[1:-1])
        np.testing.assert_array_equal(frame[1:-1], kernel(a))
        assert (frame[[0, -1]] == -7).all()


def test_single_precision():
    kernel = compile(trace(lambda q: np.sin(q) * 2.0, q=(3,)), np.float32)
    q = np.linspace(-1, 1, 3)
    for given in (q, q.astype(np.float32), q.tolist(), np.tile(q, (20, 1))):
        got = kernel(given)
        assert got.dtype == np.float32
        np.testing.assert_allclose(got, np.sin(np.asarray(given)) * 2, rtol=3e-7)
    assert kernel.dtype == np.float32


def test_batches_agree_with_single_calls(kernel):
    q, m = data(37)
    batch = kernel(q, m)
    for k in range(37):
        for b, s in zip(batch, kernel(q[k], m[k]), strict=True):
            np.testing.assert_allclose(b[k], s, rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize(
    ("q", "m", "error", "message"),
    [
        (np.zeros(4), np.eye(3), ShapeError, "`q` has shape (4,); expected (..., 3). The last axis holds the 3 numbers"),
        (np.zeros((3, 5)), np.eye(3), ShapeError, "`q` has shape (3, 5); expected (..., 3). The batch axis comes first"),
        (np.zeros(3), np.zeros(3), ShapeError, "`m` has shape (3,); expected (..., 3, 3)."),
        (1.0, np.eye(3), ShapeError, "`q` has shape (); expected (..., 3)."),
        (np.zeros((2, 3)), np.zeros((5, 3, 3)), ShapeError,
         "expected leading axes that broadcast. Together: `q` (2, 3), `m` (5, 3, 3)."),
        (np.zeros(3, complex), np.eye(3), DtypeError, "`q` has dtype complex128; expected real numbers."),
        ("abc", np.eye(3), DtypeError, "`q` has dtype <U3; expected real numbers."),
        (None, np.eye(3), DtypeError, "`q` has dtype object and holds None; expected real numbers."),
        ([1.0, None, 2.0], np.eye(3), DtypeError, "`q` has dtype object and holds None; expected real numbers."),
        (np.array(["1", 2, 3], object), np.eye(3), DtypeError, "`q` has dtype object and holds '1'"),
        (np.array([{}, 2, 3]), np.eye(3), DtypeError, "`q` has dtype object; expected real numbers. NumPy says:"),
        ([[1.0, 2.0, 3.0], [1.0]], np.eye(3), InputError, "`q` is made of rows of different lengths; expected (..., 3). NumPy says:"),
        (np.array(["2020-01-01"] * 3, "M8[D]"), np.eye(3), DtypeError, "`q` has dtype datetime64[D]"),
    ],
)  # fmt: skip
def test_wrong_input_is_refused_by_name(kernel, q, m, error, message):
    with pytest.raises(error, match=re.escape(message)):
        kernel(q, m)


def test_wrong_counts_and_outputs_are_refused(kernel, double):
    with pytest.raises(TypeError, match=r"_f\(q, m\) takes 2 arguments; 0 were given\."):
        kernel()
    with pytest.raises(TypeError, match=r"_f\(q, m\) takes 2 arguments; 3 were given\."):
        kernel(1, 2, 3)
    for shape in ((4,), (), (3, 1)):
        with pytest.raises(ShapeError, match=re.escape(f"`out` has shape {shape}; expected (3,).")):
            double(np.zeros(3), out=np.zeros(shape))
    with pytest.raises(ShapeError, match=re.escape("`out` has shape (1, 3); expected (2, 3).")):
        double(np.zeros((2, 3)), out=np.zeros((1, 3)))
    frozen = np.zeros(3)
    frozen.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        double(np.zeros(3), out=frozen)
    with pytest.raises(DtypeError, match="`out` has dtype int64; expected float64"):
        double(np.zeros(3), out=np.zeros(3, np.int64))
    with pytest.raises(InputError, match="`out` is of type list"):
        double(np.zeros(3), out=[0.0, 0.0, 0.0])
    with pytest.raises(InputError, match="`out` holds 1 arrays; _f has 2 outputs"):
        kernel(*data(3), out=np.zeros(3))


def test_checked_kernels_name_the_first_number_that_is_not_finite():
    kernel = compile(trace(lambda q, v: q + v, q=(3,), v=(3,)), checked=True)
    good, bad = np.ones(3), np.array([1.0, 2.0, np.nan])
    assert kernel(good, good).tolist() == [2.0] * 3
    assert kernel(np.full(3, 1.7e308), np.full(3, -1.7e308)).tolist() == [0.0] * 3, "a large sum is no reason"
    with pytest.raises(NonFiniteError, match=r"`v\[2\]` is nan; expected finite numbers"):
        kernel(good, bad)
    with pytest.raises(NonFiniteError, match=r"`q\[4, 1\]` is inf"):
        batch = np.ones((9, 3))
        batch[4, 1] = np.inf
        kernel(batch, good)
    with pytest.raises(NonFiniteError, match=r"`q\[2\]` is nan"):
        kernel(bad.tolist(), good)
    with pytest.raises(NonFiniteError, match=r"`q\[0, 2\]` is nan"):
        kernel(bad[None].view(np.matrix), good)
    for inf in (np.inf, -np.inf):
        with pytest.raises(NonFiniteError, match=r"`q\[0\]`"):
            kernel(np.array([inf, -inf, 0.0]), good)


def test_compiling_refuses_what_it_cannot_do():
    with pytest.raises(DtypeError, match="expected float64 or float32"):
        compile(trace(lambda x: x, x=()), dtype=np.int32)
    with pytest.raises(TypeError, match="traced already"):
        compile(trace(lambda x: x, x=()), x=())
    for shape in (3.0, -1, (2, -3), "3", (1.5,)):
        with pytest.raises(InputError, match=r"x=.*expected a shape, a whole number or a tuple of them"):
            compile(lambda x: x, x=shape)
    assert compile(lambda f: f + 1.0, f=np.int64(2))([1, 2]).tolist() == [2.0, 3.0]
    with pytest.raises(UnknownName, match="No input named 'p'. There are: 'q'"):
        compile(lambda q: q, q=(2,)).jacobian("p")
    with pytest.raises(UnknownName, match="No input named 3"):
        compile(lambda q: q, q=(2,)).jacobian(3)


def test_properties(kernel):
    assert kernel.signature == "(3),(3,3)->(3),(3,3)"
    assert kernel.gufunc.signature == "(3),(3,3)->(3),(3,3)"
    assert repr(kernel) == f"<kernel _f(3),(3,3)->(3),(3,3) float64, {kernel.operations} operations>"
    assert kernel.operations == sum(kernel.operation_counts.values()) > 20
    assert kernel.__name__ == "_f"
    assert kernel.__doc__.startswith("_f(q, m): (3),(3,3)->(3),(3,3)\n\nMixes everything")
    assert kernel.function.doc.startswith("Mixes everything")
    assert kernel.gufunc.__doc__.endswith("so that a misplaced number shows.")
    assert "define ptr @entry" in kernel.ir()
    assert "define void @batch" in kernel.ir(batch=True)
    assert "entry" in kernel.asm()
    assert len(kernel.graph) > 20


def test_the_jacobian_of_a_kernel():
    kernel = compile(lambda q: np.array([q[0] * q[1], np.sin(q[1])]), q=(2,))
    got = kernel.jacobian()([2.0, 3.0])
    np.testing.assert_allclose(got, [[3.0, 2.0], [0.0, np.cos(3.0)]], rtol=1e-15)


def test_a_kernel_inside_a_trace_is_inlined(double):
    outer = compile(lambda q: double(double(q))[0] + q[2], q=(3,))
    assert outer([1.0, 2.0, 3.0]) == 4.0 + 3.0 + 3.0
    assert outer.operations <= 7
    mixed = compile(lambda q: double([q[0], 2.0, 1]) + double(np.ones(3)), q=(1,))
    assert mixed([4.0]).tolist() == [9.0 + 3.0, 5.0 + 3.0, 3.0 + 3.0]
    with pytest.raises(
        ShapeError, match=r"`q` has shape \(2, 3\); expected \(3,\). A traced call takes one sample"
    ):
        trace(lambda a: double(a), a=(2, 3))


def test_a_traced_value_out_of_place_is_refused(double):
    kept = []
    trace(lambda a: kept.append(a[0]) or a, a=(1,))
    with pytest.raises(TraceError, match="another trace"):
        trace(lambda b: kept[0] + b, b=())
    inlined = double(np.array([kept[0], 1.0, 2.0], object))
    assert inlined.dtype == object


def test_dask():
    dask = pytest.importorskip("dask.array")
    kernel = compile(_f, q=(3,), m=(3, 3))
    q, m = data(100)
    got = kernel.dask(dask.from_array(q, chunks=(20, 3)), dask.from_array(m, chunks=(20, 3, 3)))
    np.testing.assert_allclose(got[0].compute(), kernel(q, m)[0])


@pytest.mark.skipif("dask" in sys.modules, reason="dask is loaded")
def test_without_dask_the_extra_is_named(double, monkeypatch):
    monkeypatch.setitem(sys.modules, "dask", None)
    monkeypatch.setitem(sys.modules, "dask.array", None)
    with pytest.raises(
        ImportError, match=r"Dask arrays needs the package 'dask'.*pip install .*'dask\[array\]>="
    ):
        double.dask(np.zeros(3))


@pytest.mark.parametrize("checked", [False, True])
def test_numbers_of_python_and_numpy_take_the_fast_call(checked: bool) -> None:
    class Metres(float):
        pass

    kernel = compile(lambda x, s: x * s, checked=checked, x=(3,), s=())
    x = np.arange(3.0)
    expected = 2.5 * x
    for number in (2.5, np.float64(2.5), np.array(2.5), Metres(2.5), np.float32(2.5)):
        np.testing.assert_array_equal(kernel(x, number), expected)
    np.testing.assert_array_equal(kernel(x, 2), 2.0 * x)
    np.testing.assert_array_equal(kernel(x, True), x)
    np.testing.assert_array_equal(kernel(x, np.array([2.5, 1.0])), [expected, x])
    if checked:
        with pytest.raises(NonFiniteError, match="s"):
            kernel(x, float("nan"))
    else:
        assert np.isnan(kernel(x, float("nan"))).all()
    with pytest.raises(DtypeError):
        kernel(x, "2.5")
    single = compile(lambda s: s + 1.0, dtype="float32", s=())
    assert single(1.5) == 2.5  # in float32 the bits of a Python float mean nothing, so it is converted


class Pose:
    """An object that is read as an array and takes no part in ufuncs, as `SE3`."""

    __array_ufunc__ = None

    def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
        return np.arange(9.0).reshape(3, 3)


def test_objects_that_are_no_part_of_ufuncs_are_read_as_arrays(kernel) -> None:
    for given, expected in zip(kernel(np.ones(3), Pose()), plain(np.ones(3), Pose()), strict=True):
        np.testing.assert_array_equal(given, expected)
    with pytest.raises(ShapeError, match=r"`q` has shape \(3, 3\); expected \(\.\.\., 2\)"):
        compile(lambda q: q[0] + q[1], q=(2,))(Pose())


@pytest.mark.parametrize("method", ["jacobian", "value_and_gradient", "hessian", "hvp", "jvp", "vjp"])
def test_derivatives_of_checked_kernels_check_unit_vectors(unit_kernel, method):
    derivative = getattr(unit_kernel, method)()
    others = [np.ones(port.shape) for port in derivative.function.inputs[1:]]
    derivative(np.array([0.6, 0.8, 7.0]), *others)
    with pytest.raises(InputError, match=r"`q\[\.\.\., 0:2\]` has length 1.08"):
        derivative(np.array([0.6, 0.9, 7.0]), *others)


def test_subclasses_of_arrays_are_checked_for_unit_vectors(unit_kernel, tmp_path):
    mapped = np.memmap(tmp_path / "q", np.float64, "w+", shape=(2, 3))
    mapped[:] = 0.6, 0.8, 7.0
    assert np.array_equal(unit_kernel(mapped), np.full(2, unit_kernel(mapped[0].tolist())))
    mapped[1, 1] = 0.9
    for wrong in (mapped, mapped.view(_Subclass)):
        with pytest.raises(InputError, match=r"`q\[\.\.\., 0:2\]` has length 1.08"):
            unit_kernel(wrong)
    with pytest.raises(ShapeError, match="`q`"):
        unit_kernel(mapped[:, :1])


def test_scalars_beside_subclasses_of_arrays_are_checked():
    scaled = compile(lambda q, a: a * q, checked=True, q=(3,), a=())
    for nan in (np.float32(np.nan), np.float64(np.nan), np.nan):
        with pytest.raises(NonFiniteError, match="`a`"):
            scaled(np.ones(3).view(_Subclass), nan)
