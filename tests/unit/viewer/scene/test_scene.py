"""The scene: named nodes, one array of poses, robots that come in whole or not at all."""

import threading
from types import SimpleNamespace

import numpy as np
import pytest

from ulna.errors import InputError, ModelWarning, NonFiniteError, ShapeError, UnknownName
from ulna.geometry import Box, Geometry, Material, Mesh, Sphere
from ulna.spatial import SE3
from ulna.viewer.graph.node import Node
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.robot.link_surfaces import link_surfaces
from ulna.viewer.scene import Scene


def at(x: float, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def three() -> Scene:
    scene = Scene()
    for k, name in enumerate("abc"):
        scene.add(name, pose=at(k))
    return scene


def test_names_and_poses_keep_one_order() -> None:
    scene = three()
    assert scene.names == ("a", "b", "c")
    np.testing.assert_array_equal(scene.poses[:, 0, 3], [0, 1, 2])


def test_a_node_casts_a_shadow_and_is_hidden_by_what_is_in_front_of_it() -> None:
    assert Node("a").shadow and not Node("a").through


def test_poses_are_written_by_rows() -> None:
    scene = three()
    scene.set_poses([at(7), at(8)], scene.rows(["c", "a"]))
    np.testing.assert_array_equal(scene.poses[:, 0, 3], [8, 1, 7])
    scene.set_pose("b", at(9))
    assert scene.poses[1, 0, 3] == 9


def test_what_is_read_cannot_be_written_to() -> None:
    scene = three()
    with pytest.raises(ValueError, match="read-only"):
        scene.poses[:] = 0
    assert scene.poses[1, 0, 3] == 1


def test_adding_a_name_again_replaces_it_in_its_place() -> None:
    scene = three()
    scene.add("b", [tessellate(Sphere(0.1))], at(5))
    assert scene.names == ("a", "b", "c")
    assert scene.poses[1, 0, 3] == 5
    assert len(scene.node("b").surfaces) == 1


def test_a_node_takes_what_belongs_to_it_away() -> None:
    scene = three()
    scene.add("a/1/x")
    scene.add("aa")
    assert scene.names == ("a", "b", "c", "a/1", "a/1/x", "aa")
    scene.remove("a")
    assert scene.names == ("b", "c", "aa")
    np.testing.assert_array_equal(scene.poses[:, 0, 3], [1, 2, 0])
    assert scene.row("c") == 1


def test_a_group_carries_scales_tints_and_hides_what_is_in_it() -> None:
    scene = three()
    turned = SE3.rz(np.pi / 2).matrix() @ at(0)
    turned[0, 3] = 1.0
    scene.set_pose("a", turned)
    scene.add("a/x/y", pose=at(0.5))
    np.testing.assert_allclose(scene.poses[scene.row("a/x/y")][:3, 3], (1, 0.5, 0), atol=1e-12)
    scene.set_look("a", "scale", 2.0)
    scene.set_look("a", "opacity", 0.5)
    scene.set_look("a/x/y", "opacity", 0.5)
    scene.set_look("a", "tint", (1.0, 0.0, 0.0))
    scene.set_look("a/x", "visible", False)
    seen, row = scene.snapshot(), scene.row("a/x/y")
    np.testing.assert_allclose(seen.poses[row][:3, 3], (1, 1, 0), atol=1e-12)
    np.testing.assert_array_equal(seen.scales[row], (2, 2, 2))
    assert seen.opacity[row] == 0.25
    assert not seen.visible[row]
    assert seen.visible[scene.row("a")]
    np.testing.assert_array_equal(seen.tint[row], (1, 0, 0))
    scene.set_look("a/x/y", "tint", (0.0, 0.0, 1.0))  # its own counts more
    np.testing.assert_array_equal(scene.snapshot().tint[row], (0, 0, 1))
    with pytest.raises(InputError, match="one number"):
        scene.set_look("a", "scale", (1.0, 2.0, 1.0))


def test_what_comes_later_is_asked_once_when_somebody_looks() -> None:
    scene, called = three(), []
    for k in range(3):
        version = scene.version
        scene.later(scene, lambda k=k: called.append(k))
        assert scene.version != version
    assert called == []
    scene.snapshot()
    scene.snapshot()
    assert called == [2]


def test_what_is_changed_together_is_seen_together() -> None:
    scene, seen = three(), []
    reader = threading.Thread(target=lambda: seen.append(scene.poses[:, 0, 3].tolist()))
    with scene.together():
        scene.set_pose("a", at(7))
        reader.start()
        reader.join(timeout=0.1)
        scene.set_pose("b", at(7))
        assert seen == []
    reader.join()
    assert seen == [[7, 7, 2]]


def test_many_nodes_are_added_in_time_that_grows_with_their_number() -> None:
    scene = Scene()
    for k in range(3000):
        scene.add(f"g/{k}", pose=at(k))
    assert scene.poses.shape == (3001, 4, 4)
    assert scene.poses[-1, 0, 3] == 2999


def test_versions_distinguish_structure_from_motion() -> None:
    scene = three()
    structure, motion, looks = scene.version
    scene.set_pose("a", at(1))
    assert scene.version == (structure, motion + 1, looks)
    scene.remove("a")
    assert scene.version == (structure + 1, motion + 1, looks)
    scene.set_look("b", "opacity", 0.5)
    assert scene.version == (structure + 1, motion + 1, looks + 1)


def test_mistakes_are_named() -> None:
    scene = three()
    with pytest.raises(UnknownName, match="No object in the scene named 'd'"):
        scene.node("d")
    with pytest.raises(InputError, match="no rotation"):
        scene.add("x", pose=np.diag([1.0, 1.0, -1.0, 1.0]))
    with pytest.raises(InputError, match="without"):
        scene.add("")
    with pytest.raises(ShapeError):
        scene.set_pose("a", np.eye(3))
    with pytest.raises(NonFiniteError):
        scene.add("x", pose=at(np.nan))
    assert scene.names == ("a", "b", "c")


def test_writers_and_a_reader_do_not_meet_half_way() -> None:
    scene = three()
    torn = []

    def write(value: float) -> None:
        for k in range(300):
            scene.set_poses(np.broadcast_to(at(value + k), (3, 4, 4)))

    writers = [threading.Thread(target=write, args=(v,)) for v in (0.0, 1000.0)]
    for w in writers:
        w.start()
    while any(w.is_alive() for w in writers):
        x = scene.poses[:, 0, 3]
        if not (x == x[0]).all() and not np.array_equal(x, [0, 1, 2]):
            torn.append(x)
    for w in writers:
        w.join()
    assert not torn


class Slider:
    """A stand-in with the part of a robot that scenes use: two links, the second sliding along x."""

    name = "slider"
    joint_names = ("slide",)

    def __init__(self, *visuals: Geometry) -> None:
        links = (SimpleNamespace(name="base", visuals=()), SimpleNamespace(name="cart", visuals=visuals))
        self.model = SimpleNamespace(links=links, nq=1, position_names=self.joint_names)

    def link_poses(self, q: np.ndarray) -> np.ndarray:
        return np.stack([np.eye(4), at(float(q[0]))])


BALL = Geometry("ball", Sphere(0.1), SE3.trans(0, 0, 1), Material("red", (1.0, 0.0, 0.0, 1.0)))


def test_a_robot_moves_and_goes_as_one() -> None:
    scene = three()
    robot = scene.add_robot(Slider(BALL), [0.5])
    assert scene.names[3:] == ("slider", "slider/base", "slider/cart")
    robot.move(np.array([2.0]))
    assert scene.poses[scene.row("slider/cart"), 0, 3] == 2.0
    scene.remove("a")  # rows change; the robot finds its own
    robot.move(np.array([3.0]))
    assert scene.poses[scene.row("slider/cart"), 0, 3] == 3.0
    np.testing.assert_array_equal(scene.poses[:2, 0, 3], [1, 2])
    robot.remove()
    assert scene.names == ("b", "c")


def test_visuals_are_placed_and_painted() -> None:
    (surface,) = link_surfaces([BALL])
    assert surface.rgba == (1.0, 0.0, 0.0, 1.0)
    np.testing.assert_allclose((surface.vertices.max(axis=0) + surface.vertices.min(axis=0)) / 2, (0, 0, 1))
    (ghost,) = link_surfaces([BALL], "cart", (0.0, 0.0, 1.0, 0.2))
    assert ghost.rgba == (0.0, 0.0, 1.0, 0.2)


def test_visuals_of_one_colour_are_joined() -> None:
    box = Geometry("box", Box((1, 1, 1)), SE3.identity(), BALL.material)
    (surface,) = link_surfaces([BALL, box])
    assert len(surface.triangles) == 12 + len(tessellate(Sphere(0.1)).triangles)


def test_a_mesh_that_cannot_be_read_is_left_out_with_a_warning(tmp_path) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / "a.stl").write_text("no mesh")
    broken = Geometry("shell", Mesh(str(tmp_path / "a.stl")))
    with pytest.warns(ModelWarning, match="'cart' is drawn without a mesh"):
        (surface,) = link_surfaces([BALL, broken], "cart")
    assert len(surface.triangles) == len(tessellate(Sphere(0.1)).triangles)  # the ball is there once
    with pytest.warns(ModelWarning):
        assert link_surfaces([broken], "cart") == ()


def test_a_missing_mesh_is_left_out_in_silence() -> None:
    assert link_surfaces([Geometry("shell", Mesh("a.stl", missing=True))]) == ()
    assert link_surfaces([Geometry("shell", Mesh(None))]) == ()


def test_a_robot_that_cannot_be_shown_leaves_nothing_behind() -> None:
    scene = Scene()
    with pytest.raises(NonFiniteError):
        scene.add_robot(Slider(BALL), [np.nan])
    assert scene.names == ()


def test_without_the_mesh_reader_the_extra_is_named_once(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    (tmp_path / "a.stl").write_text("")
    (tmp_path / "b.stl").write_text("")
    monkeypatch.setitem(sys.modules, "trimesh", None)
    visuals = [Geometry(n, Mesh(str(tmp_path / n))) for n in ("a.stl", "b.stl")]
    with pytest.warns(ModelWarning, match=r"pip install .*trimesh>=") as said:
        assert link_surfaces(visuals) == ()
    assert len({str(w.message) for w in said}) == 1


def test_the_floor_is_at_zero_or_below_everything() -> None:
    scene = Scene()
    assert scene.floor() == 0.0
    scene.add("up", [tessellate(Box((1, 1, 1)))], at(0, 0, 3))
    assert scene.floor() == 0.0
    scene.add_axes("axes", at(0, 0, -2))  # they point into the floor and do not lower it
    scene.add_path("line", [(0, 0, -5), (1, 0, -5)])
    assert scene.floor() == 0.0
    scene.add("legs", [tessellate(Box((1, 1, 1)))], at(0, 0, -1))
    assert scene.floor() == -1.5


def test_a_robot_within_translucent_hulls_casts_its_shadow() -> None:
    scene = Scene()
    solid, clear = tessellate(Box((1, 1, 1))), tessellate(Box((2, 2, 2)), (1.0, 0.5, 0.0, 0.3))
    assert scene.add("both", [solid, clear]).casts_shadow
    assert not scene.add("hull", [clear]).casts_shadow
    assert not scene.add("line", [solid], shadow=False).casts_shadow
