"""Reachability maps: right, the same on any cluster, stored whole, drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import scale
from ulna.errors import InputError, UnknownName
from ulna.scale.grid import DIRECTIONS, Grid, bits, count_bits, direction_numbers

zarr = pytest.importorskip("zarr")


@pytest.fixture(scope="module")
def ur5() -> ulna.Robot:
    return ulna.load("ur5")


@pytest.fixture(scope="module")
def made(ur5: ulna.Robot) -> scale.ReachMap:
    return scale.reach(ur5, 60_000, voxel=0.2, solutions=300, chunk=25_000, workers=0, progress=False)


def test_a_map_holds_what_its_samples_did(ur5: ulna.Robot, made: scale.ReachMap) -> None:
    samples = scale.Samples(60_000, 25_000, 0)
    assert samples.parts == 3 and samples.size(2) == 10_000
    rng, blocks = samples.generator(0), []
    for rows in (16_384, 25_000 - 16_384):  # as a part draws them
        blocks.append(ur5.random_configuration(rows, rng))
    q = np.concatenate(blocks)
    one = scale.reach(ur5, 25_000, voxel=0.2, chunk=25_000, workers=0, progress=False)
    T, measure = ur5.fk(q), ur5.manipulability(q)
    low = one.grid.origin
    for point in ([0.5, 0.1, 0.3], [-0.3, 0.5, 0.7]):
        place = tuple(np.floor((np.array(point) - low) / 0.2).astype(int))
        inside = (np.floor((T[:, :3, 3] - low) / 0.2).astype(int) == place).all(axis=1)
        assert one.count[place] == inside.sum() > 20
        np.testing.assert_allclose(one.manipulability[place], measure[inside].max(), rtol=1e-12)
        np.testing.assert_allclose(one.mean_manipulability[place], measure[inside].mean(), rtol=1e-12)
        directions = len(set(direction_numbers(T[inside, :3, 2])))
        assert one.directions[place] == directions / DIRECTIONS
        assert one.at(point, "density") == inside.sum()
    assert made.count.sum() + made.outside == 60_000
    assert 2.0 < made.volume < 6.0
    assert 2.0 <= np.nanmean(made.solutions) <= 8.0
    assert made.at([[9.0, 9.0, 9.0], [0.5, 0.1, 0.3]]).tolist()[0] == 0.0


def test_the_map_is_the_same_on_a_local_cluster(
    ur5: ulna.Robot, made: scale.ReachMap, tmp_path: Path
) -> None:
    pytest.importorskip("distributed")
    to = tmp_path / "reach.zarr"
    options: Any = {"voxel": 0.2, "solutions": 300, "chunk": 25_000, "progress": False}
    got = scale.reach(ur5, 60_000, workers=2, to=to, **options)
    again = scale.ReachMap.load(to)
    for name in ("count", "directions", "manipulability", "mean_manipulability", "solutions"):
        np.testing.assert_array_equal(getattr(got, name), getattr(made, name))
        np.testing.assert_array_equal(getattr(again, name), getattr(made, name))
    assert again.outside == made.outside and again.grid.shape == made.grid.shape
    assert scale.reach(ur5, 60_000, workers=0, to=to, **options).robot is ur5  # there already
    with pytest.raises(InputError, match="its samples is 60000, here it is 70000"):
        scale.reach(ur5, 70_000, workers=0, to=to, **options)


def test_pictures(made: scale.ReachMap, tmp_path: Path) -> None:
    picture = made.picture(tmp_path / "reach.png", "manipulability")
    assert (tmp_path / "reach.png").stat().st_size > 10_000
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 1000
    with pytest.raises(UnknownName, match="manipulability"):
        made.picture(tmp_path / "reach.png", "manipulabilty")  # type: ignore[arg-type]
    assert "voxels of 0.2 m" in repr(made)


def test_a_page(made: scale.ReachMap, tmp_path: Path) -> None:
    pytest.importorskip("viser")
    assert made.page(tmp_path / "reach.html").stat().st_size > 100_000


def test_wrong_arguments(ur5: ulna.Robot, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"`samples` is 1.5; expected a whole number from 1"):
        scale.reach(ur5, 1.5)
    with pytest.raises(InputError, match="at most 4,000,000"):
        scale.reach(ur5, 10, voxel=0.001, workers=0)
    with pytest.raises(InputError, match="`bounds` is"):
        scale.reach(ur5, 10, bounds=[0, 1])
    with pytest.raises(UnknownName, match="tool0"):
        scale.reach(ur5, 10, frame="tool")
    (tmp_path / "notes").write_text("mine")
    with pytest.raises(InputError, match=r"notes' is no Zarr group"):
        scale.reach(ur5, 10, to=tmp_path / "notes", workers=0, progress=False)
    assert (tmp_path / "notes").read_text() == "mine"


def test_grids_and_directions() -> None:
    grid = Grid.around(np.array([-0.11, 0.0, 0.04]), np.array([0.3, 0.1, 0.3]), 0.1)
    assert grid.shape == (5, 1, 3)
    numbers = np.arange(grid.size)
    back, inside = grid.numbers(grid.centres(numbers))
    np.testing.assert_array_equal(back, numbers)
    assert inside.all()
    axes = np.random.default_rng(0).standard_normal((200_000, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    shares = np.bincount(direction_numbers(axes), minlength=DIRECTIONS) / len(axes)
    assert abs(shares * DIRECTIONS - 1.0).max() < 0.1, "all directions have the same area"
    seen = np.random.default_rng(1).random((50, DIRECTIONS)) < 0.3
    np.testing.assert_array_equal(count_bits(bits(seen)), seen.sum(axis=1))
