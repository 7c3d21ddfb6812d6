"""The doors that write into arrays that exist: `out=`, and kernels bound to arrays for good."""

from __future__ import annotations

import copy
import gc
import pickle
import subprocess
import sys
import threading
import weakref

import numpy as np
import pytest

from ulna.compiler import compile
from ulna.compiler.runtime.bound_call import Bound, CheckedBound
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError

Q, V = np.array([0.1, -0.7, 1.3]), np.array([0.4, 0.5, -2.0])


def _mixed(q, v):
    return np.outer(np.sin(q), v), q @ v, q[::-1] + 0.0 * v


@pytest.fixture(scope="module")
def kernel():
    return compile(_mixed, q=(3,), v=(3,))


@pytest.fixture
def targets():
    return np.zeros((3, 3)), np.zeros(()), np.zeros(3)


def _same(a, b) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


def _refused(*_):
    return "refused"


# out= ---------------------------------------------------------------------------------------------------


def test_out_is_written_and_returned(kernel, targets):
    assert kernel(Q, V, out=targets) is targets or not kernel.is_fast
    assert _same(targets, kernel(Q, V))
    one = compile(lambda q: 2.0 * q, q=(3,))
    row = np.zeros(3)
    assert one(Q, out=row) is row
    assert row.tolist() == (2.0 * Q).tolist()
    assert one(Q, out=(row,)) is row
    assert one([1, 2, 3], out=row) is row  # converted
    assert row.tolist() == [2.0, 4.0, 6.0]


def test_out_of_another_form_still_works(kernel, targets):
    wide = np.zeros((3, 6))[:, ::2]
    kernel(Q, V, out=(wide, targets[1], targets[2]))
    np.testing.assert_allclose(wide, kernel(Q, V)[0], rtol=1e-14)
    made = kernel(Q, V, out=(None, targets[1], None))
    np.testing.assert_allclose(made[0], kernel(Q, V)[0], rtol=1e-14)
    batch = np.zeros((5, 3))
    one = compile(lambda q: 2.0 * q, q=(3,))
    assert one(np.ones((5, 3)), out=batch) is batch
    assert (batch == 2.0).all()


@pytest.mark.parametrize(
    ("out", "error"),
    [
        (np.zeros(4), ShapeError),
        (np.zeros(3, int), DtypeError),
        ([0.0, 0.0, 0.0], InputError),
        ((np.zeros(3), np.zeros(3)), InputError),
    ],
)
def test_invalid_out_arguments_are_refused(out, error):
    with pytest.raises(error):
        compile(lambda q: 2.0 * q, q=(3,))(Q, out=out)


def test_out_that_is_read_only_is_refused():
    target = np.zeros(3)
    target.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        compile(lambda q: 2.0 * q, q=(3,))(Q, out=target)
    assert (target == 0.0).all()


def test_out_may_be_an_input():
    turn = compile(lambda q: q[::-1] * 2.0, q=(40,))
    q = np.arange(40.0)
    wanted = turn(q)
    turn(q, out=q)
    assert q.tolist() == wanted.tolist()


# into ---------------------------------------------------------------------------------------------------


def test_a_bound_kernel_of_a_fast_one_is_fast(kernel, targets):
    watched = np.zeros(1)
    for bound in (
        kernel.into(*targets),
        kernel.into(*targets, returns=(0, 2)),
        kernel.into(*targets, watch=((watched, watched.copy()),), otherwise=_refused),
    ):
        assert isinstance(bound, CheckedBound) is not kernel.is_fast


def test_results_go_into_the_arrays(kernel, targets):
    step = kernel.into(*targets)
    assert isinstance(step, Bound)
    assert step(Q, V) is None
    assert _same(targets, kernel(Q, V))
    assert step.kernel is kernel
    assert step.targets == targets
    assert "bound kernel" in repr(step)


def test_copies_are_returned(kernel, targets):
    found = kernel.into(*targets, returns=(2,))(Q, V)
    assert found.tolist() == targets[2].tolist()
    found[:] = 9.0
    assert (targets[2] != 9.0).all()
    number, matrix = kernel.into(*targets, returns=(1, 0))(Q, V)
    assert type(number) is np.float64
    assert number == targets[1]
    assert matrix.flags.owndata
    assert _same((matrix,), kernel(Q, V)[:1])


def test_an_object_is_returned_in_place_of_none(kernel, targets):
    answer = object()
    references = sys.getrefcount(answer)
    bound = kernel.into(*targets, answer=answer)
    for _ in range(10):
        assert bound(Q, V) is answer
    assert _same(targets, kernel(Q, V))
    assert bound([0.1, -0.7, 1.3], V) is answer  # converted
    watched = np.zeros(1)
    refused = kernel.into(*targets, answer=answer, watch=[(watched, np.zeros(1))], otherwise=_refused)
    assert refused(Q, V) is answer
    watched[0] = 1.0
    assert refused(Q, V) == "refused"
    assert kernel.into(*targets, returns=(1,), answer=answer)(Q, V) == Q @ V
    del bound, refused
    gc.collect()
    assert sys.getrefcount(answer) == references


def test_other_arguments_are_converted(kernel, targets):
    step = kernel.into(*targets, returns=(2,))
    wanted = kernel(Q, V)
    for q, v in ((list(Q), tuple(V)), (Q.astype(object), V), (np.repeat(Q, 2)[::2], V)):
        assert _same((step(q, v),), wanted[2:])
        assert _same(targets, wanted)
    assert step(np.arange(3), V).tolist() == kernel(np.arange(3.0), V)[2].tolist()
    half = compile(lambda x: 0.5 * x, x=())
    cell = np.zeros(())
    for x in (3.0, np.float64(3.0), 3, np.array(3.0)):
        cell[()] = 0.0
        half.into(cell)(x)
        assert cell == 1.5


def test_wrong_arguments_are_named(kernel, targets):
    step = kernel.into(*targets)
    with pytest.raises(ShapeError, match=r"`q` has shape \(2,\)"):
        step(Q[:2], V)
    with pytest.raises(ShapeError):
        step(np.ones((4, 3)), V)  # one sample fits the arrays, not four
    with pytest.raises(TypeError, match="takes 2 arguments"):
        step(Q)
    with pytest.raises(DtypeError):
        step(Q * 1j, V)


@pytest.mark.parametrize(
    ("wrong", "error", "said"),
    [
        (lambda a, b, c: (a, b), InputError, "3 outputs"),
        (lambda a, b, c: (a, b, c[:2]), ShapeError, r"\(3,\)"),
        (lambda a, b, c: (a.astype(np.float32), b, c), DtypeError, "float32"),
        (lambda a, b, c: (a.T, b, c), InputError, "gaps|C-contiguous"),
        (lambda a, b, c: (a, b, a[0]), InputError, "share memory"),
        (lambda a, b, c: (a, b, [0.0, 0.0, 0.0]), InputError, "list"),
        (lambda a, b, c: (a, b, c.astype(">f8")), DtypeError, "f8"),
    ],
)
def test_arrays_that_cannot_be_bound(kernel, targets, wrong, error, said):
    with pytest.raises(error, match=said):
        kernel.into(*wrong(*targets))


def test_read_only_arrays_and_outputs_that_are_not_there_are_refused(kernel, targets):
    with pytest.raises(InputError, match="output 3"):
        kernel.into(*targets, returns=(3,))
    targets[2].flags.writeable = False
    with pytest.raises(InputError, match="read-only"):
        kernel.into(*targets)


@pytest.mark.parametrize("size", [1, 7, 8, 9, 16, 100])
def test_a_change_of_any_bit_that_is_watched_is_noticed(kernel, targets, size):
    live = np.arange(float(size))
    kept, other = live.copy(), np.zeros(0)
    step = kernel.into(*targets, watch=[(live, kept), (other, other.copy())], otherwise=_refused)
    assert step(Q, V) is None
    for k in range(size):
        for bit in (0, 31, 63):
            live.view(np.uint64)[k] ^= np.uint64(1) << np.uint64(bit)
            targets[2][:] = 0.0
            assert step(Q, V) == "refused"
            assert (targets[2] == 0.0).all()  # nothing was computed
            live.view(np.uint64)[k] = kept.view(np.uint64)[k]
            assert step(Q, V) is None
    if size > 1:
        live[:2] = -0.0, np.nan
        kept[:2] = live[:2]
        assert step(Q, V) is None
        live[0] = 0.0
        assert step(Q, V) == "refused"


def test_what_is_given_otherwise_gets_the_arguments(kernel, targets):
    step = kernel.into(*targets, otherwise=lambda *args: args)
    assert step(Q, V) is None
    assert step(1, "two") == (1, "two")
    assert step() == ()


def _with_gaps(x):
    """The same values in other layouts: columns, reversed, Fortran order, one value again and again."""
    wide = np.zeros([3 * n for n in x.shape])
    part = wide[tuple(slice(1, None, 3) for _ in x.shape)]
    part[...] = x
    backwards = x[tuple(slice(None, None, -1) for _ in x.shape)].copy()
    return part, backwards[tuple(slice(None, None, -1) for _ in x.shape)], np.asfortranarray(x)


@pytest.mark.parametrize("shape", [(1,), (3,), (16,), (3, 3), (4, 4), (2, 8), (16, 1), (1, 16)])
def test_small_arrays_with_gaps_are_taken_as_they_are(shape):
    x, y = np.random.default_rng(3).normal(size=(2, *shape))
    kernel = compile(lambda a, b: a - 2.0 * b, a=shape, b=shape)
    step = kernel.into(np.zeros(shape), returns=(0,), otherwise=_refused)
    wanted = x - 2.0 * y
    for a in (x, *_with_gaps(x)):
        for b in (y, *_with_gaps(y)):
            np.testing.assert_array_equal(step(a, b), wanted)
    same = np.broadcast_to(0.5, shape)
    np.testing.assert_array_equal(step(same, y), 0.5 - 2.0 * y)


def test_other_arrays_with_gaps_are_left_to_the_function():
    small = compile(lambda a: 2.0 * a, a=(3,)).into(np.zeros(3), returns=(0,), otherwise=_refused)
    column = np.zeros((3, 2))[:, 1]
    shifted = np.frombuffer(bytearray(8 * 6 + 1), dtype=float, offset=1)[::2]  # not aligned
    swapped = np.zeros(6, ">f8")[::2]
    for wrong in (np.zeros(8)[::2], np.zeros((3, 2))[:, 1:], column.astype(np.float32), shifted, swapped):
        assert small(wrong) == "refused"
    assert small(column).tolist() == [0.0, 0.0, 0.0]
    large = compile(lambda a: 2.0 * a, a=(17,)).into(np.zeros(17), returns=(0,), otherwise=_refused)
    assert large(np.zeros(34)[::2]) == "refused" and large(np.zeros(17)).tolist() == [0.0] * 17
    three = compile(lambda a: 2.0 * a, a=(2, 2, 2)).into(
        np.zeros((2, 2, 2)), returns=(0,), otherwise=_refused
    )
    assert three(np.zeros((2, 2, 2)).T) == "refused"


def test_views_of_the_target_are_read_before_it_is_written():
    x = np.arange(4.0)
    step = compile(lambda a: a[::-1] + 1.0, a=(4,)).into(x, otherwise=_refused)
    step(x[::-1])
    assert x.tolist() == [1.0, 2.0, 3.0, 4.0]


def test_watching_needs_somewhere_to_go_and_whole_words(kernel, targets):
    with pytest.raises(InputError, match="otherwise"):
        kernel.into(*targets, watch=[(Q, Q.copy())])
    for a, b in (
        (Q, Q[:2]),
        (Q[::2], Q[::2]),
        (np.zeros(3, np.int32), np.zeros(3, np.int32)),
        ([1.0], [1.0]),
    ):
        with pytest.raises(InputError, match=r"watch"):
            kernel.into(*targets, watch=[(a, b)], otherwise=_refused)


def test_bound_arrays_may_be_inputs():
    rng = np.random.default_rng(0)
    A = rng.normal(size=(12, 12))
    kernel = compile(lambda x: (A @ x, x[::-1] * 1.0), x=(12,))
    x, y = rng.normal(size=12), np.zeros(12)
    wanted = kernel(x)
    kernel.into(x, y)(x)
    assert _same((x, y), wanted)
    wanted = kernel(x)
    kernel.into(y, x)(x)
    assert _same((y, x), wanted)


def test_a_large_graph_may_write_over_its_inputs():
    A = np.random.default_rng(1).normal(size=(40, 40))
    kernel = compile(lambda x: A @ np.sin(A @ x), x=(40,))  # several functions and a scratch
    x = np.linspace(-1.0, 1.0, 40)
    wanted = kernel(x)
    kernel.into(x)(x)
    assert x.tolist() == wanted.tolist()


def test_single_precision_and_axes_of_length_0():
    kernel = compile(lambda q: (q * 0.5, q[:0]), np.float32, q=(4,))
    a, b = np.zeros(4, np.float32), np.zeros(0, np.float32)
    assert kernel.into(a, b, returns=(0, 1))(np.arange(4, dtype=np.float32))[0].dtype == np.float32
    assert a.tolist() == [0.0, 0.5, 1.0, 1.5]
    nothing = compile(lambda q: q * 0.5, q=(0,))
    assert nothing.into(np.zeros(0), returns=(0,))(np.zeros(0)).shape == (0,)


def test_a_checked_kernel_checks():
    kernel = compile(lambda q: q * 0.5, checked=True, unit_entries=((0, (0, 1)),), q=(3,))
    target = np.zeros(3)
    step = kernel.into(target)
    assert step(np.array([0.6, 0.8, 7.0])) is None
    with pytest.raises(NonFiniteError):
        step(np.array([0.6, 0.8, np.nan]))
    with pytest.raises(InputError, match="unit"):
        kernel(np.array([0.6, 0.9, 7.0]), out=target)
    assert target.tolist() == [0.3, 0.4, 3.5]


def test_bound_kernels_keep_what_they_need_and_free_it():
    kernel = compile(lambda q: q + 0.125, q=(3,))
    target, live = np.zeros(3), np.zeros(9)
    step = kernel.into(target, watch=[(live, live.copy())], otherwise=_refused)
    seen = [weakref.ref(x) for x in (step, kernel, target, live)]
    view = target[:]
    del kernel, target, live
    step.__dict__.clear() if hasattr(step, "__dict__") else None
    gc.collect()
    junk = [np.ones(3) for _ in range(1000)]
    assert step(Q) is None
    assert view.tolist() == (Q + 0.125).tolist()
    del step, junk, view
    gc.collect()
    assert [r() for r in seen] == [None] * 4


def test_calls_leave_no_references(kernel, targets):
    step = kernel.into(*targets, returns=(0, 1))
    quiet = kernel.into(*targets, otherwise=_refused)
    row = compile(lambda q: q * 2.0, q=(3,)).into(np.zeros(3), returns=(0,))
    watched = (None, np.dtype(float), np.ndarray, Q, V, step, quiet, row, kernel, *targets, _refused, targets)

    def rounds() -> None:
        for _ in range(300):
            step(Q, V)
            quiet(Q, V)
            quiet(Q)
            row(Q)
            kernel(Q, V, out=targets)
            step([1, 2, 3], V)

    def counts() -> list[int]:
        rounds()
        gc.collect()
        return [sys.getrefcount(w) for w in watched]

    def changes() -> int:
        before, after = counts(), counts()
        return max(abs(a - b) for a, b in zip(after, before, strict=True))

    assert (
        min(changes() for _ in range(3)) <= 5
    )  # threads that other tests left behind refer to None and to types, too


def test_threads_may_call_one_bound_kernel(kernel, targets):
    step = kernel.into(*targets, returns=(2,))
    wanted, wrong = kernel(Q, V)[2].tolist(), []

    def run() -> None:
        for _ in range(2000):
            if step(Q, V).tolist() != wanted:
                wrong.append(1)

    threads = [threading.Thread(target=run) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


@pytest.mark.parametrize("attempt", [pickle.dumps, copy.copy, copy.deepcopy])
def test_bound_kernels_are_not_copied(kernel, targets, attempt):
    with pytest.raises(TypeError, match="writes into arrays of this process"):
        attempt(kernel.into(*targets))


def test_without_the_fast_call_everything_is_the_same(tmp_path):
    """The tests of this file in an interpreter whose fast door is shut."""
    import os

    if os.environ.get("ULNA_FAST") == "0":
        pytest.skip("this is that interpreter")
    env = os.environ | {"ULNA_FAST": "0", "ULNA_CACHE": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", __file__],
        capture_output=True, text=True, env=env, timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:]


# trailing_inputs= ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slow", [False, True])
def test_trailing_inputs_are_read_as_they_are_at_the_call(kernel, targets, monkeypatch, slow):
    if slow:
        monkeypatch.setattr("ulna.compiler.runtime.bound_call.bound_type", lambda: None)
    v = V.copy()
    bound = kernel.into(*targets, returns=(1,), trailing_inputs=(v,))
    for factor in (1.0, 3.0):
        v *= factor
        assert bound(Q) == kernel(Q, v)[1]
        assert _same(targets, kernel(Q, v))
    assert bound([0.1, -0.7, 1.3]) == kernel(Q, v)[1]  # converted
    exact = kernel.into(*targets, trailing_inputs=(v,), otherwise=_refused)
    assert exact(Q) is None
    assert exact(Q, V) == exact() == exact(list(Q)) == "refused"


@pytest.mark.parametrize("name", ["last_inputs", "given"])
def test_former_names_of_trailing_inputs(kernel, targets, name):
    assert kernel.into(*targets, returns=(1,), **{name: (V,)})(Q) == kernel(Q, V)[1]
    with pytest.raises(InputError, match=f"`trailing_inputs` and `{name}`"):
        kernel.into(*targets, trailing_inputs=(V,), **{name: (V,)})


def test_trailing_inputs_are_kept_alive_and_checked(kernel, targets):
    bound = kernel.into(*targets, returns=(1,), trailing_inputs=(V + 0.0,))
    gc.collect()
    assert bound(Q) == kernel(Q, V)[1]
    for wrong in (np.zeros(6)[::2], [0.0, 0.0, 0.0], np.zeros(3, np.float32)):
        with pytest.raises(InputError, match="`v`"):
            kernel.into(*targets, trailing_inputs=(wrong,))
    with pytest.raises(ShapeError):
        kernel.into(*targets, trailing_inputs=(np.zeros(4),))
    with pytest.raises(InputError, match="3 inputs"):
        kernel.into(*targets, trailing_inputs=(Q, Q, V))


# holder= ------------------------------------------------------------------------------------------------------


class _Held:
    __slots__ = ("row",)

    def __init__(self):
        raise AssertionError("instances are made without it")


class _Part(_Held):
    __slots__ = ()


class _Two:
    __slots__ = ("a", "b")


@pytest.mark.parametrize("holder", [_Held, _Part])
@pytest.mark.parametrize("slow", [False, True])
def test_a_result_is_held_by_a_new_instance(kernel, targets, monkeypatch, slow, holder):
    if slow:
        monkeypatch.setattr("ulna.compiler.runtime.bound_call.bound_type", lambda: None)
    before = sys.getrefcount(holder)
    step = kernel.into(*targets, returns=(2,), holder=holder, otherwise=_refused)
    found = [step(Q, V) for _ in range(1000)]
    assert {type(x) for x in found} == {holder}
    assert len({id(x.row) for x in found}) == 1000
    assert all(_same((x.row,), kernel(Q, V)[2:]) for x in found)
    made = object.__new__(holder)
    made.row = np.zeros(3)
    assert sys.getrefcount(found[0].row) == sys.getrefcount(made.row)
    assert step(list(Q), V) == "refused"
    assert gc.is_tracked(found[0])
    del found, made, step
    gc.collect()
    assert sys.getrefcount(holder) == before


def test_an_instance_is_written_to_again_only_where_nobody_has_it():
    twice = compile(lambda q: 2.0 * q, q=(3,))
    step = twice.into(np.zeros(3), returns=(0,), holder=_Held)

    def value(k: int) -> list[float]:
        return (2.0 * k * Q).tolist()

    last = None
    for k in range(10):  # as in a loop of a user, who has the last one while the next is made
        x = step(k * Q)
        assert x.row.tolist() == value(k)
        assert last is None or (last is not x and last.row.tolist() == value(k - 1))
        last = x
    del last, x
    for k, keep in enumerate((lambda x: x.row, lambda x: x.row[1:], lambda x: memoryview(x.row)) * 2):
        kept = keep(step(k * Q))
        before = np.array(kept).tolist()
        others = [step((k + n) * Q) for n in range(2, 6)]
        assert np.array(kept).tolist() == before
        assert [x.row.tolist() for x in others] == [value(k + n) for n in range(2, 6)]
    refer = weakref.ref(step(Q).row)
    assert refer() is None or all(step(5.0 * Q).row is not refer() for _ in range(4))
    for change in (
        "row.flags.writeable = False",
        "row.shape = (3, 1)",
        "row = np.zeros(2)",
        "__class__ = _Part",
    ):
        scope = {"x": step(Q), "np": np, "_Part": _Part}
        exec(f"x.{change}", scope)
        changed = scope.pop("x")
        del changed
        made = [step(Q), step(Q), step(Q)]
        assert all(type(x) is _Held and x.row.shape == (3,) and x.row.flags.writeable for x in made)


def test_instances_that_are_written_to_again_go_with_the_kernel():
    step = compile(lambda q: 2.0 * q, q=(3,)).into(np.zeros(3), returns=(0,), holder=_Held)
    refer = weakref.ref(step(Q).row)
    del step
    gc.collect()
    assert refer() is None


@pytest.mark.parametrize("slow", [False, True])
def test_an_instance_stands_for_the_array_that_it_holds(kernel, targets, monkeypatch, slow):
    if slow:
        monkeypatch.setattr("ulna.compiler.runtime.bound_call.bound_type", lambda: None)
    exact = kernel.into(*targets, returns=(1,), holder=float, input_holders=(None, _Held), otherwise=_refused)
    held, part, empty = (object.__new__(kind) for kind in (_Held, _Part, _Held))
    held.row, part.row = V.copy(), V
    assert exact(Q, held) == kernel(Q, V)[1]
    assert exact(Q, V) == "refused"
    held.row[:] = 2.0
    assert exact(Q, held) == kernel(Q, held.row)[1]
    assert exact(held, V) == exact(Q, part) == exact(Q, empty) == "refused"
    for wrong in (V[:2], V[::-1], list(V), V.astype(np.float32), held):
        held.row = wrong
        assert exact(Q, held) == "refused"
    held.row = V
    plain = kernel.into(*targets, returns=(1,), input_holders=(_Held,))
    assert plain(held, V) == kernel(V, V)[1]
    assert plain(held, list(V)) == plain(V, V) == kernel(V, V)[1]  # converted


@pytest.mark.parametrize("holders", [(_Two,), (int,), (None, None, _Held)])
def test_classes_that_stand_for_no_array(kernel, targets, holders):
    with pytest.raises(InputError, match="input_holders"):
        kernel.into(*targets, input_holders=holders)
    with pytest.raises(InputError, match="input_holders"):
        kernel.into(*targets, trailing_inputs=(V,), input_holders=(None, _Held))


class _Open:
    pass


@pytest.mark.parametrize(
    ("holder", "returns"), [(_Two, (0,)), (_Open, (0,)), (int, (0,)), (_Held, (0, 2)), (_Held, ())]
)
def test_classes_that_hold_no_result(kernel, targets, holder, returns):
    with pytest.raises(InputError, match="holder"):
        kernel.into(*targets, returns=returns, holder=holder)


@pytest.mark.parametrize("slow", [False, True])
def test_one_number_is_a_number_of_python(kernel, targets, monkeypatch, slow):
    if slow:
        monkeypatch.setattr("ulna.compiler.runtime.bound_call.bound_type", lambda: None)
    found = kernel.into(*targets, returns=(1,), holder=float)(Q, V)
    assert type(found) is float and found == Q @ V
    truth = compile(lambda x: x - 1.0, x=()).into(np.zeros(()), returns=(0,), holder=bool)
    assert truth(2.0) is True and truth(1.0) is False
    before = sys.getrefcount(float)
    for _ in range(1000):
        kernel.into(*targets, returns=(1,), holder=float)(Q, V)
    gc.collect()
    assert sys.getrefcount(float) <= before + 5


@pytest.mark.parametrize("holder", [float, bool])
@pytest.mark.parametrize("returns", [(0,), (2,), (1, 1), ()])
def test_only_one_number_is_a_number_of_python(kernel, targets, holder, returns):
    with pytest.raises(InputError, match="a single float64"):
        kernel.into(*targets, returns=returns, holder=holder)


@pytest.mark.parametrize("slow", [False, True])
def test_nan_has_no_truth_value(monkeypatch, slow):
    if slow:
        monkeypatch.setattr("ulna.compiler.runtime.bound_call.bound_type", lambda: None)
    kernel = compile(lambda x: x - 1.0, x=())
    checked = kernel.into(np.zeros(()), returns=(0,), holder=bool, otherwise=_refused)
    assert checked(np.nan) == "refused" and checked(2.0) is True and checked(np.inf) is True
    alone = kernel.into(np.zeros(()), returns=(0,), holder=bool)
    with pytest.raises(NonFiniteError, match="NaN has no truth value: pass `otherwise`"):
        alone(np.nan)
    assert alone(1.0) is False
    as_float = kernel.into(np.zeros(()), returns=(0,), holder=float, otherwise=_refused)
    assert np.isnan(as_float(np.nan))


@pytest.mark.parametrize("slow", [False, True])
def test_numbers_that_a_checked_kernel_refuses_go_to_otherwise(monkeypatch, slow):
    if slow:
        monkeypatch.setattr("ulna.compiler.runtime.bound_call.bound_type", lambda: None)
    kernel = compile(lambda q: q * 0.5, checked=True, unit_entries=((0, (0, 1)),), q=(3,))
    step = kernel.into(np.zeros(3), otherwise=_refused)
    assert step(np.array([0.6, 0.8, 7.0])) is None
    assert step(np.array([0.6, 0.8, np.nan])) == step(np.array([0.6, 0.9, 7.0])) == "refused"


# condition= ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slow", [False, True])
def test_what_has_no_solution_goes_to_otherwise(monkeypatch, slow):
    if slow:
        monkeypatch.setattr("ulna.compiler.runtime.bound_call.bound_type", lambda: None)
    kernel = compile(lambda x: (2.0 * x, x[0] - x[1]), x=(2,))
    targets = np.zeros(2), np.zeros(())
    step = kernel.into(*targets, returns=(0,), condition=1, otherwise=_refused)
    assert step(np.array([3.0, 1.0])).tolist() == [6.0, 2.0]
    for refused in ([1.0, 1.0], [1.0, 2.0], [np.nan, 1.0]):
        assert step(np.array(refused)) == "refused"
        np.testing.assert_array_equal(targets[0], 2.0 * np.array(refused))
    assert step(np.array([3.0, 1.0])).tolist() == [6.0, 2.0]


@pytest.mark.parametrize(
    ("condition", "otherwise"), [(1, None), (2, _refused), (-1, _refused), (0, _refused)]
)
def test_conditions_that_cannot_be_examined(condition, otherwise):
    kernel = compile(lambda x: (2.0 * x, x[0] - x[1]), x=(2,))
    with pytest.raises(InputError, match="condition"):
        kernel.into(np.zeros(2), np.zeros(()), condition=condition, otherwise=otherwise)
