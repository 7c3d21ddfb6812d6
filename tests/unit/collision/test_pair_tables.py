"""Tables of proved clearance: never above coal's distance, and what checks and plans make of them."""

from __future__ import annotations

import itertools
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import algorithms
from ulna.collision import Checker, SphereChecker, World
from ulna.collision.convex_pieces import convex_pieces
from ulna.collision.covering import solids_by_link
from ulna.collision.joint_chains import joint_chain
from ulna.collision.link_points import solid_points
from ulna.collision.pair_tables import UNPROVED, PairTable, decoded, encoded, pair_table
from ulna.collision.solids import Solid, hull
from ulna.collision.table_choice import pair_tables
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Geometry, Mesh, Plane, PointCloud, Sphere
from ulna.model import Model, ModelBuilder, Prismatic, Revolute
from ulna.planning import Planner
from ulna.robots import example_robot_data
from ulna.spatial import SE3
from ulna.typing import Floats

pytest.importorskip("coal")
ConvexHull = pytest.importorskip("scipy.spatial").ConvexHull


@pytest.fixture(scope="module")
def machine() -> Model:
    """Joints that turn without limits, within limits and slide, and two fingers, of which one follows the other."""
    builder = ModelBuilder("machine")
    builder.add_link("base", collisions=(Geometry("", Box((0.3, 0.2, 0.1))),))
    builder.add_link(
        "post", collisions=(Geometry("", Cylinder(0.05, 0.3), SE3.from_translation([0.1, 0, 0.2])),)
    )
    builder.add_link(
        "beam", collisions=(Geometry("", Capsule(0.04, 0.4), SE3.from_translation([0, 0, 0.25])),)
    )
    builder.add_link(
        "sled", collisions=(Geometry("", Box((0.1, 0.15, 0.05)), SE3.from_translation([0.08, 0, 0])),)
    )
    builder.add_link(
        "hook", collisions=(Geometry("", Ellipsoid((0.02, 0.05, 0.09)), SE3.from_translation([0, 0.1, 0])),)
    )
    for name, side in (("left", 1.0), ("right", -1.0)):
        shapes = (
            Geometry("", Cone(0.02, 0.08), SE3.from_translation([0, 0, 0.05])),
            Geometry("", Sphere(0.015)),
        )
        builder.add_link(name, collisions=shapes)
        where = SE3.from_translation([0.02 * side, 0.0, 0.15])
        more: dict[str, Any] = {} if name == "left" else {"mimic": ("left_j", -1.0, 0.1)}
        builder.add_joint(
            f"{name}_j", Revolute((0, 1, 0)), "hook", name, where, lower=-0.6, upper=0.9, **more
        )
    builder.add_joint("turn", Revolute((0, 0, 1)), "base", "post", SE3.from_translation([0, 0, 0.06]))
    builder.add_joint(
        "nod", Revolute((0, 1, 0)), "post", "beam", SE3.from_translation([0, 0, 0.3]), lower=-2.5, upper=2.0
    )
    builder.add_joint("slide", Prismatic((0, 0, 1)), "beam", "sled", lower=-0.1, upper=0.3)
    builder.add_joint(
        "twist",
        Revolute((1, 0, 0)),
        "sled",
        "hook",
        SE3.from_translation([0.15, 0, 0]),
        lower=-7.0,
        upper=7.0,
    )
    return builder.build()


def made(model: Model, pair: tuple[str, str], queries: int = 20_000) -> PairTable:
    chain = joint_chain(model, *pair)
    assert chain is not None
    first, second = (convex_pieces(solids_by_link(model)[name]) for name in pair)
    table = pair_table(model, pair, chain, (first, second), queries, lambda: None)
    assert table is not None
    return table


def configurations(model: Model, table: PairTable, count: int) -> Floats:
    """Random ones, some at borders of cells and limits, some whole turns away where that is within the limits."""
    rng = np.random.default_rng(4)
    low = np.where(np.isfinite(model.lower_position), model.lower_position, -9.0)
    high = np.where(np.isfinite(model.upper_position), model.upper_position, 9.0)
    q = rng.uniform(low, high, (count, model.nq))
    for axis, column in enumerate(table.columns):
        cells = rng.integers(0, table.codes.shape[axis] + 1, count // 3)
        border = table.low[axis] + cells * table.span[axis] / table.codes.shape[axis]
        rows = rng.permutation(count)[: count // 3]
        q[rows, column] = border + rng.choice([-1e-7, 0.0, 1e-7], len(rows))
        q[rng.permutation(count)[:20], column] = low[column]
        q[rng.permutation(count)[:20], column] = high[column]
    return np.clip(q, low, high)


def assert_proved(model: Model, table: PairTable, count: int = 1500) -> tuple[Floats, Floats]:
    q = configurations(model, table, count)
    exact = Checker(model, pairs=[(table.first, table.second)]).distance(q).distance
    clearance = table.clearance(q)
    positive = clearance > 0.0
    assert (clearance[positive] <= exact[positive]).all()
    return clearance, exact


PAIRS = [
    ("base", "beam"), ("beam", "post"), ("post", "sled"), ("base", "sled"), ("beam", "hook"), ("beam", "left"),
    ("right", "sled"), ("left", "right"), ("post", "hook"),
]  # fmt: skip


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: "-".join(pair))
def test_clearances_are_never_above_the_distance(machine: Model, pair: tuple[str, str]) -> None:
    table = made(machine, pair)
    clearance, exact = assert_proved(machine, table)
    far = exact > 0.08
    assert not far.any() or (clearance[far] > 0.0).mean() > 0.97  # and they say something


@pytest.mark.skipif(example_robot_data.share_folder() is None, reason="example-robot-data")
def test_tables_of_meshes_are_proved() -> None:
    model = ulna.load("ur3").model
    pieces = convex_pieces(solids_by_link(model)["wrist_1_link"])
    assert 1 < len(pieces) <= 16 and all(len(piece.vertices) for piece in pieces)
    clearance, exact = assert_proved(model, made(model, ("upper_arm_link", "wrist_1_link")), 400)
    assert (clearance[exact > 0.01] > 0.0).mean() > 0.98


def test_convex_pieces_contain_a_surface() -> None:
    """A U of three plates, and a flat triangle."""
    plates = [
        ((0.0, 0.0, 0.0), (0.2, 0.1, 0.01)),
        ((0.0, 0.0, 0.0), (0.01, 0.1, 0.15)),
        ((0.19, 0.0, 0.0), (0.2, 0.1, 0.15)),
    ]
    corners = [np.array(list(itertools.product(*zip(low, high, strict=True)))) for low, high in plates]
    hulls = [hull(points) for points in corners]
    triangles = np.concatenate([points[faces] for points, faces in hulls])
    flat = np.array([[[0.5, 0.0, 0.0], [0.6, 0.0, 0.0], [0.5, 0.1, 0.0]]])
    for surface, count in ((triangles, 3), (flat, 1)):
        vertices = surface.reshape(-1, 3)
        faces = np.arange(len(vertices)).reshape(-1, 3)
        pieces = convex_pieces([Solid("u", Mesh("u.stl"), -1, SE3.identity(), vertices, faces)])
        assert len(pieces) >= count
        weights = np.random.default_rng(0).dirichlet(np.ones(3), (50, len(surface)))
        points = np.einsum("nkc,kcx->nkx", weights, surface).reshape(-1, 3)
        inside = np.zeros(len(points), dtype=bool)
        for piece in pieces:
            a, b, c = (piece.vertices[piece.triangles[:, k]] for k in range(3))
            n = np.cross(b - a, c - a)
            n /= np.maximum(np.linalg.norm(n, axis=1), 1e-300)[:, None]
            inside |= ((points @ n.T - (a * n).sum(axis=1)) <= 1e-9).all(axis=1)
        assert inside.all()
    volume = sum(
        float(ConvexHull(piece.vertices).volume)
        for piece in convex_pieces(
            [
                Solid(
                    "u",
                    Mesh("u.stl"),
                    -1,
                    SE3.identity(),
                    triangles.reshape(-1, 3),
                    np.arange(3 * len(triangles)).reshape(-1, 3),
                )
            ]
        )
    )
    assert volume < 0.35 * 0.2 * 0.1 * 0.15


def test_fingers_that_follow_one_joint_have_one_axis(machine: Model) -> None:
    table = made(machine, ("left", "right"))
    assert len(table.columns) == 1 and machine.joint("left_j").idx_q in table.columns


def test_jaws_that_slide_are_compared_by_tables() -> None:
    """Joints that only slide leave the rotation between links as it is; spheres of long boxes touch long before these do."""
    builder = ModelBuilder("jaws").add_link("base")
    for name, side in (("left", 1.0), ("right", -1.0)):
        builder.add_link(name, collisions=(Geometry("", Box((0.3, 0.02, 0.3))),))
        axis, place = (0.0, side, 0.0), SE3.from_translation([0.0, 0.02 * side, 0.0])
        builder.add_joint(f"{name}_j", Prismatic(axis), "base", name, place, lower=-0.02, upper=0.1)
    model = builder.build()
    q = np.random.default_rng(0).uniform(-0.02, 0.1, (500, 2))
    touches = ulna.Robot(model).collides(q, method="spheres")
    exact = q.sum(axis=1) <= -0.02
    assert touches[exact].all() and touches[~exact].mean() < 0.3
    assert_proved(model, made(model, ("left", "right")))


def test_whole_turns_change_nothing_and_limits_end_the_table(machine: Model) -> None:
    table = made(machine, ("beam", "hook"))
    twist, slide = machine.joint("twist").idx_q, machine.joint("slide").idx_q
    assert table.is_periodic[table.columns.index(twist)] and not table.is_periodic[table.columns.index(slide)]
    q = np.zeros((200, machine.nq))
    q[:, twist], q[:, slide] = np.linspace(-0.7, 0.7, 200), 0.3
    around = q.copy()
    around[:, twist] += 2.0 * np.pi
    np.testing.assert_allclose(table.clearance(q), table.clearance(around), atol=2e-3)
    q[:, slide] = 0.31
    assert (table.clearance(q) == UNPROVED).all()
    around[:, twist] += 2.0 * np.pi
    assert (table.clearance(around) == UNPROVED).all()


def test_numbers_on_disk_are_rounded_downwards() -> None:
    lengths = np.concatenate([[-0.1, -0.011, 0.0, 1e-5], np.geomspace(1e-4, 1.3, 500), [50.0]])
    back = decoded(encoded(lengths))
    assert back[0] == UNPROVED and (back <= lengths).all()
    middle = slice(60, -1)
    assert (back[1:-1] > 0.95 * lengths[1:-1] - 2.6e-4 - 0.05 * abs(lengths[1:-1])).all()
    assert (back[middle] > 0.95 * lengths[middle] - 2.6e-4).all()


def test_an_arm_that_hangs_beside_the_body_is_proved_to_be_apart() -> None:
    """Three joints, 8 mm of air at rest: the slopes of cells say what their size does not."""
    builder = ModelBuilder("shoulder")
    builder.add_link("torso", collisions=(Geometry("", Box((0.2, 0.2, 0.5))),))
    for name in ("pitch", "roll"):
        builder.add_link(name)
    place = SE3.from_translation([0.0, 0.0, -0.15])
    builder.add_link("arm", collisions=(Geometry("", Capsule(0.04, 0.2), place),))
    where = SE3.from_translation([0.0, 0.148, 0.2])
    builder.add_joint("a", Revolute((0, 1, 0)), "torso", "pitch", where, lower=-3.0, upper=2.6)
    builder.add_joint("b", Revolute((1, 0, 0)), "pitch", "roll", lower=-1.6, upper=2.2)
    builder.add_joint("c", Revolute((0, 0, 1)), "roll", "arm", lower=-2.6, upper=2.6)
    model = builder.build()
    table = made(model, ("torso", "arm"), 60_000)
    assert_proved(model, table, 3000)
    rng = np.random.default_rng(2)
    q = rng.uniform(-0.03, 0.03, (500, 3))
    exact = Checker(model, pairs=[("torso", "arm")]).distance(q).distance
    lost = exact - table.clearance(q)
    assert (lost >= 0.0).all() and np.quantile(lost[exact > 0.004], 0.9) < 0.004


# checks ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ur5() -> SphereChecker:
    return SphereChecker(ulna.load("ur5").model)


def test_fewer_configurations_touch_unduly_and_none_is_missed(ur5: SphereChecker) -> None:
    model = ur5.model
    q = algorithms.random(model, np.random.default_rng(1), (600,))
    exact = Checker(model).collides(q)
    by_tables, by_spheres = ur5.collides(q), SphereChecker(model, tables=False).collides(q)
    assert not (exact & ~by_tables).any()
    assert (by_tables & ~exact).mean() < 0.06
    assert (by_spheres & ~exact).mean() > 0.2


def test_all_ways_to_ask_agree(ur5: SphereChecker) -> None:
    q = algorithms.random(ur5.model, np.random.default_rng(2), (300,))
    for margin in (0.0, 0.004, 0.1):
        together = ur5.collides(q, margin=margin)
        np.testing.assert_array_equal(together, [ur5.collides(row, margin=margin) for row in q])
        np.testing.assert_array_equal(together, ur5.clearance(q) <= margin + 1e-6)
    distance = Checker(ur5.model).distance(q).distance
    clearance = ur5.clearance(q)
    assert (clearance[clearance > 0.0] <= distance[clearance > 0.0] + 1e-6).all()
    lazy = pytest.importorskip("dask.array").from_array(q, chunks=(100, 6))
    np.testing.assert_array_equal(ur5.collides(lazy).compute(), ur5.collides(q))


def test_world_margins_count(ur5: SphereChecker) -> None:
    for pair in (("wrist_2_link", "forearm_link"), ("base_link", "upper_arm_link")):
        world = World().set_margin(*pair, 0.006)
        kept = SphereChecker(ur5.model, world)
        q = algorithms.random(ur5.model, np.random.default_rng(3), (300,))
        exact = Checker(ur5.model, world).collides(q)
        together = kept.collides(q)
        assert not (exact & ~together).any() and not together.all()
        np.testing.assert_array_equal(together, [kept.collides(row) for row in q])
        np.testing.assert_array_equal(together, kept.clearance(q) <= 1e-6)


def test_given_spheres_are_taken_as_they_are_and_copies_keep_tables(ur5: SphereChecker) -> None:
    assert ur5.tables and not SphereChecker(ur5.model, spheres=ur5.spheres).tables
    assert SphereChecker(ur5.model, spheres=ur5.spheres, tables=True).tables == ur5.tables
    assert "8 tables" in repr(ur5)
    copy = pickle.loads(pickle.dumps(ur5))
    assert len(copy.tables) == len(ur5.tables)
    assert "forearm_link" in repr(ur5.tables)


def test_outside_the_limits_spheres_decide(ur5: SphereChecker) -> None:
    q = np.zeros(6)
    q[4] = 3 * np.pi
    plain = SphereChecker(ur5.model, tables=False)
    for turn in np.linspace(0.0, 6.0, 40):
        q[3] = turn
        assert ur5.collides(q) == plain.collides(q)


def test_corners_of_cells_near_contact_are_proved(ur5: SphereChecker) -> None:
    rng = np.random.default_rng(11)
    for table in ur5.tables:
        values, middle = table.values, table.values[..., 0]
        near = np.argwhere((middle > -0.003) & (middle < 0.006))
        cells = near[rng.integers(0, len(near), 300)]
        side = rng.integers(0, 2, cells.shape)
        part = (cells + side) / np.array(middle.shape)
        q = np.zeros((300, 6))
        q[:, list(table.columns)] = table.low + part * table.span
        exact = Checker(ur5.model, pairs=[(table.first, table.second)]).distance(q).distance
        proved = values[tuple(cells.T)]
        at_corner = proved[:, 0] + ((2 * side - 1) * proved[:, 1:]).sum(axis=1)
        is_positive = at_corner > 0.0
        assert is_positive.any() and (at_corner <= exact)[is_positive].all()


def test_tables_are_kept_on_disk_and_made_again_after_an_interruption(
    machine: Model, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from ulna.collision import table_choice

    monkeypatch.setenv("ULNA_CACHE", str(tmp_path))
    checker = SphereChecker(machine, tables=False)
    arguments = machine, checker.spheres, checker.pairs, "error"
    pair_tables.cache_clear()
    real, calls = table_choice.pair_table, itertools.count(1)

    def interrupted(*parts: Any) -> Any:
        if next(calls) == 3:
            raise KeyboardInterrupt
        return real(*parts)

    monkeypatch.setattr(table_choice, "pair_table", interrupted)
    with pytest.raises(KeyboardInterrupt):
        pair_tables(*arguments)
    assert not table_choice.are_known(*arguments)
    tables = pair_tables(*arguments)
    assert next(calls) - 1 == len(tables) + 1  # that which was interrupted is made anew, and no other
    assert table_choice.are_known(*arguments)
    pair_tables.cache_clear()
    monkeypatch.setattr(table_choice, "pair_table", lambda *parts: pytest.fail("made again"))
    for table, again in zip(tables, pair_tables(*arguments), strict=True):
        np.testing.assert_array_equal(table.codes, again.codes)
    pair_tables.cache_clear()


def test_balls_of_fixed_links_are_kept_on_disk(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from ulna.collision import clearance

    monkeypatch.setenv("ULNA_CACHE", str(tmp_path))
    builder = ModelBuilder("lamp")
    builder.add_link("base", collisions=(Geometry("", Ellipsoid((0.1, 0.2, 0.05))),))
    builder.add_link("arm", collisions=(Geometry("", Sphere(0.05)),))
    builder.add_joint("turn", Revolute((0, 1, 0)), "base", "arm", SE3.from_translation([0, 0, 0.3]))
    model = builder.build()
    made_first = clearance.fixed_parts(model, [("base", "arm")])
    monkeypatch.setattr(clearance, "cover", lambda *arguments: pytest.fail("made again"))
    again = clearance.fixed_parts(model, [("base", "arm")])
    assert len(again) == len(made_first) > 1
    for (part, _), (other, _) in zip(made_first, again, strict=True):
        np.testing.assert_array_equal(part.placement.translation, other.placement.translation)
        np.testing.assert_array_equal(part.sizes, other.sizes)


def test_plans_by_default_touch_nothing(ur5: SphereChecker) -> None:
    robot, exact = ulna.load("ur5"), Checker(ur5.model)
    q = algorithms.random(ur5.model, np.random.default_rng(5), (60,))
    free = q[exact.distance(q).distance > 2e-3][:16]
    plans = [Planner(robot).plan(a, b) for a, b in zip(free[::2], free[1::2], strict=True)]
    assert sum(plan.is_certified for plan in plans) >= 6
    for plan in plans:
        if plan:
            t = np.linspace(0.0, 1.0, 60)[:, None]
            along = np.concatenate([a + t * (b - a) for a, b in itertools.pairwise(plan.points)])
            assert not exact.collides(along).any()


def test_tables_of_a_plane_are_proved() -> None:
    builder = (
        ModelBuilder("mill").add_link("floor", collisions=(Geometry("", Plane((0.0, 0.0))),)).add_link("lift")
    )
    builder.add_link("arm", collisions=(Geometry("", Box((0.4, 0.1, 0.1)), SE3.trans(0.2, 0.0, 0.0)),))
    builder.add_joint("up", Prismatic((0, 0, 1)), "floor", "lift", SE3.trans(0, 0, 0.3), lower=0.0, upper=0.2)
    builder.add_joint("turn", Revolute((0, 1, 0)), "lift", "arm", lower=-2.0, upper=2.0)
    model = builder.build()
    clearance, exact = assert_proved(model, made(model, ("floor", "arm"), 2000), 300)
    assert (exact < 0.0).any()
    assert (clearance[exact > 0.08] > 0.0).mean() > 0.9


def test_points_around_a_solid_reach_as_far_as_its_rounding() -> None:
    vertices = np.array(list(itertools.product([0.0, 0.1], [0.0, 0.2], [0.0, 0.3])))
    faces = np.zeros((0, 3), dtype=np.int64)
    points = solid_points(
        Solid("cloud", PointCloud(vertices), -1, SE3.trans(1.0, 0.0, 0.0), vertices, faces, 0.02)
    )
    for direction in np.random.default_rng(0).standard_normal((20, 3)):
        n = direction / np.linalg.norm(direction)
        reach = (points.centres @ n + points.radii).max()
        assert reach == pytest.approx(((vertices + [1.0, 0.0, 0.0]) @ n).max() + 0.02)
