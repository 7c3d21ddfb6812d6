"""The surfaces of a robot's links, and how far loading them has come."""

import pytest

import ulna
from ulna.errors import UnknownName
from ulna.viewer.robot.link_surfaces import surfaces_by_link


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.mark.parametrize("show", ["visual", "collision", "both"])
def test_progress_goes_from_none_to_all_links(panda: ulna.Robot, show: str) -> None:
    told: list[tuple[int, int]] = []
    surfaces = surfaces_by_link(panda, show, report=lambda done, of: told.append((done, of)))  # type: ignore[arg-type]
    count = len(panda.model.links)
    assert len(surfaces) == count
    assert told == [(k, count) for k in range(count + 1)]


def test_both_are_the_shapes_and_the_collision_shapes(panda: ulna.Robot) -> None:
    visual, collision, both = (surfaces_by_link(panda, show) for show in ("visual", "collision", "both"))
    for one, other, together in zip(visual, collision, both, strict=True):
        assert len(together) == len(one) + len(other)
    with pytest.raises(UnknownName, match="way to show a robot"):
        surfaces_by_link(panda, "everything")  # type: ignore[arg-type]
