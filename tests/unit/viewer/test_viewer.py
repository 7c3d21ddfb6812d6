"""The viewer: every kind of thing is added, changed and removed; robots, simulations, pictures without a page."""

import threading
from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, NonFiniteError, ShapeError, UlnaError, UnknownAttribute, UnknownName
from ulna.geometry import Box, Geometry, Mesh, Sphere
from ulna.model import ModelBuilder, Revolute
from ulna.sim import Recording
from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.content import Copies, Lines, Points
from ulna.viewer.graph.handles import Handle
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.robot.robot_handle import RobotHandle
from ulna.viewer.viewer import Viewer


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture
def viewer() -> Viewer:
    return Viewer(page=False)


def every_kind(viewer: Viewer, folder: Path, panda: ulna.Robot) -> dict[str, Handle]:
    (folder / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    made = {
        "robot": viewer.add(panda),
        "group": viewer.group("a group"),
        "box": viewer.box((1, 2, 3)),
        "sphere": viewer.sphere(0.1),
        "ellipsoid": viewer.ellipsoid((0.1, 0.2, 0.3)),
        "cylinder": viewer.cylinder(0.1, 0.5),
        "capsule": viewer.capsule(0.1, 0.5),
        "cone": viewer.cone(0.1, 0.5),
        "surface": viewer.add(tessellate(Box((1, 1, 1)))),
        "axes": viewer.axes(),
        "arrow": viewer.arrow((0, 0, 1)),
        "line": viewer.line([(0, 0, 0), (1, 0, 0)]),
        "curve": viewer.curve([(0, 0, 0), (1, 0, 0), (1, 1, 0)]),
        "points": viewer.points([(0, 0, 0), (1, 1, 1)]),
        "text": viewer.text("hello"),
        "grid": viewer.grid(),
        "copies": viewer.copies(Sphere(0.1), positions=[(0, 0, 0), (1, 1, 1)]),
    }
    if pytest.importorskip("trimesh"):
        made["mesh"] = viewer.mesh(folder / "one.obj")
        made["mesh shape"] = viewer.add(Mesh(str(folder / "one.obj"), (2.0, 2.0, 2.0)))
    return made


def test_every_kind_can_be_moved_tinted_faded_scaled_hidden_and_removed(
    viewer: Viewer, tmp_path: Path, panda: ulna.Robot
) -> None:
    pose = ulna.SE3.from_rpy((0.1, 0.2, 0.3), (1.0, 2.0, 3.0))
    for kind, handle in every_kind(viewer, tmp_path, panda).items():
        handle.pose = pose
        np.testing.assert_allclose(handle.pose, pose.matrix(), err_msg=kind)
        handle.position = (4, 5, 6)
        np.testing.assert_array_equal(handle.world_pose[:3, 3], (4, 5, 6))
        handle.color = (1.0, 0.5, 0.0)
        handle.opacity, handle.scale, handle.visible = 0.5, 2.0, False
        assert (handle.color, handle.opacity, handle.visible) == ((1.0, 0.5, 0.0), 0.5, False)
        np.testing.assert_array_equal(handle.scale, (2, 2, 2))
        handle.color = None
        assert handle.color is None
        assert viewer[handle.name] is handle
        viewer.remove(handle)
        assert handle.name not in viewer
        with pytest.raises(UnknownName):
            handle.opacity = 1.0
    assert viewer.scene.names == ()


def test_what_a_thing_does_not_have_cannot_be_assigned(
    viewer: Viewer, tmp_path: Path, panda: ulna.Robot
) -> None:
    for handle in every_kind(viewer, tmp_path, panda).values():
        with pytest.raises(UnknownAttribute, match="Did you mean 'color'"):
            handle.colour = (1, 0, 0)  # type: ignore[attr-defined]
        with pytest.raises(AttributeError, match="`name` of .* cannot be assigned to"):
            handle.name = "other"  # type: ignore[misc]
        for name, wrong in (
            ("pose", np.eye(3)),
            ("pose", "here"),
            ("position", "there"),
            ("opacity", "half"),
            ("opacity", None),
            ("pose", np.full((4, 4), np.nan)),
            ("pose", np.diag([2.0, 2.0, 2.0, 1.0])),
            ("position", (1, 2)),
            ("opacity", 1.5),
            ("scale", 0.0),
            ("scale", (1, 2)),
            ("color", (1, 2, 3, 4, 5)),
        ):
            with pytest.raises(InputError):
                setattr(handle, name, wrong)
        assert (handle.opacity, handle.color) == (1.0, None)


def test_nothing_is_added_by_mistake(viewer: Viewer, panda: ulna.Robot) -> None:
    wrong = (
        lambda: viewer.add(42),
        lambda: viewer.add(panda, q=np.zeros(6)),
        lambda: viewer.add(panda, q="nowhere"),
        lambda: viewer.add(panda, show="bones"),
        lambda: viewer.box((1, 2)),
        lambda: viewer.sphere(-1.0),
        lambda: viewer.mesh("/nowhere/a.stl"),
        lambda: viewer.arrow((0, 0, np.nan)),
        lambda: viewer.line([(0, 0), (1, 1)]),
        lambda: viewer.points([(0, 0, np.inf)]),
        lambda: viewer.points([(0, 0, 0)], np.zeros((2, 3))),
        lambda: viewer.grid(1.0, 2.0),
        lambda: viewer.copies(Sphere(0.1)),
        lambda: viewer.text("x", height=0.0),
        lambda: viewer.box((1, 1, 1), pose=np.zeros((4, 4))),
        lambda: viewer.box((1, 1, 1), name=5),
        lambda: viewer.add(panda, detail="some"),
        lambda: viewer.mesh("/"),
        lambda: setattr(viewer, "camera", "top"),
        lambda: setattr(viewer, "floor", np.nan),
        lambda: setattr(viewer, "floor", "low"),
        lambda: viewer.picture(camera=5),  # type: ignore[arg-type]
        lambda: viewer.play(5),  # type: ignore[arg-type]
        lambda: Camera((0, 0, 0), (0, 0, 0)),
        lambda: Camera((0, 0, np.inf)),
        lambda: Camera(fov=0.0),
        lambda: Viewer(page=False, camera="top"),  # type: ignore[arg-type]
    )
    for mistake in wrong:
        with pytest.raises(UlnaError):
            mistake()
    assert viewer.scene.names == ()
    with pytest.raises(UnknownName):
        viewer["nobody"]


def test_what_was_removed_is_neither_moved_nor_begun_anew(viewer: Viewer, panda: ulna.Robot) -> None:
    arm = viewer.add(panda, "qr")
    arm.q = "qz"  # not looked at before it goes
    arm.remove()
    for use in (lambda: setattr(arm, "q", "qr"), arm.trace, arm.frames, lambda: arm.pose, arm.remove):
        with pytest.raises(UnknownName, match="No object in the scene named 'panda'"):
            use()
    assert viewer.scene.names == ()


def test_a_simulation_goes_on_without_a_robot_that_was_removed(viewer: Viewer, panda: ulna.Robot) -> None:
    arm, other = viewer.add(panda, "qr", name="one"), viewer.add(panda, "qr", name="other")
    sim = viewer.simulate(realtime=False)
    other.qd = np.full(7, 0.1)
    sim.step(0.1)
    arm.remove()
    sim.step(0.1)
    viewer.play().time = 0.1
    assert len(other.body.recording) == 3 and "one" not in viewer.scene


def test_copies_of_a_mesh_have_its_scale(viewer: Viewer, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    thing = Mesh(str(tmp_path / "one.obj"), (1e-3, 2e-3, 1e-3))
    viewer.copies(thing, positions=np.zeros((2, 3)), name="some")
    content = viewer.scene.node("some").content
    assert isinstance(content, Copies)
    np.testing.assert_allclose(np.ptp(content.original[0].vertices, axis=0), (1e-3, 2e-3, 0.0))


def test_an_arrow_of_velocity_follows_the_velocity_alone(viewer: Viewer, panda: ulna.Robot) -> None:
    arm = viewer.add(panda, "qr")
    arrow = arm.velocity(size=2.0)
    viewer.scene.snapshot()
    arm.qd = qd = np.linspace(0.1, 0.7, 7)
    viewer.scene.snapshot()
    np.testing.assert_allclose(arrow.vector, panda.jacobian(arm.q)[:3] @ qd, atol=1e-12)


def test_names_are_made_and_taken_ones_replaced(viewer: Viewer, panda: ulna.Robot) -> None:
    assert [viewer.box((1, 1, 1)).name for _ in range(3)] == ["box", "box 2", "box 3"]
    assert viewer.add(panda).name == "panda"
    assert viewer.add(panda).name == "panda 2"
    old = viewer.sphere(0.1, name="table/ball")
    old.opacity = 0.5
    new = viewer.sphere(0.2, name="table/ball")
    assert viewer["table/ball"] is new
    assert new.opacity == 1.0
    assert viewer["table"].name == "table"
    viewer.clear()
    assert viewer.scene.names == ()


def test_a_group_carries_what_is_in_it(viewer: Viewer) -> None:
    leg = viewer.box((0.1, 0.1, 1.0), name="table/leg", pose=ulna.SE3.trans(0.5, 0, 0))
    viewer["table"].pose = ulna.SE3.rz(np.pi / 2)
    viewer["table"].scale = 2.0
    np.testing.assert_allclose(leg.world_pose[:3, 3], (0, 1, 0), atol=1e-12)
    np.testing.assert_array_equal(leg.position, (0.5, 0, 0))


def test_points_lines_words_and_copies_change(viewer: Viewer) -> None:
    named = viewer.points(np.zeros((3, 3)), "red")
    np.testing.assert_array_equal(named.colors, [(1, 0, 0)] * 3)
    with pytest.raises(UnknownName, match="tomato"):
        viewer.points(np.zeros((3, 3)), "tomatoe")
    cloud = viewer.points(np.zeros((3, 3)), (1, 0, 0))
    cloud.points = np.ones((5, 3))
    assert cloud.points.shape == cloud.colors.shape == (5, 3)
    cloud.colors = (0, 1, 0)
    cloud.set(np.zeros((2, 3)), np.eye(3)[:2])
    with pytest.raises(ShapeError):
        cloud.points = np.zeros((3, 3))  # which colours should they have?
    path = viewer.line(np.zeros((2, 3)))
    path.points = np.arange(12).reshape(4, 3)
    np.testing.assert_array_equal(path.points, np.arange(12).reshape(4, 3))
    assert viewer.text("b", color="#ff000080", opacity=0.5).opacity == pytest.approx(0.5 * 128 / 255)
    words = viewer.text("a", color="red", opacity=0.5)
    assert words.color == (1.0, 0.0, 0.0) and words.opacity == 0.5
    words.text = "b"
    assert words.text == "b"
    crowd = viewer.copies(Sphere(0.1), positions=np.zeros((3, 3)), colors=np.eye(3))
    crowd.positions = np.ones((3, 3))
    crowd.colors = (1, 1, 0)
    crowd.poses = np.tile(np.eye(4), (7, 1, 1))
    assert crowd.positions.shape == (7, 3)
    assert crowd.colors is not None and crowd.colors.shape == (7, 3)


def test_a_colour_brings_its_opacity(viewer: Viewer, tmp_path: Path, panda: ulna.Robot) -> None:
    for kind, handle in every_kind(viewer, tmp_path, panda).items():
        handle.opacity = 0.25
        handle.color = "red"
        assert handle.opacity == 0.25, kind  # a colour without an opacity leaves it
        for colour, opacity in (("#00ff0080", 128 / 255), ((0.0, 1.0, 0.0, 0.5), 0.5), ("#0f0f", 1.0)):
            handle.color = colour
            assert handle.color == (0.0, 1.0, 0.0) and handle.opacity == pytest.approx(opacity), kind
        with pytest.raises(InputError):
            handle.color = (0.0, 0.0, 1.0, 1.5)
        assert handle.color == (0.0, 1.0, 0.0) and handle.opacity == 1.0, kind


def test_an_added_colour_brings_its_opacity(viewer: Viewer, panda: ulna.Robot, tmp_path: Path) -> None:
    half, points = (1.0, 0.0, 0.0, 0.5), np.eye(3)
    arm = viewer.add(panda, color=half, opacity=0.5)
    handles = {
        "box": viewer.box((1, 1, 1), color=half, opacity=0.5),
        "surface": viewer.add(viewer.scene.node("box").surfaces[0], color=half, opacity=0.5),
        "robot": arm,
        "fleet": viewer.fleet(panda, panda.neutral[None], color=half, opacity=0.5),
        "arrow": viewer.arrow((0, 0, 1), color=half, opacity=0.5),
        "line": viewer.line(points, color=half, opacity=0.5),
        "grid": viewer.grid(color=half, opacity=0.5),
        "points": viewer.points(points, half, opacity=0.5),
        "copies": viewer.copies(Sphere(0.1), positions=points, colors="#ff00007f", opacity=0.5),
    }
    for kind, handle in handles.items():
        assert handle.opacity == pytest.approx(0.25, rel=0.01), kind
        handle.color = (0.0, 0.0, 1.0, 0.5)
        assert handle.opacity == 0.5, kind
        snapshot = viewer.scene.snapshot()
        for i, node in enumerate(snapshot.nodes):
            if node.name == handle.name or node.name.startswith(handle.name + "/"):
                surfaces = node.surfaces or (node.content.surfaces if node.content is not None else ())
                assert all(s.rgba[3] * snapshot.opacity[i] == 0.5 for s in surfaces), (kind, node.name)
    others = arm.ghosts(panda.neutral[None], half, 0.5).name
    contents = [node.content for node in viewer.scene.nodes if node.name.startswith(others + "/")]
    assert contents and all(isinstance(c, Copies) and c.opacity == 0.25 for c in contents)


def test_one_colour_for_all_brings_its_opacity(viewer: Viewer) -> None:
    places = np.eye(3)
    cloud, crowd = viewer.points(places), viewer.copies(Sphere(0.1), positions=places)
    for handle in (cloud, crowd):
        handle.colors = (0.0, 1.0, 0.0, 0.75)
        assert handle.opacity == 0.75
        np.testing.assert_array_equal(handle.colors, [(0, 1, 0)] * 3)
        handle.colors = (0.0, 1.0, 1.0)
        assert handle.opacity == 0.75
        with pytest.raises(InputError, match="colors"):
            handle.colors = [(1, 0), (1,)]
    cloud.set(places, "#0000ff33")
    assert cloud.opacity == pytest.approx(0.2)
    crowd.colors = None
    assert crowd.colors is None and crowd.opacity == 0.75


def test_an_arrow_points_along_its_vector(viewer: Viewer) -> None:
    arrow = viewer.arrow((0, 0, 1), start=(1, 0, 0))
    for vector in ((0.3, -0.4, 0.0), (0, 0, -2.0), (1e-3, 0, 0)):
        arrow.vector = vector
        seen = viewer.scene.snapshot()
        tip = viewer.scene.row(f"{arrow.name}/tip")
        end = seen.poses[tip][:3, 3] + seen.scales[tip, 2] * seen.poses[tip][:3, 2]
        np.testing.assert_allclose(end, np.add((1, 0, 0), vector), atol=1e-9)
    arrow.vector = (0, 0, 0)
    assert viewer.scene.snapshot().scales[viewer.scene.row(f"{arrow.name}/shaft")].max() < 1e-6


def test_a_force_of_fifty_newtons_can_be_seen_whole(viewer: Viewer, panda: ulna.Robot) -> None:
    arm = viewer.add(panda, "qr")
    push = arm.force(vector=(0, 0, -50))
    seen = viewer.scene.snapshot()
    tip = seen.scales[viewer.scene.row(f"{push.name}/tip"), 2]
    shaft = seen.scales[viewer.scene.row(f"{push.name}/shaft"), 2]
    assert tip + shaft == pytest.approx(0.5)
    assert viewer.scene.floor() == 0.0  # it reaches into the floor, which stays
    push.size = 0.002
    np.testing.assert_array_equal(push.vector, (0, 0, -50))
    seen = viewer.scene.snapshot()
    assert sum(
        seen.scales[viewer.scene.row(f"{push.name}/{p}"), 2] for p in ("tip", "shaft")
    ) == pytest.approx(0.1)
    with pytest.raises(InputError, match="metres for each unit"):
        push.size = -1.0


def test_a_curve_passes_through_its_points(viewer: Viewer) -> None:
    points = np.random.default_rng(0).normal(size=(5, 3))
    way = viewer.curve(points, steps=8).points
    assert len(way) == 4 * 8 + 1
    np.testing.assert_allclose(way[::8], points, atol=1e-12)


@pytest.mark.parametrize("show", ["visual", "collision", "both", "skeleton"])
def test_a_robot_shows_what_is_asked(viewer: Viewer, panda: ulna.Robot, show: str) -> None:
    arm = viewer.add(panda, "qr", show=show)
    assert arm.show == show
    assert any(len(n.surfaces) for n in viewer.scene.nodes)
    arm.show = "skeleton"
    bones = sum(len(s.triangles) for n in viewer.scene.nodes for s in n.surfaces)
    assert bones > 0
    arm.show = show
    np.testing.assert_allclose(
        viewer["panda/panda_hand"].world_pose, panda.fk(panda.configurations["qr"], "panda_hand"), atol=1e-12
    )


def test_a_robot_moves_on_its_base(viewer: Viewer, panda: ulna.Robot) -> None:
    arm = viewer.add(panda, "qr", pose=ulna.SE3.trans(1, 2, 3))
    arm.q = "ready"
    np.testing.assert_array_equal(arm.q, panda.configurations["ready"])
    T = ulna.SE3.trans(1, 2, 3).matrix() @ panda.fk(arm.q)
    np.testing.assert_allclose(arm.tool, T, atol=1e-12)
    for wrong, error in ((np.zeros(6), ShapeError), ([np.nan] * 7, NonFiniteError), ("qy", UnknownName)):
        with pytest.raises(error):
            arm.q = wrong
    np.testing.assert_array_equal(arm.q, panda.configurations["ready"])


def test_what_moves_along_is_where_the_robot_has_it(viewer: Viewer, panda: ulna.Robot) -> None:
    arm = viewer.add(panda, "qr")
    frames, centre = arm.frames(["panda_hand", "panda_link4"]), arm.center_of_mass()
    inertias, reach = arm.inertias(), arm.manipulability(size=0.5)
    push, speed = arm.force(vector=(0, 0, -0.3)), arm.velocity(size=1.0)
    trace = arm.trace()
    arm.qd = np.linspace(0.1, 0.7, 7)
    q = panda.configurations["ready"]
    arm.q = q
    seen = viewer.scene.snapshot()
    at = lambda name: seen.poses[viewer.scene.row(name)]  # noqa: E731
    np.testing.assert_allclose(at(f"{frames.name}/1"), panda.fk(q, "panda_link4"), atol=1e-12)
    np.testing.assert_allclose(at(centre.name)[:3, 3], panda.center_of_mass(q), atol=1e-12)
    J = panda.jacobian(q)[:3]
    node = viewer.scene.row(f"{reach.name}/ellipsoid")
    axes, radii = seen.poses[node][:3, :3], seen.scales[node] / 0.5
    np.testing.assert_allclose(axes @ np.diag(radii**2) @ axes.T, J @ J.T, atol=1e-9)
    np.testing.assert_allclose(at(push.name)[:3, 3], panda.fk(q)[:3, 3], atol=1e-12)
    np.testing.assert_allclose(speed.vector, J @ arm.qd, atol=1e-12)
    np.testing.assert_allclose(trace.points[-1], panda.fk(q)[:3, 3], atol=1e-12)
    assert any(n.startswith(inertias.name) for n in viewer.scene.names)
    for group in (frames, centre, reach):
        group.remove()
    arm.q = "qr"
    viewer.scene.snapshot()  # what was removed is followed no more
    with pytest.raises(UnknownName):
        arm.frames("nowhere")
    with pytest.raises(UnknownName, match="velocity"):
        arm.manipulability(of="velocty")


def test_ellipsoids_of_inertia_have_the_inertia_of_their_links(viewer: Viewer) -> None:
    from ulna.viewer.robot.ellipsoids import inertia_ellipsoids

    robot = ulna.load("ur5")
    found = inertia_ellipsoids(robot.model.links)
    assert len(found) >= 4
    for number, place, radii in found:
        inertia = robot.model.links[number].inertia
        squares = radii**2
        moments = float(inertia.mass) / 5 * (squares.sum() - squares)
        back = place[:3, :3] @ np.diag(moments) @ place[:3, :3].T
        np.testing.assert_allclose(back, inertia.inertia, atol=1e-12)


def test_ghosts_stand_in_all_their_configurations(viewer: Viewer, panda: ulna.Robot) -> None:
    arm = viewer.add(panda, "qr")
    q = np.stack([panda.configurations["qr"], panda.configurations["ready"]])
    ghosts = arm.ghosts(q)
    content = viewer.scene.node(f"{ghosts.name}/panda_hand").content
    assert isinstance(content, Copies)
    np.testing.assert_allclose(content.poses, panda.fk(q, "panda_hand"), atol=1e-12)
    ghosts.q = np.zeros((5, 7))
    viewer.scene.snapshot()
    assert len(viewer.scene.node(f"{ghosts.name}/panda_hand").content.poses) == 5  # type: ignore[union-attr]
    with pytest.raises(ShapeError):
        ghosts.q = np.zeros(7)


@pytest.mark.parametrize(("show", "shown"), [("both", "ball"), ("visual", "ball"), ("collision", "box")])
def test_ghosts_look_as_the_robot(viewer: Viewer, show: str, shown: str) -> None:
    builder = ModelBuilder("two")
    builder.add_link(
        "base", visuals=[Geometry("", Sphere(0.1))], collisions=[Geometry("", Box((0.1, 0.1, 0.1)))]
    )
    builder.add_link("arm").add_joint("turn", Revolute((0.0, 0.0, 1.0)), "base", "arm")
    handle = viewer.add(ulna.Robot(builder.build()), show=show)
    content = viewer.scene.node(f"{handle.ghosts([[0.1]]).name}/base").content
    assert isinstance(content, Copies)
    (surface,) = content.original
    assert (len(surface.triangles) > 12) == (shown == "ball")


def test_a_fleet_stands_on_its_bases(viewer: Viewer, panda: ulna.Robot) -> None:
    q, bases = np.tile(panda.configurations["qr"], (3, 1)), np.tile(np.eye(4), (3, 1, 1))
    bases[:, 0, 3] = (0, 1, 2)
    fleet = viewer.fleet(panda, q, bases)
    fleet.q = q + 0.1
    viewer.scene.snapshot()
    content = viewer.scene.node(f"{fleet.name}/panda_hand").content
    assert isinstance(content, Copies)
    np.testing.assert_allclose(content.poses, bases @ panda.fk(q + 0.1, "panda_hand"), atol=1e-12)
    with pytest.raises(ShapeError, match="bases"):
        fleet.q = q[:2]
    with pytest.raises(ShapeError, match="bases"):
        viewer.fleet(panda, q, bases[:2])


def test_a_simulation_moves_the_robots_it_found_and_those_that_come(
    viewer: Viewer, panda: ulna.Robot
) -> None:
    first = viewer.add(panda, "qr")
    first.qd = np.full(7, 0.1)
    sim = viewer.simulate(realtime=False)
    second = viewer.add(panda, "qr", pose=ulna.SE3.trans(0, 1, 0))
    second.qd = np.full(7, -0.1)
    sim.run(0.5, 0.01)
    np.testing.assert_allclose(first.q, panda.configurations["qr"] + 0.05)
    np.testing.assert_allclose(second.q, panda.configurations["qr"] - 0.05)
    assert first.body is sim["panda"]
    np.testing.assert_allclose(
        viewer["panda/panda_hand"].world_pose, panda.fk(first.q, "panda_hand"), atol=1e-12
    )
    first.q = "qr"  # also the simulation's
    np.testing.assert_array_equal(sim["panda"].q, panda.configurations["qr"])
    timeline = viewer.play()
    timeline.time = 0.25
    np.testing.assert_allclose(
        viewer["panda/panda_hand"].world_pose,
        panda.fk(panda.configurations["qr"] + 0.025, "panda_hand"),
        atol=1e-9,
    )
    assert timeline.duration == pytest.approx(0.5)


def test_what_to_play_must_be_clear(viewer: Viewer, panda: ulna.Robot) -> None:
    with pytest.raises(InputError, match="Nothing was simulated"):
        viewer.play()
    with pytest.raises(InputError, match="0 robots"):
        viewer.play(Recording())
    with pytest.raises(InputError, match="duration"):
        viewer.film("a.gif", move=lambda t: None)


def test_a_step_hands_over_and_whoever_looks_gets_whole_frames(viewer: Viewer, panda: ulna.Robot) -> None:
    arms = [viewer.add(panda, "qr") for _ in range(4)]
    sim, torn = viewer.simulate(realtime=False, record=False), []
    for arm in arms:
        arm.qd = [0.5, 0, 0, 0, 0, 0, 0]
    stepper = threading.Thread(target=lambda: sim.run(2.0, 0.002))
    stepper.start()
    while stepper.is_alive():
        seen = viewer.scene.snapshot()
        hands = [seen.poses[viewer.scene.row(f"{arm.name}/panda_hand")] for arm in arms]
        if not all(np.array_equal(hands[0], hand) for hand in hands[1:]):
            torn.append(hands)
    stepper.join()
    assert not torn
    assert sim.steps == 1000


def test_contents_say_how_large_they_are() -> None:
    rng = np.random.default_rng(0)
    points = Points(rng.normal(size=(50, 3)), np.full(3, 0.5), 0.01)
    lines = Lines(rng.normal(size=(20, 2, 3)), (0, 0, 0, 1), 0.01)
    poses = np.tile(np.eye(4), (9, 1, 1))
    poses[:, :3, 3] = rng.normal(size=(9, 3))
    copies = Copies((tessellate(Box((1, 2, 3))),), poses, scales=rng.uniform(1, 2, (9, 3)))
    for content, slack in ((points, 0.006), (lines, 0.006), (copies, 1e-9)):
        drawn = np.concatenate([s.vertices for s in content.surfaces])
        assert np.abs(drawn.min(axis=0) - content.bounding_points.min(axis=0)).max() <= slack
        assert np.abs(drawn.max(axis=0) - content.bounding_points.max(axis=0)).max() <= slack


def test_a_viewer_without_a_page_says_so_and_draws(
    viewer: Viewer, panda: ulna.Robot, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    viewer.hold()
    assert "no page" in capsys.readouterr().out
    assert (viewer.url, viewer.clients, viewer.closed) == ("", 0, True)
    assert viewer._repr_html_() is None
    arm = viewer.add(panda)
    with pytest.raises(InputError, match="no page"):
        viewer.teach_panel(arm)
    viewer.text("here", (0.3, 0, 0.9))
    light = viewer.picture(tmp_path / "a.png", 96, 60)
    viewer.theme = "dark"
    dark = viewer.picture(None, 96, 60)
    assert light.shape == (60, 96, 3)
    assert dark.mean() < 0.6 * light.mean()
    assert (tmp_path / "a.png").stat().st_size > 500
    with pytest.raises(UnknownName, match="'dark'"):
        viewer.theme = "drak"
    assert isinstance(viewer["panda"], RobotHandle)


def test_a_page_has_what_is_added_in_view_and_above_its_floor() -> None:
    pytest.importorskip("viser", reason="viser, which serves the page, is not installed")
    with Viewer(port=0, browser=False) as viewer:
        viewer.box((1, 1, 1), pose=ulna.SE3.trans(5, 6, -3))
        viewer.flush()
        page = viewer._page
        assert page is not None
        first = page.server.initial_camera
        np.testing.assert_allclose(first.look_at, (5, 6, -3), atol=1.5)
        floor = page.server.scene.get_handle_by_name("/(page)/floor")
        assert floor is not None
        assert floor.position[2] == pytest.approx(-3.5, abs=0.01)
        viewer.camera = Camera((1.0, 2.0, 3.0), (0.0, 0.0, 0.0))
        viewer.sphere(0.1, pose=ulna.SE3.trans(-50, 0, 0))
        viewer.floor = -7.0
        viewer.flush()
        np.testing.assert_allclose(first.position, (1, 2, 3))  # it was chosen
        assert "<iframe" in str(viewer._repr_html_())


def test_many_things_are_added_in_time_that_grows_with_their_number(viewer: Viewer) -> None:
    for _ in range(1500):
        viewer.box((1, 1, 1))
    assert viewer.scene.names[-1] == "box 1500"
    viewer.remove("box 2")
    viewer.clear()
    assert viewer.box((1, 1, 1)).name == "box"


def test_controls_without_a_page_keep_their_values(viewer: Viewer) -> None:
    panel = viewer.panel
    slider = panel.slider("gain", 0.0, 2.0, 5.0)
    assert slider.value == 2.0
    slider.value = 1.0
    assert slider.value == 1.0
    assert panel.checkbox("on", True).value is True
    assert panel.select("mode", ("a", "b")).value == "a"
    assert panel.radio("way", ("a", "b"), "b").value == "b"
    assert panel.number("n", 3).value == 3.0
    assert panel.button("go", lambda: None).value == 0
    text = panel.text("x")
    text.value = "y"
    assert text.value == "y"
    plot = panel.plot("p", ("a", "b"), seconds=7.0)
    assert (plot.names, plot.seconds) == (("a", "b"), 7.0)
    plot.seconds = 1.0
    assert plot.seconds == 1.0
    for k in range(50):
        plot.add(0.1 * k, (k, -k))
    assert plot.data.shape == (11, 3)
    with panel.folder("more"):
        panel.buttons("row", ("a",), lambda _: None)
    for mistake in (
        lambda: panel.slider("s", 1.0, 1.0),
        lambda: panel.select("s", ()),
        lambda: panel.radio("s", ("a", "a")),
        lambda: plot.add(9.0, (1, 2, 3)),
    ):
        with pytest.raises(InputError):
            mistake()
    with pytest.raises(UnknownName, match="'a'"):
        panel.select("s", ("a", "b"), "aa")


@pytest.mark.parametrize("place", [(0.5, 0.0, 0.3), [0.5, 0.0, 0.3], np.array([0.5, 0.0, 0.3])], ids=type)
def test_a_place_serves_as_a_pose(place) -> None:
    viewer = Viewer(page=False)
    box = viewer.box((0.1, 0.2, 0.3), pose=place)
    np.testing.assert_array_equal(box.pose, ulna.SE3.trans(0.5, 0.0, 0.3).matrix())
    box.pose = ulna.SE3.rx(0.4)
    box.pose = place
    np.testing.assert_array_equal(box.pose, ulna.SE3.trans(0.5, 0.0, 0.3).matrix())
    arm = viewer.add(ulna.load("ur5", visuals="simple"), pose=place)
    np.testing.assert_array_equal(arm.pose[:3, 3], place)
