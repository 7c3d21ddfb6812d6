"""Reduced and appended models are Pinocchio's to the last frame: order, parents, placements, inertias, postures, solids."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.two_pythons import both
from ulna.robots.example_robot_data import share_folder

FILES = (
    "ur_description/urdf/ur5_robot.urdf",
    "solo_description/robots/solo12.urdf",
    "double_pendulum_description/urdf/double_pendulum.urdf",
)


def test_reduced_and_appended_models_are_the_same(tmp_path: Path) -> None:
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    own, wanted = both(
        Path(__file__).parent / "asked_put_together.py",
        tmp_path,
        *(str(share / "robots" / file) for file in FILES),
    )
    assert own.keys() == wanted.keys()
    wrong = [
        (model, part)
        for model in wanted
        for part in wanted[model]
        if not _same(own[model][part], wanted[model][part])
    ]
    assert not wrong


def _same(own: Any, wanted: Any) -> bool:
    if isinstance(wanted, list):
        return len(own) == len(wanted) and all(_same(a, b) for a, b in zip(own, wanted, strict=True))
    return own == wanted if isinstance(wanted, str) else bool(np.isclose(own, wanted, rtol=1e-9, atol=1e-12))
