"""The surfaces of a robot's links, and how far loading them has come."""

from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna.errors import ModelWarning, UnknownName
from ulna.viewer.mesh.surface import DEFAULT_COLOUR
from ulna.viewer.robot.link_surfaces import link_surfaces, surfaces_by_link


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.mark.parametrize("show", ["visual", "collision", "both"])
def test_progress_goes_from_none_to_all_links(panda: ulna.Robot, show: str) -> None:
    reported: list[tuple[int, int]] = []
    surfaces = surfaces_by_link(panda, show, report=lambda done, of: reported.append((done, of)))  # type: ignore[arg-type]
    count = len(panda.model.links)
    assert len(surfaces) == count
    assert reported == [(k, count) for k in range(count + 1)]


def test_links_whose_meshes_are_missing_are_drawn_by_their_collision_shapes() -> None:
    box, mesh = '<box size="0.1 0.2 0.3"/>', '<mesh filename="absent.stl"/>'
    text = "<robot name='one'><link name='a'>{}<collision><geometry>{}</geometry></collision></link></robot>"
    visual = f"<visual><geometry>{mesh}</geometry></visual>"
    with pytest.warns(ModelWarning, match="absent.stl"):
        robot = ulna.load(text.format(visual, box))
    ((surface,),) = surfaces_by_link(robot, "visual")
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), [0.1, 0.2, 0.3], atol=1e-12)
    assert surface.rgba == DEFAULT_COLOUR
    assert surfaces_by_link(ulna.load(text.format("", box)), "visual") == [
        ()
    ]  # a link without visuals stays hidden


def test_both_are_the_shapes_and_the_collision_shapes(panda: ulna.Robot) -> None:
    visual, collision, both = (surfaces_by_link(panda, show) for show in ("visual", "collision", "both"))
    for one, other, together in zip(visual, collision, both, strict=True):
        assert len(together) == len(one) + len(other)
    with pytest.raises(UnknownName, match="way to show a robot"):
        surfaces_by_link(panda, "everything")  # type: ignore[arg-type]


def test_the_material_of_the_model_colours_a_mesh_without_one(tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    (tmp_path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for material, colour in (
        ('<material name="red"><color rgba="1 0 0 1"/></material>', (1.0, 0.0, 0.0)),
        ("", DEFAULT_COLOUR[:3]),
    ):
        (tmp_path / "arm.urdf").write_text(
            '<robot name="arm"><link name="base"><visual><geometry><mesh filename="one.obj"/></geometry>'
            f"{material}</visual></link></robot>"
        )
        model = ulna.load(tmp_path / "arm.urdf").model
        (surface,) = link_surfaces(model.links[0].visuals)
        np.testing.assert_allclose(surface.rgba[:3], colour)
