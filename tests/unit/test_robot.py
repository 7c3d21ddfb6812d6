"""A robot answers by name, in batches, and complains helpfully."""

from __future__ import annotations

import copy
import functools
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import ulna
from ulna import algorithms, kernels
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError, TraceError, UnknownName
from ulna.model import ModelBuilder, PointContact, Revolute


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture(scope="module")
def qr(panda: ulna.Robot) -> np.ndarray:
    return panda.configurations["qr"]


def test_fk_of_the_tool_as_recorded(panda: ulna.Robot, qr: np.ndarray) -> None:
    T = panda.fk(qr)
    np.testing.assert_allclose(T[:3, 3], [0.48404681539304417, 0.0, 0.4126297754623028], atol=1e-15)
    np.testing.assert_allclose(T[0, :3], [0.9950041652780257, 0.0, 0.09983341664682799], atol=1e-15)


@pytest.mark.parametrize("name", kernels.QUANTITIES)
def test_every_kernel_equals_its_algorithm_on_floats_and_in_batches(panda: ulna.Robot, name: str) -> None:
    rng = np.random.default_rng(3)
    quantity = kernels.QUANTITIES[name]
    size = {"nq": panda.nq, "nv": panda.nv}
    chosen = {"constraints": (PointContact("panda_hand"),)} if "constraints" in quantity.options else {}
    options = {**quantity.options, **chosen}
    arguments = quantity.arguments(options)
    shapes = [tuple(size.get(n, n) for n in ((s,) if isinstance(s, str) else s)) for _, s in arguments]
    batch = [rng.uniform(0.1, 1.0, (13, *shape)) for shape in shapes]
    plain = quantity.build(panda.model, **options)
    kernel = panda.kernel(name, **chosen)
    expected = plain(*batch)
    got = kernel(*batch)
    one = kernel(*(b[4] for b in batch))
    pairs = zip(expected, got, one, strict=True) if isinstance(expected, tuple) else [(expected, got, one)]
    for e, g, o in pairs:
        np.testing.assert_allclose(g, e, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(o, e[4], rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize(
    ("method", "count"),
    [
        ("fk", 1),
        ("link_poses", 1),
        ("jacobian", 1),
        ("jacobian_dot", 2),
        ("hessian", 1),
        ("frame_velocity", 2),
        ("frame_acceleration", 3),
        ("analytical_jacobian", 1),
        ("manipulability", 1),
        ("manipulability_gradient", 1),
        ("integrate", 2),
        ("difference", 2),
        ("configuration_distance", 2),
        ("normalize", 1),
    ],
)
def test_every_method_takes_batches_and_refuses_nan(panda: ulna.Robot, method: str, count: int) -> None:
    rng = np.random.default_rng(4)
    arrays = [rng.uniform(0.1, 1.0, (2, 3, panda.nq)) for _ in range(count)]
    f = getattr(panda, method)
    whole = f(*arrays)
    np.testing.assert_allclose(whole[1, 2], f(*(a[1, 2] for a in arrays)), rtol=1e-12, atol=1e-13)
    arrays[-1][0, 1, 2] = np.nan
    with pytest.raises(NonFiniteError, match=r"\[0, 1, 2\]` is nan"):
        f(*arrays)
    with pytest.raises(NonFiniteError, match=r"\[2\]` is nan"):
        f(*(a[0, 1] for a in arrays))


def test_other_measures_of_manipulability(panda: ulna.Robot, qr: np.ndarray) -> None:
    s = np.linalg.svd(panda.jacobian(qr), compute_uv=False)
    assert panda.manipulability(qr) == pytest.approx(np.prod(s), rel=1e-12)
    assert panda.manipulability(qr) == pytest.approx(0.0837515096811334, rel=1e-12)
    assert panda.manipulability(qr, "inverse_condition") == pytest.approx(s[-1] / s[0], rel=1e-12)
    assert panda.manipulability(qr, "minimum_singular_value") == pytest.approx(s[-1], rel=1e-12)
    with pytest.raises(UnknownName, match="yoshikawa"):
        panda.manipulability(qr, "yoshikava")


def test_frames_by_name_list_and_all(panda: ulna.Robot, qr: np.ndarray) -> None:
    two = panda.fk(qr, ["panda_hand", "panda_link4"])
    np.testing.assert_allclose(two[0], panda.fk(qr, "panda_hand"), atol=1e-15)
    assert panda.fk(qr, "all").shape == (len(panda.frame_names), 4, 4)
    assert panda.link_poses(qr).shape == (len(panda.link_names), 4, 4)


def test_names_that_do_not_exist_offer_the_nearest(panda: ulna.Robot, qr: np.ndarray) -> None:
    with pytest.raises(UnknownName, match="Did you mean 'panda_hand'") as caught:
        panda.fk(qr, "panda_hnd")
    assert caught.value.nearest == "panda_hand"
    with pytest.raises(UnknownName, match="'local'"):
        panda.jacobian(qr, reference="locl")  # type: ignore[arg-type]
    with pytest.raises(UnknownName, match="'jacobian'"):
        panda.kernel("jacobain")
    with pytest.raises(UnknownName, match="'frame'"):
        panda.kernel("fk", fram="panda_hand")
    with pytest.raises(UnknownName, match="rpy/xyz"):
        panda.analytical_jacobian(qr, "rpy/xzy")


@pytest.mark.parametrize(
    ("q", "error", "text"),
    [
        (
            np.zeros(6),
            ShapeError,
            r"`q` has shape \(6,\); expected \(..., 7\). The last axis holds the 7 numbers",
        ),
        (np.zeros((7, 3)), ShapeError, r"\(7, 3\); expected \(..., 7\). The batch axis comes first"),
        (0.0, ShapeError, r"`q` has shape \(\)"),
        (["a"] * 7, DtypeError, "`q` has dtype <U1; expected real numbers"),
        ([1j] * 7, DtypeError, "complex128"),
        (None, DtypeError, "`q` has dtype object"),
        ([np.inf, 0, 0, 0, 0, 0, 0], NonFiniteError, r"`q\[0\]` is inf; expected finite numbers"),
        ([[0, 1], [2]], InputError, r"different lengths; expected \(..., 7\)"),
    ],
)
def test_wrong_configurations_are_refused(
    panda: ulna.Robot, q: object, error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        panda.fk(q)  # type: ignore[arg-type]


def test_lists_integers_and_float32_are_configurations(panda: ulna.Robot) -> None:
    expected = panda.fk(np.array([0.0, 1, 0, -1, 0, 1, 0]))
    for q in (
        [0, 1, 0, -1, 0, 1, 0],
        (0.0, 1.0, 0, -1, 0, 1, 0),
        np.array([0, 1, 0, -1, 0, 1, 0], np.float32),
    ):
        np.testing.assert_array_equal(panda.fk(q), expected)


def test_equal_robots_share_kernels_and_survive_pickle_and_copy(panda: ulna.Robot, qr: np.ndarray) -> None:
    for twin in (pickle.loads(pickle.dumps(panda)), copy.deepcopy(panda), ulna.Robot(panda.model)):
        assert twin == panda and hash(twin) == hash(panda)
        assert twin.kernel("fk") is panda.kernel("fk")
        np.testing.assert_array_equal(twin.fk(qr), panda.fk(qr))


def test_bare_kernels_let_nan_through_and_show_themselves(panda: ulna.Robot, qr: np.ndarray) -> None:
    fk = panda.kernel("fk", frame="panda_hand")
    assert np.isnan(fk(np.full(7, np.nan))[:3, 3]).all()
    assert fk.operations == sum(fk.operation_counts.values()) < 200
    assert "define" in fk.ir() and "panda" in (fk.function.doc or "")
    assert fk.signature == "(7)->(4,4)"
    single = panda.kernel("fk", dtype=np.float32)
    assert single(qr.astype(np.float32)).dtype == np.float32
    np.testing.assert_allclose(single(qr.astype(np.float32)), panda.fk(qr), atol=1e-6)


def test_out_and_threads(panda: ulna.Robot) -> None:
    Q = panda.random_configuration(5000, seed=0)
    out = np.empty((5000, 4, 4))
    assert panda.fk(Q, out=out) is out
    np.testing.assert_array_equal(panda.fk(Q, threads=2), out)
    with ThreadPoolExecutor(4) as pool:
        for result in pool.map(panda.fk, [Q] * 8):
            np.testing.assert_array_equal(result, out)


def test_random_configurations_are_within_limits_and_repeat(panda: ulna.Robot) -> None:
    Q = panda.random_configuration((10, 20), seed=7)
    assert Q.shape == (10, 20, 7)
    assert panda.limits.contains(Q).all()
    np.testing.assert_array_equal(Q, panda.random_configuration((10, 20), seed=7))
    assert not panda.limits.contains(Q + 10.0).any()
    assert panda.limits.contains(panda.limits.clip(Q + 10.0)).all()


def test_limits_take_configurations_only(panda: ulna.Robot, qr: np.ndarray) -> None:
    assert panda.limits.contains(list(qr)) and panda.limits.contains(qr.astype(np.float32))
    assert not panda.limits.contains(qr + np.nan)
    for wrong in (0.5, [0.5], np.zeros((7, 1)), np.zeros(3)):
        for call in (panda.limits.contains, panda.limits.clip):
            with pytest.raises(ShapeError, match=r"`q` has shape \(.*\); expected \(\.\.\., 7\)"):
                call(wrong)
    with pytest.raises(NonFiniteError, match=r"`q\[1, 2\]` is nan"):
        panda.limits.clip([qr, np.where(np.arange(7) == 2, np.nan, qr)])
    np.testing.assert_array_equal(panda.limits.clip(np.full(7, np.inf)), panda.limits.upper)
    for what in (qr + 1j, [None] * 7, ["1"] * 7):
        with pytest.raises(DtypeError, match="`q`"):
            panda.limits.clip(what)
    with pytest.raises(InputError, match="masked"):
        panda.limits.contains(np.ma.array(qr, mask=qr == qr[0]))
    for slack in (np.nan, np.ones(7), "a"):
        with pytest.raises(InputError, match="`tolerance`"):
            panda.limits.contains(qr, slack)  # type: ignore[arg-type]
    with pytest.raises(TraceError, match="^A traced value has no number yet"):
        ulna.compile(lambda q: panda.limits.clip(q), q=(7,))


def test_infinite_positions_of_joints_without_limits_are_refused() -> None:
    """They would remain infinite."""
    builder = ModelBuilder("wheel").add_link("frame").add_link("rim")
    wheel = ulna.Robot(builder.add_joint("turns", Revolute((0, 0, 1)), "frame", "rim").build())
    assert np.isinf(wheel.limits.upper).all() and wheel.limits.clip([3.0]) == 3.0
    with pytest.raises(NonFiniteError, match=r"`q\[0\]` is inf"):
        wheel.limits.clip([np.inf])


def test_compile_a_function_of_the_robot(panda: ulna.Robot, qr: np.ndarray) -> None:
    def distance_to(q: np.ndarray, target: np.ndarray) -> np.ndarray:
        d = panda.fk(q)[:3, 3] - target
        return np.sqrt(d @ d)

    f = ulna.compile(distance_to, panda, target=(3,))
    target = np.array([0.1, 0.2, 0.3])
    assert f(qr, target) == pytest.approx(np.linalg.norm(panda.fk(qr)[:3, 3] - target), rel=1e-14)
    gradient = f.jacobian()(qr, target)
    h = 1e-6
    numeric = [(f(qr + h * e, target) - f(qr - h * e, target)) / (2 * h) for e in np.eye(7)]
    np.testing.assert_allclose(gradient, numeric, atol=1e-8)
    with pytest.raises(UnknownName, match=r"compile\(f, robot, target=\(3,\)\)"):
        ulna.compile(distance_to, panda)
    with pytest.raises(UnknownName, match="or pass the robot"):
        ulna.compile(distance_to)


def test_a_free_flyer_has_more_positions_than_velocities() -> None:
    robot = ulna.load("panda", visuals="simple", root="free_flyer")
    assert (robot.nq, robot.nv) == (14, 13)
    q = robot.random_configuration(seed=1)
    v = 0.5 * np.random.default_rng(2).normal(size=robot.nv)
    np.testing.assert_allclose(robot.difference(q, robot.integrate(q, v)), v, atol=1e-12)
    np.testing.assert_allclose(robot.frame_velocity(q, v), robot.jacobian(q) @ v, atol=1e-12)
    assert robot.is_same_configuration(q, robot.normalize(q)) and not robot.is_same_configuration(
        q, robot.neutral
    )
    assert robot.squared_distance(q, robot.integrate(q, v)) == pytest.approx(v @ v, rel=1e-12)
    by_q, by_v = robot.integrate_derivatives(q, v)
    by_q0, by_q1 = robot.difference_derivatives(q, robot.integrate(q, v))
    np.testing.assert_allclose(by_q1 @ by_v, np.eye(robot.nv), atol=1e-10)  # difference undoes integrate
    np.testing.assert_allclose(by_q1 @ by_q, -by_q0, atol=1e-10)
    middle = robot.interpolate(q, robot.integrate(q, v), np.linspace(0, 1, 5))
    np.testing.assert_allclose(middle[-1], robot.integrate(q, v), atol=1e-12)


def test_prints(panda: ulna.Robot) -> None:
    assert "panda_joint4" in str(panda) and "@panda_hand_tcp" in str(panda)
    assert repr(panda) == "<robot 'panda': 7 joints, nq=7, nv=7, tool 'panda_hand_tcp'>"
    assert algorithms.neutral(panda.model).shape == panda.neutral.shape


def test_a_quaternion_that_is_not_unit_is_refused_and_normalised(panda: ulna.Robot) -> None:
    robot = ulna.load("panda", visuals="simple", root="free_flyer")
    q = robot.random_configuration(seed=3)
    long = q.copy()
    long[3:7] *= 3.0
    for given in (long, np.stack([q, long])):
        with pytest.raises(InputError, match=r"`q\[..., 3:7\]` has length 3; expected a unit quaternion"):
            robot.fk(given)
    with pytest.raises(InputError, match="`q1"):
        robot.difference(q, long)
    np.testing.assert_allclose(robot.normalize(long), q, atol=1e-15)
    for noise in np.linspace(3e-6, 7e-6, 17):  # around the tolerance both doors agree
        nearly = q.copy()
        nearly[3:7] *= 1.0 + noise
        try:
            robot.fk(nearly)
        except InputError:
            assert noise > 4e-6
    long[3:7] = 0.0
    with pytest.raises(InputError, match="length 0"):
        robot.normalize(long)


def test_what_is_no_robot_frame_size_or_dtype_is_refused(panda: ulna.Robot, qr: np.ndarray) -> None:
    with pytest.raises(InputError, match="expected the name of one frame"):
        panda.jacobian(qr, ["panda_hand"])  # type: ignore[arg-type]
    with pytest.raises(InputError, match="expected a Robot"):
        panda.attach(panda.model)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="expected a Robot"):
        ulna.compile(lambda q: q, "panda")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="expected a count"):
        panda.random_configuration(-1)
    with pytest.raises(InputError, match="expected a count"):
        panda.random_configuration(2.5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="expected names in a list"):
        panda.lock(None)  # type: ignore[arg-type]
    with pytest.raises(DtypeError, match="float64 or float32"):
        panda.kernel("fk", dtype="foo")


def test_arguments_with_defaults_keep_them() -> None:
    assert ulna.compile(lambda x, k=2.0: x * k, x=(3,))(np.ones(3)).tolist() == [2.0, 2.0, 2.0]
    assert ulna.compile(lambda x, k=2.0: x * k, x=(3,), k=())(np.ones(3), 5.0).tolist() == [5.0, 5.0, 5.0]


def test_arguments_behind_one_that_keeps_its_default_have_their_own_values(panda: ulna.Robot) -> None:
    x, y, q = np.array([1.0, 2.0, 3.0]), np.array([10.0, 20.0, 30.0]), panda.configurations["qr"]

    def between(x, k=2.0, y=0.0):
        return k * x + y

    def only_here(x, k=2.0, /, y=0.0):
        return k * x + y

    def by_name(x, *, k=2.0, y):
        return k * x + y

    def with_more(x, k=2.0, *rest, y=0.0, **more):
        return k * x + y + len(rest) + len(more)

    for f in (between, only_here, by_name, with_more):
        assert ulna.compile(f, x=(3,), y=(3,))(x, y).tolist() == f(x, y=y).tolist(), f.__name__
        assert ulna.compile(f, y=(3,), x=(3,)).jacobian("y")(x, y).tolist() == np.eye(3).tolist(), f.__name__
    target = ulna.compile(lambda q, weight=2.0, target=None: weight * (q - target), panda, target=(7,))
    np.testing.assert_allclose(target(q, np.ones(7)), 2.0 * (q - 1.0))
    unnamed = functools.partial(lambda w, x, k=2.0, y=0.0: k * x + y - w, 0.0)
    for shapes in ({"x": (3,)}, {"x": (3,), "y": (3,)}):
        assert ulna.compile(unnamed, **shapes).function.name == "function"
    with pytest.raises(UnknownName, match="argument of the function named 'more'"):
        ulna.compile(with_more, x=(3,), more=(3,))
    with pytest.raises(InputError, match="an argument 'dtype', as compile itself has"):
        ulna.compile(lambda dtype: dtype)
    with pytest.raises(InputError, match="does not know the arguments of"):
        ulna.compile(dict, x=(3,))


def test_asada_is_the_roundness_of_the_inertia_at_the_tool(panda: ulna.Robot) -> None:
    Q = panda.random_configuration(5, seed=5)
    got = panda.manipulability(Q, "asada", "trans")
    for q, value in zip(Q, got, strict=True):
        inverse = np.linalg.pinv(panda.jacobian(q))
        e = np.linalg.eigvalsh((inverse.T @ panda.mass_matrix(q) @ inverse)[:3, :3])
        assert value == pytest.approx(e[0] / e[-1], rel=1e-9)
    assert ((got >= 0.0) & (got <= 1.0)).all()
