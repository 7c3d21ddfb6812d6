"""Inertias from shapes: closed meshes against trimesh, primitives against MuJoCo, files against their numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna import Inertia
from ulna.cli import main
from ulna.diagnosis import repair_inertias, shape_inertias
from ulna.errors import InputError, ModelWarning, ShapeError, UnknownName

SHAPES = {
    "box": '<box size="0.1 0.2 0.3"/>',
    "sphere": '<sphere radius="0.1"/>',
    "cylinder": '<cylinder radius="0.1" length="0.4"/>',
    "capsule": '<capsule radius="0.1" length="0.4"/>',
}


def link(name: str, *shapes: str, inertial: str = "", role: str = "collision") -> str:
    bodies = "".join(
        f'<{role}><origin xyz="0.1 {0.2 * k} -0.3" rpy="0.3 -0.5 0.7"/><geometry>{shape}</geometry></{role}>'
        for k, shape in enumerate(shapes)
    )
    return f'<link name="{name}">{inertial}{bodies}</link>'


def arm(*links: str) -> str:
    joint = '<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>'
    return f'<robot name="arm"><link name="base"/>{"".join(links)}{joint}</robot>'


@pytest.mark.parametrize("kind", SHAPES)
def test_primitives_are_those_of_mujoco(kind: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    size = {"box": "0.05 0.1 0.15", "sphere": "0.1", "cylinder": "0.1 0.2", "capsule": "0.1 0.2"}[kind]
    text = f"""<mujoco><compiler angle="radian" eulerseq="XYZ"/><worldbody><body><joint type="hinge"/>
        <geom type="{kind}" size="{size}" pos="0.1 0 -0.3" euler="0.3 -0.5 0.7" density="2700"/></body></worldbody></mujoco>"""
    theirs = mujoco.MjModel.from_xml_string(text)
    ours = shape_inertias(ulna.load(arm(link("arm", SHAPES[kind]))), density=2700.0)["arm"]
    assert ours.mass == pytest.approx(theirs.body_mass[1], rel=1e-9)
    np.testing.assert_allclose(ours.com, theirs.body_ipos[1], atol=1e-9)
    np.testing.assert_allclose(np.linalg.eigvalsh(ours.inertia), np.sort(theirs.body_inertia[1]), rtol=1e-7)


@pytest.mark.parametrize("seed", range(5))
def test_closed_meshes_are_those_of_trimesh(seed: int) -> None:
    trimesh = pytest.importorskip("trimesh")
    rng = np.random.default_rng(seed)
    mesh = trimesh.creation.icosphere(subdivisions=2) if seed % 2 else trimesh.creation.annulus(0.2, 0.5, 1.0)
    mesh.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
    mesh.vertices = mesh.vertices * rng.uniform(0.1, 2.0, 3) + rng.uniform(-5.0, 5.0, 3)
    mesh.density = 3.0 / mesh.volume
    ours = Inertia.from_mesh(3.0, mesh.vertices, mesh.faces)
    np.testing.assert_allclose(ours.com, mesh.center_mass, rtol=1e-9)
    np.testing.assert_allclose(ours.inertia, mesh.moment_inertia, rtol=1e-6, atol=1e-9)
    inside_out = Inertia.from_mesh(3.0, mesh.vertices, mesh.faces[:, ::-1])
    np.testing.assert_allclose(inside_out.inertia, ours.inertia, rtol=1e-9, atol=1e-12)


def test_far_from_the_origin_moments_stay_precise() -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    for shift in (0.0, 1e3, 1e5):
        ours = Inertia.from_mesh(12.0, corners + shift, faces)
        np.testing.assert_allclose(np.diag(ours.inertia), [13.0, 10.0, 5.0], rtol=1e-6)


@pytest.mark.parametrize(
    ("vertices", "triangles", "error", "match"),
    [
        (np.eye(3), [[0, 1, 2]], InputError, "not closed"),
        (np.eye(3), [[0, 1, 2], [0, 2, 1]], InputError, "no volume"),
        (np.eye(3), [[0, 1, 3]], InputError, "indices of the 3 vertices"),
        (np.eye(3), [[0.0, 1.0, 2.0]], InputError, "indices"),
        (np.eye(2), [[0, 1, 2]], ShapeError, "vertices"),
        (np.eye(3) * np.nan, [[0, 1, 2]], InputError, "nan"),
        (np.zeros((0, 3)), [[0, 1, 2]], ShapeError, "vertices"),
        (np.eye(3), np.zeros((0, 3), int), ShapeError, "triangles"),
    ],
)
def test_surfaces_without_an_inside_are_refused(vertices, triangles, error, match) -> None:
    with pytest.raises(error, match=match):
        Inertia.from_mesh(1.0, vertices, triangles)


def test_the_mass_is_that_passed_then_its_own_then_of_the_density() -> None:
    own = '<inertial><mass value="2"/><inertia ixx="9" iyy="9" izz="9" ixy="0" ixz="0" iyz="0"/></inertial>'
    heavy, light = (ulna.load(arm(link("arm", SHAPES["box"], inertial=text))) for text in (own, ""))
    assert shape_inertias(heavy)["arm"].mass == 2.0
    assert shape_inertias(heavy, density=1000.0)["arm"].mass == 2.0
    assert shape_inertias(heavy, masses={"arm": 5.0})["arm"].mass == 5.0
    assert shape_inertias(light, density=1000.0)["arm"].mass == pytest.approx(6.0)
    with pytest.raises(InputError, match=r"'arm' has no mass. Pass density="):
        shape_inertias(light)
    inertia = shape_inertias(heavy)["arm"].inertia
    np.testing.assert_allclose(
        np.linalg.eigvalsh(inertia),
        np.sort(np.diag(Inertia.from_box(2.0, (0.1, 0.2, 0.3)).inertia)),
    )


def test_shapes_of_a_link_add_up_and_visuals_stand_in() -> None:
    both = shape_inertias(ulna.load(arm(link("arm", SHAPES["box"], SHAPES["sphere"]))), density=1.0)["arm"]
    assert both.mass == pytest.approx(0.006 + 4 / 3 * np.pi * 1e-3)
    seen = ulna.load(arm(link("arm", SHAPES["box"], role="visual")))
    assert shape_inertias(seen, density=1.0)["arm"].mass == pytest.approx(0.006)


def test_an_open_mesh_counts_as_its_hull(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    cube = trimesh.creation.box((0.1, 0.2, 0.3))
    for name, faces in (("whole", cube.faces), ("open", cube.faces[2:])):
        trimesh.Trimesh(cube.vertices, faces, process=False).export(tmp_path / f"{name}.stl")
    for name in ("whole", "open"):
        (tmp_path / "arm.urdf").write_text(arm(link("arm", f'<mesh filename="{name}.stl" scale="1 -2 1"/>')))
        robot = ulna.load(tmp_path / "arm.urdf")
        if name == "open":
            with pytest.warns(ModelWarning, match="not closed") as said:
                mass = shape_inertias(robot, density=1.0)["arm"].mass
            assert said[0].filename == __file__
        else:
            mass = shape_inertias(robot, density=1.0)["arm"].mass
        assert mass == pytest.approx(0.012, rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "error", "match"),
    [
        ({"links": ["arn"]}, UnknownName, "arm"),
        ({"links": ["base"], "density": 1.0}, InputError, "'base' has no shapes"),
        ({"density": -1.0}, InputError, "density"),
        ({"density": "heavy"}, InputError, "density"),
        ({"masses": {"arm": 0.0}}, InputError, "mass above 0"),
        ({"masses": {"base": 1.0}, "density": 1.0}, InputError, "none of the links"),
        ({"shapes": "meshes"}, UnknownName, "collision"),
    ],
)
def test_wrong_arguments_are_refused(arguments, error, match) -> None:
    with pytest.raises(error, match=match):
        shape_inertias(ulna.load(arm(link("arm", SHAPES["box"]))), **arguments)


def test_shapes_without_volume_are_refused() -> None:
    with pytest.raises(InputError, match="no volume"):
        shape_inertias(ulna.load(arm(link("arm", '<box size="0 0.2 0.3"/>'))), density=1.0)


def test_files_are_repaired_from_shapes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = '<inertial><mass value="2"/><inertia ixx="1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/><!-- CAD --></inertial>'
    for inertial in (own, ""):
        bad, good = tmp_path / "bad.urdf", tmp_path / "good.urdf"
        bad.write_text("<!-- of CAD -->" + arm(link("arm", SHAPES["box"], inertial=inertial)))
        assert (
            main(["info", str(bad), "--repair", str(good), "--from-shapes", "arm", "--density", "1000"]) == 0
        )
        assert "arm repaired" in capsys.readouterr().out
        assert "<!-- of CAD -->" in good.read_text()
        repaired = ulna.load(good).model.link("arm").inertia
        expected = shape_inertias(ulna.load(good), ["arm"])["arm"]
        assert repaired.mass == pytest.approx(2.0 if inertial else 6.0)
        np.testing.assert_allclose(repaired.com, expected.com, rtol=1e-8)
        np.testing.assert_allclose(repaired.inertia, expected.inertia, rtol=1e-6, atol=1e-9)


def test_wrong_repairs_write_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad, good = tmp_path / "bad.urdf", tmp_path / "good.urdf"
    bad.write_text(arm(link("arm", SHAPES["box"])))
    for arguments, match in (
        ({"links": "arm"}, "names in a list"),
        ({"density": 1.0}, "of which none is named"),
        ({"links": ["arm"]}, "has no mass"),
        ({"links": ["arn"], "density": 1.0}, "arm"),
    ):
        with pytest.raises((InputError, UnknownName), match=match):
            repair_inertias(bad, good, **arguments)
    assert main(["info", str(bad), "--density", "1000"]) == 2
    assert "--repair" in capsys.readouterr().err
    assert not good.exists()
