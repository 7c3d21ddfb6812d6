"""Shapes of Ulna's package: sizes, colours, frames, collisions, and the same answers as spatialgeometry itself."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import variables
from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.viewer.viewer import Viewer

pytest.importorskip("spatialmath")


@pytest.fixture(scope="module")
def sg() -> Iterator[Any]:
    with using("roboticstoolbox"):
        import spatialgeometry

        yield spatialgeometry


ASKED = """
import json
import numpy as np, spatialgeometry as sg, spatialmath as sm
out = {}
for name, shape in {
    "cuboid": sg.Cuboid([0.1, 0.2, 0.3], pose=sm.SE3(1, 2, 3) * sm.SE3.Rx(0.4), color="orange"),
    "box": sg.Box([1, 2, 3], color=[255, 128, 0]),
    "sphere": sg.Sphere(0.2, color="#102030", pose=sm.SE3(0.1, 0, 0.2).A),
    "cylinder": sg.Cylinder(0.1, 0.5, pose=sm.SE3.Ry(0.3), color=(0.1, 0.2, 0.3, 0.4)),
}.items():
    shape.v = [1, 2, 3, 4, 5, 6]
    out[name] = {
        "dict": shape.to_dict(), "fk": shape.fk_dict(), "color": list(map(float, shape.color)), "repr": repr(shape),
        "bounds": shape.bounds().tolist(), "world": shape.bounds(world=True).tolist(),
        "corners": shape.corners(world=True).tolist(), "extents": shape.extents().tolist(),
        "v": shape.v.tolist(), "T": shape.T.tolist(), "opacity": float(shape.opacity), "stype": shape.stype,
    }
solids = [sg.Cuboid([0.4, 0.3, 0.2], pose=sm.SE3(0.1, 0.6, 0.2) * sm.SE3.Rz(0.3)), sg.Sphere(0.3),
          sg.Cylinder(0.1, 0.6, pose=sm.SE3(0.5, 0, 0) * sm.SE3.Rx(0.7)), sg.Sphere(0.2, pose=sm.SE3(0.25, 0, 0.1))]
out["near"] = [[a.closest_point(b, 10)[0] for b in solids if b is not a] for a in solids]
out["points"] = np.array(solids[0].closest_point(solids[1])[1:]).tolist()
out["far"] = solids[0].closest_point(solids[1], 0.01)
out["hit"] = [[a.iscollided(b) for b in solids if b is not a] for a in solids]
group = sg.CollisionShapeGroup([solids[1], solids[2]])
out["group"] = [group.closest_point(solids[0])[0], group.iscollided(solids[3]), len(group)]
child, parent = sg.Sphere(0.1, pose=sm.SE3(0, 0, 1)), sg.Cuboid([1, 1, 1], pose=sm.SE3.Rx(0.5))
child.attach_to(parent)
parent.T = sm.SE3(1, 0, 0) * sm.SE3.Rx(0.7)
parent.update()
out["tree"] = [child._wT.tolist(), child.T.tolist(), child._wq.tolist(), len(parent.scene_children), parent.tree()]
for kind in (sg.Axes(0.1, pose=sm.SE3(1, 0, 0)), sg.Arrow(0.3, head_length=0.3), sg.Polyline(np.arange(12).reshape(3, 4))):
    described = kind.to_dict()
    out[described["stype"]] = {k: described[k] for k in ("t", "q", "v", "opacity") }
print(json.dumps(out))
"""


def answers(variables: dict[str, str]) -> dict[str, Any]:
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", ASKED],
        env=variables,
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def same(a: Any, b: Any, where: str = "") -> None:
    assert type(a) is type(b) or {type(a), type(b)} <= {int, float}, where
    if isinstance(a, dict):
        assert a.keys() == b.keys(), where
        for key in a:
            same(a[key], b[key], f"{where}/{key}")
    elif isinstance(a, list):
        assert len(a) == len(b), where
        for k, (x, y) in enumerate(zip(a, b, strict=True)):
            same(x, y, f"{where}/{k}")
    elif isinstance(a, float) and not isinstance(b, bool):
        assert a == pytest.approx(b, abs=1e-6), where  # coal stops its iterations at 1e-6
    else:
        assert a == b, where


def test_it_answers_as_the_package_does() -> None:
    pytest.importorskip("spatialgeometry")
    pytest.importorskip("coal")
    same(answers(variables("roboticstoolbox")), answers(variables(None)))


def test_every_public_name_of_the_package_is_there(sg: Any) -> None:
    distribution("spatialgeometry")  # what is compared with
    code = "import json, spatialgeometry as sg; print(json.dumps({n: [m for m in dir(getattr(sg, n)) if m[0] != '_'] for n in sg.__all__}))"
    done = subprocess.run(
        [sys.executable, "-c", code], env=variables(None), capture_output=True, text=True, check=True
    )
    absent = {
        f"{name}.{member}"
        for name, members in json.loads(done.stdout).items()
        for member in members
        if name != "tools" and not hasattr(getattr(sg, name), member)
    }
    assert absent <= {"SceneGroup.copy"}  # of lists, not of frames


def test_older_and_newer_spelling_of_the_pose_are_one(sg: Any) -> None:
    from spatialmath import SE3

    T = SE3(1, 2, 3)
    with pytest.warns(FutureWarning, match="former name of `pose`"):
        shape = sg.Sphere(0.1, base=T)
    assert np.array_equal(shape.T, sg.Sphere(0.1, pose=T.A).T)
    shape.base = SE3(0, 0, 1)
    assert shape.T[2, 3] == 1 and isinstance(shape.base, SE3)
    with pytest.raises(InputError, match="not both"):
        sg.Sphere(0.1, base=T, pose=T)


def test_world_poses_need_no_update(sg: Any) -> None:
    a, b, c = (sg.SceneNode() for _ in range(3))
    a.attach(b)
    b.attach(c)
    move = np.eye(4)
    move[:3, 3] = 1, 2, 3
    a.T = b.T = move
    assert np.array_equal(c._wT[:3, 3], [2, 4, 6])
    with pytest.raises(InputError, match="circles"):
        a.attach_to(c)
    c.scene_parent = a
    assert b.scene_children == [] and a.scene_children == [b, c] and np.array_equal(c._wT[:3, 3], [1, 2, 3])
    c.scene_parent = None
    assert not c.attached
    a.scene_children = [c]
    assert not b.attached and c.attached


def test_groups_are_lists_that_move_together(sg: Any) -> None:
    a, b, c = (sg.Sphere(0.1 * k) for k in (1, 2, 3))
    group = sg.SceneGroup([a, c])
    group.insert(1, b)
    assert list(group) == [a, b, c] and group[1] is b and len(group) == 3
    move = np.eye(4)
    move[0, 3] = 5
    group.T = move
    assert all(s._wT[0, 3] == 5 for s in group)
    group.remove(b)
    assert not b.attached and list(group) == [a, c]
    group[0] = b
    assert list(group) == [b, c] and not a.attached
    assert group.pop() is c and list(group) == [b]
    with pytest.raises(TypeError, match="holds solids"):
        sg.CollisionShapeGroup([sg.Axes(0.1)])


@pytest.mark.parametrize(
    ("bad", "error"),
    [
        (lambda sg: sg.Cuboid([1, 2]), InputError),
        (lambda sg: sg.Sphere(-1), InputError),
        (lambda sg: sg.Sphere("big"), InputError),
        (lambda sg: sg.Sphere(1, color="nocolour"), UnknownName),
        (lambda sg: sg.Sphere(1, color="#12345g"), UnknownName),
        (lambda sg: sg.Sphere(1, color=[1, 2]), InputError),
        (lambda sg: sg.Sphere(1, color=[-1, 0, 0]), InputError),
        (lambda sg: sg.Sphere(1, color=[np.nan, 0, 0]), InputError),
        (lambda sg: sg.Sphere(1, pose=np.eye(3)), ShapeError),
        (lambda sg: sg.Sphere(1, pose=np.full((4, 4), np.nan)), NonFiniteError),
        (lambda sg: sg.Sphere(1, pose=2 * np.eye(4)), InputError),
        (lambda sg: sg.Polyline(np.zeros((4, 3))), ShapeError),
        (lambda sg: sg.Mesh("nothing.stl"), FileNotFoundError),
        (lambda sg: sg.Arrow.FromTo([0, 0, 1], [0, 0, 1]), InputError),
        (lambda sg: sg.Sphere(1, collision=False).iscollided(sg.Sphere(1)), InputError),
        (lambda sg: sg.Sphere(1).iscollided(sg.Axes(1)), InputError),
        (lambda sg: sg.Sphere(1).attach_to("hand"), InputError),
        (lambda sg: sg.Axes(0.1).bounds(), NotImplementedError),
        (lambda sg: sg.Torus, AttributeError),
    ],
)
def test_impossible_shapes_are_refused(sg: Any, bad: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        bad(sg)


def test_a_refused_size_leaves_the_shape_as_it_was(sg: Any) -> None:
    shape = sg.Cylinder(0.1, 0.2)
    with pytest.raises(InputError):
        shape.length = np.nan
    assert shape.length == 0.2
    before = shape.changes
    shape.length, shape.color = 0.3, "red"
    assert shape.changes == before + 2 and shape.solid.length == 0.3


def test_a_copy_is_on_its_own(sg: Any) -> None:
    parent, shape = sg.Sphere(1, pose=_at(1, 0, 0)), sg.Cuboid([1, 2, 3], pose=_at(0, 1, 0), color="red")
    shape.attach_to(parent)
    twin = shape.copy()
    assert not twin.attached and np.array_equal(twin.T, shape._wT) and twin.color == shape.color
    twin.v[0] = 1
    twin.scale = [1, 1, 1]
    assert shape.v[0] == 0 and shape.scale[2] == 3


def test_everything_can_be_drawn(sg: Any, tmp_path: Path) -> None:
    mesh = tmp_path / "part.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n")
    pytest.importorskip("trimesh")
    viewer = Viewer(page=False)
    shapes = [
        sg.Cuboid([0.1, 0.2, 0.3]),
        sg.Sphere(0.1, color=[1, 0, 0, 0.5]),
        sg.Cylinder(0.1, 0.2),
        sg.Capsule(0.1, 0.2),
        sg.Cone(0.1, 0.2),
        sg.Ellipsoid([0.1, 0.2, 0.3]),
        sg.Mesh(mesh, scale=0.1, y_up=True),
        sg.Axes(0.1),
        sg.Arrow(0.5, radius=0.01),
        sg.Arrow.FromTo([0, 0, 0], [1, 1, 1]),
        sg.Polyline(np.eye(3)),
        sg.CollisionShapeGroup([sg.Sphere(0.1, pose=_at(1, 0, 0)), sg.Sphere(0.2)]),
    ]
    for k, shape in enumerate(shapes):
        shape.draw(viewer, f"shape {k}")
    assert viewer["shape 1"].opacity == 0.5 and viewer["shape 1"].color == (1.0, 0.0, 0.0)
    points = viewer.scene.points()
    assert points[:, 0].max() == pytest.approx(1.1, abs=0.02)  # the ball of the group
    top = Viewer(page=False)
    arrow = sg.Arrow.FromTo([1, 0, 0], [1, 0, 2])
    arrow.draw(top, "arrow")
    top["arrow"].pose = arrow._wT
    assert top.scene.points()[:, 2].min() == pytest.approx(0, abs=1e-6)
    assert top.scene.points()[:, 2].max() == pytest.approx(2, abs=1e-6)


def _at(x: float, y: float, z: float) -> np.ndarray:
    out = np.eye(4)
    out[:3, 3] = x, y, z
    return out
