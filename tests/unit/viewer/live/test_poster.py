"""The first picture of a page: a robot on a transparent ground, in the smallest format that can be written."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest

import ulna
from ulna.geometry import Box
from ulna.viewer.graph.camera import camera_for
from ulna.viewer.live import poster as module


@pytest.mark.parametrize(("has_webp", "kind"), [(True, "webp"), (False, "png")])
def test_it_is_written_as_webp_where_pillow_can(
    monkeypatch: pytest.MonkeyPatch, has_webp: bool, kind: str
) -> None:
    image = pytest.importorskip("PIL.Image")
    features = pytest.importorskip("PIL.features")
    if not features.check("webp"):
        pytest.skip("this build of Pillow writes no WebP")
    viewer = ulna.Viewer(page=False)
    viewer.add(Box((0.2, 0.2, 0.2)), color="red")
    monkeypatch.setattr(features, "check", lambda name: has_webp)
    monkeypatch.setattr(module, "_WIDTH", 90)
    monkeypatch.setattr(module, "_HEIGHT", 60)
    url = module.poster(viewer.scene, camera_for(viewer.scene, 1.6), 0.0)
    assert url.startswith(f"data:image/{kind};base64,")
    picture = image.open(io.BytesIO(base64.b64decode(url.partition(",")[2]))).convert("RGBA")
    assert picture.size == (90, 60)
    opacity = np.asarray(picture)[..., 3]
    assert opacity[30, 45] > 200 and opacity[0, 0] < 30  # the box in the middle, nothing in a corner
