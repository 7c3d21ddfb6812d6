"""How spheres are fitted: coverage and excess of concave, open and hollow meshes, refinement, spheres from files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ulna.collision import (
    Checker,
    LinkSpheres,
    SphereChecker,
    Spheres,
    World,
    fit,
    read_spheres,
    refine,
    spheres_of,
)
from ulna.collision.cover import cover
from ulna.collision.polyhedra import distance, split, triangles
from ulna.collision.region import region
from ulna.collision.solids import Solid
from ulna.errors import FormatError, InputError, ModelWarning
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Geometry, Mesh, Shape, Sphere
from ulna.model import Model, ModelBuilder, Prismatic
from ulna.spatial import SE3
from ulna.typing import Floats


def solid(shape: Shape, corners: Floats | None = None) -> Solid:
    """A solid; of a mesh with its triangles' corners (n, 3, 3)."""
    points = np.zeros((0, 3)) if corners is None else corners.reshape(-1, 3)
    return Solid("x", shape, -1, SE3.identity(), points, np.arange(len(points)).reshape(-1, 3))


def mesh(*boxes: tuple[tuple[float, ...], tuple[float, ...]]) -> Solid:
    """A mesh of boxes (size, middle) that may overlap, with what is inside left in."""
    corners = [triangles(solid(Box(size))) + np.array(middle) for size, middle in boxes]  # type: ignore[arg-type]
    return solid(Mesh("boxes.stl"), np.concatenate(corners))


def on(corners: Floats, count: int = 20_000) -> Floats:
    """Random points of triangles, as many for each area."""
    rng = np.random.default_rng(2)
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chosen = rng.choice(len(corners), count, p=area / area.sum())
    u, v = rng.random((2, count, 1))
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    return a[chosen] + u * (b - a)[chosen] + v * (c - a)[chosen]


def out_of(x: Floats, c: Floats, r: Floats) -> Floats:
    """How far points are outside of spheres."""
    return (np.linalg.norm(x[:, None] - c, axis=-1) - r).min(axis=1)


def of_boxes(x: Floats, *boxes: tuple[tuple[float, ...], tuple[float, ...]]) -> Floats:
    """How far points are from boxes, 0 inside."""
    beyond = [np.abs(x - np.array(middle)) - np.array(size) / 2.0 for size, middle in boxes]
    return np.min([np.linalg.norm(np.maximum(d, 0.0), axis=-1) for d in beyond], axis=0)


L = (((0.4, 0.1, 0.1), (0.2, 0.0, 0.0)), ((0.1, 0.1, 0.4), (0.05, 0.0, 0.2)))


def test_a_concave_mesh_is_covered_as_it_is_and_not_as_its_hull() -> None:
    link = mesh(*L)
    c, r, e = cover([link], [SE3.identity()], 0.01, 30)
    assert len(r) <= 30 and out_of(on(link.vertices[link.triangles]), c, r).max() <= 0.0
    rng = np.random.default_rng(0)
    inside = rng.uniform(-0.05, 0.4, (40_000, 3))
    inside = inside[of_boxes(inside, *L) == 0.0]
    assert out_of(inside, c, r).max() <= 0.0
    u = rng.standard_normal((500, 3))
    rim = (c[:, None] + r[:, None, None] * u / np.linalg.norm(u, axis=1, keepdims=True)).reshape(-1, 3)
    assert of_boxes(rim, *L).max() <= e < 0.04
    assert out_of(np.array([[0.25, 0.0, 0.25]]), c, r) > 0.05  # in the hull, far from the mesh


def test_an_open_mesh_is_covered_by_its_surface() -> None:
    tray = triangles(solid(Box((0.3, 0.3, 0.2))))
    tray = tray[~(tray[:, :, 2] > 0.099).all(axis=1)]
    c, r, _ = cover([solid(Mesh("tray.stl"), tray)], [SE3.identity()], 0.02, 60)
    assert len(tray) == 10 and out_of(on(tray), c, r).max() <= 0.0
    assert out_of(np.zeros((1, 3)), c, r) > 0.0  # what can be reached through the opening is free


def test_nothing_is_left_free_inside_of_a_shell() -> None:
    shell = mesh(((0.3, 0.3, 0.3), (0.0, 0.0, 0.0)), ((0.28, 0.28, 0.28), (0.0, 0.0, 0.0)))
    c, r, _ = cover([shell], [SE3.identity()], 0.03, 40)
    x = np.random.default_rng(0).uniform(-0.15, 0.15, (20_000, 3))
    assert out_of(x, c, r).max() <= 0.004  # at most gaps smaller than a cell of the grid


def test_a_mesh_without_triangles_is_refused() -> None:
    with pytest.raises(InputError, match="no triangles"):
        cover([solid(Mesh("empty.stl"), np.zeros((0, 3, 3)))], [SE3.identity()], 0.01, 4)


@pytest.mark.parametrize(
    "shape",
    [Sphere(0.2), Capsule(0.05, 0.3), Cylinder(0.05, 0.3), Cone(0.1, 0.3), Ellipsoid((0.05, 0.1, 0.2))],
    ids=lambda s: s.describe(),
)
def test_polyhedra_contain_their_shape_and_are_near_it(shape: Shape) -> None:
    """No point of the polyhedron is inside of the shape, so that the shape is inside of the polyhedron."""
    from ulna.collision.polyhedra import interior

    x = on(triangles(solid(shape)))
    assert not isinstance(shape, Sphere) or (np.linalg.norm(x, axis=1) >= 0.2 - 1e-12).all()
    assert not interior(shape, x).any()
    size = np.abs(x).max(axis=0) / np.array(solid(shape).bounds[1])
    assert (size >= 1.0 - 1e-12).all() and (size < 1.01).all()


def test_split_keeps_the_surface_and_distances_are_those_of_triangles() -> None:
    big = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.01, 0.0]]])
    small = split(big, 0.05)
    area = np.linalg.norm(np.cross(small[:, 1] - small[:, 0], small[:, 2] - small[:, 0]), axis=1).sum()
    assert area == pytest.approx(0.01, rel=1e-12)
    assert np.linalg.norm(small - np.roll(small, 1, axis=1), axis=-1).max() <= 0.05
    for p, expected in (
        ((0.2, 0.001, 0.3), 0.3),
        ((2.0, 0.0, 0.0), 1.0),
        ((0.5, -0.2, 0.0), 0.2),
        ((0.1, 0.001, -1.0), 1.0),
    ):
        assert distance(np.array(p), small) == pytest.approx(expected, abs=1e-12)


def chain(*shapes: tuple[Shape, ...], spacing: float = 0.3) -> Model:
    """Links on slides, one on the other; each has some shapes."""
    builder = ModelBuilder("chain")
    builder.add_link("rail")
    for k, group in enumerate(shapes):
        builder.add_link(f"link{k}", collisions=tuple(Geometry("", shape) for shape in group))
        parent = f"link{k - 1}" if k else "rail"
        place = SE3.from_translation((0.0, 0.0, spacing))
        builder.add_joint(
            f"slide{k}",
            Prismatic((1.0, 0.0, 0.0)),
            parent,
            f"link{k}",
            placement=place,
            lower=-0.1,
            upper=0.1,
        )
    return builder.build()


def test_links_near_the_tip_get_finer_spheres() -> None:
    block = (Box((0.2, 0.2, 0.2)),)
    found = fit(chain(block, block, block, block), most=14)
    assert found.count <= 4 * 14
    excess = [found.excess[f"link{k}"] or 0.0 for k in range(4)]
    assert excess[3] < excess[0] and excess == sorted(excess, reverse=True)


def test_balls_are_taken_as_they_are() -> None:
    model = chain((Sphere(0.1), Sphere(0.05)), (Sphere(0.2),))
    found = fit(model, most=1)
    assert found.links["link0"].radii.tolist() == [0.1, 0.05] and found.excess == {"link0": 0.0, "link1": 0.0}
    assert found == spheres_of(model)
    with pytest.raises(FormatError, match="box"):
        spheres_of(chain((Box((0.1, 0.1, 0.1)),)))


def test_shapes_that_are_spheres_are_not_compared_with_themselves(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*arguments: object, **options: object) -> None:
        raise AssertionError("the shapes of these links are their spheres")

    monkeypatch.setattr("ulna.collision.covering.Checker", never)
    found = fit(chain((Sphere(0.1),), (Sphere(0.1),), (Sphere(0.1),), spacing=0.15), tolerance=0.0123)
    assert found.count == 3 and set(found.excess.values()) == {0.0}


def test_refined_spheres_are_free_where_the_shapes_are() -> None:
    block = (Box((0.2, 0.2, 0.2)),)
    model = chain(block, block, block, spacing=0.13)
    world = World().add("plate", Box((0.2, 0.2, 0.02)), (0.0, 0.0, 0.13 * 3 + 0.1 + 0.06))
    ball = LinkSpheres(np.zeros((1, 3)), np.array([0.18]))
    q, rough = np.zeros((1, 3)), Spheres({f"link{k}": ball for k in range(3)})
    assert not Checker(model, world).collides(q).any()
    assert SphereChecker(model, world, spheres=rough).collides(q).any()
    fine = refine(model, rough, q, world)
    assert not SphereChecker(model, world, spheres=fine).collides(q).any()
    x = np.random.default_rng(0).uniform(-0.1, 0.1, (20_000, 3))
    assert max(out_of(x, s.centres, s.radii).max() for s in fine.links.values()) <= 0.0
    assert refine(model, fine, q, world) == fine
    with pytest.warns(ModelWarning, match="still touch"):
        refine(model, rough, q, world, most=2)
    with pytest.raises(InputError, match="most"):
        refine(model, rough, q, most=0)


def test_pairs_whose_spheres_always_touch_are_named() -> None:
    """Plates that slide past each other with less room than one sphere of each allows."""
    pytest.importorskip("coal")
    plate = (Box((0.5, 0.5, 0.01)),)
    model = chain(plate, (Sphere(0.001),), plate, spacing=0.03)
    with pytest.warns(ModelWarning, match="'link0' and 'link2' touch in every configuration"):
        fit(model, tolerance=0.05, most=1)
    with pytest.warns(ModelWarning, match="'link0' and 'link2'"):  # from the disk
        fit(model, tolerance=0.05, most=1)


URDF = """<robot name="balls"><link name="base"/><link name="arm"><collision><origin xyz="0 0 1"/>
<geometry><sphere radius="0.25"/></geometry></collision></link>
<joint name="j" type="fixed"><parent link="base"/><child link="arm"/></joint></robot>"""


def test_spheres_are_read_from_files(tmp_path: Path) -> None:
    expected = Spheres({"arm": LinkSpheres(np.array([[0.0, 0.0, 1.0]]), np.array([0.25]))})
    rows = {
        "arm": [{"center": [0.0, 0.0, 1.0], "radius": 0.25}],
        "tool": [{"center": [0, 0, 0], "radius": -10.0}],
    }
    files = {
        "a.urdf": URDF,
        "b.json": expected.to_json(),
        "c.json": json.dumps(rows),
        "d.yml": json.dumps({"collision_spheres": rows}),  # JSON is YAML
        "e.yaml": json.dumps({"robot_cfg": {"kinematics": {"collision_spheres": "d.yml"}}}),
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
        assert read_spheres(tmp_path / name) == expected, name


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.json", "{", "broken"),
        ("a.yml", "a: [", "broken"),
        ("a.json", "[1]", "no spheres by link"),
        ("a.json", '{"arm": [{"centre": 1}]}', "no spheres by link"),
        ("a.json", '{"arm": []}', "has no spheres"),
        ("a.urdf", URDF.replace('<sphere radius="0.25"/>', '<box size="1 1 1"/>'), "balls alone"),
    ],
)
def test_files_without_spheres(name: str, text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(FormatError, match=said):
        read_spheres(tmp_path / name)
    with pytest.raises(FormatError, match="cannot be read"):
        read_spheres(tmp_path / "none.json")


def test_distances_to_a_region_have_their_sign() -> None:
    from scipy.spatial import ConvexHull

    corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    box = region(corners[ConvexHull(corners).simplices], lambda pieces: np.zeros(len(pieces), dtype=bool))
    points = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 0.9], [1.3, 0.5, 0.5], [-0.2, 0.4, 0.5], [1.3, 1.4, 0.5]])
    np.testing.assert_allclose(box.signed_exactly(points), [-0.5, -0.1, 0.3, 0.2, 0.5], atol=1e-9)
