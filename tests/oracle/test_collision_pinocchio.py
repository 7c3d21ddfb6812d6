"""Collision against coal as Pinocchio calls it, on geometry that Pinocchio reads from the same files."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")
pytest.importorskip("coal")

from support.pinocchio_models import from_pinocchio, to_pinocchio  # noqa: E402
from support.scenes import geometry_model, table  # noqa: E402
from ulna.collision import Checker  # noqa: E402
from ulna.errors import ModelWarning  # noqa: E402
from ulna.formats.urdf import model_from_urdf  # noqa: E402
from ulna.loading import load_model  # noqa: E402
from ulna.robots import example_robot_data  # noqa: E402


def verdicts(twin: Any, geometry: Any, q: Any) -> tuple[list[bool], list[float]]:
    data, geometry_data = twin.pin.createData(), geometry.createData()
    hits, least = [], []
    for row in q:
        hits.append(pin.computeCollisions(twin.pin, data, geometry, geometry_data, twin.q(row), True))
        k = pin.computeDistances(twin.pin, data, geometry, geometry_data, twin.q(row))
        least.append(geometry_data.distanceResults[k].min_distance)
    return hits, least


@pytest.mark.parametrize(("name", "link"), [("panda", "panda_link0"), ("ur5", "base_link")])
def test_same_collisions_and_distances_in_a_scene(name: str, link: str) -> None:
    model = load_model(name)
    checker, twin = Checker(model, table(link)), to_pinocchio(model)
    rng = np.random.default_rng(0)
    q = np.clip(rng.uniform(-2.5, 2.5, (60, model.nq)), model.lower_position, model.upper_position)
    hits, least = verdicts(twin, geometry_model(pin, checker), q)
    np.testing.assert_array_equal(checker.collides(q), hits)
    # coal stops within 1e-6, and poses that differ in the last bit take it another way there
    np.testing.assert_allclose(checker.distance(q).distance, least, atol=2e-6)
    assert 0 < sum(hits) < 60


@pytest.mark.parametrize(
    ("name", "count", "tolerance"),
    [("anymal", 40, 1e-9), ("panda", 4, 1e-6), ("ur5", 4, 1e-6), ("talos", 2, 1e-6)],
)
@pytest.mark.filterwarnings("ignore:.*no collision geometry.*imu_link")
def test_same_on_files_with_meshes_and_srdf(name: str, count: int, tolerance: float) -> None:
    """Geometry, placements, meshes are read twice, by Ulna and by Pinocchio; pairs are those of Ulna."""
    if example_robot_data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    urdf = str(example_robot_data.files(name)[0])
    share = str(example_robot_data.share_folder())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)
        model = model_from_urdf(urdf)
    twin = from_pinocchio(pin.buildModelFromUrdf(urdf))
    folders = [share, share.removesuffix("/example-robot-data")]
    geometry = pin.buildGeomFromUrdf(twin.pin, urdf, pin.GeometryType.COLLISION, package_dirs=folders)
    checker = Checker(model)
    places, seen = {}, {}
    for k, solid in enumerate(checker.solids):
        number = seen[solid.owner] = seen.get(solid.owner, -1) + 1
        places[k] = geometry.getGeometryId(f"{solid.owner}_{number}")
        assert places[k] < geometry.ngeoms
    assert len(checker.solids) == geometry.ngeoms
    for i, j in np.argwhere(checker.mask).tolist():
        geometry.addCollisionPair(pin.CollisionPair(places[i], places[j]))
    rng = np.random.default_rng(1)
    low, high = np.maximum(model.lower_position, -2.0), np.minimum(model.upper_position, 2.0)
    q = rng.uniform(low, high, (count, model.nq))
    names = [joint.name for joint in twin.model.joints]
    order = [model.joint(n).idx_q for n in names]
    hits, least = verdicts(twin, geometry, q[:, order])
    np.testing.assert_array_equal(checker.collides(q), hits)
    found = checker.distance(q).distance
    apart = np.array(least) > 0.0
    np.testing.assert_allclose(found[apart], np.array(least)[apart], atol=tolerance)
    np.testing.assert_array_equal(found <= 0.0, ~apart)
