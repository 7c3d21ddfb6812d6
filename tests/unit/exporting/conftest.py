"""The Panda, and its functions as C in both precisions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import ulna

KERNELS = ("fk", "jacobian", "inverse_dynamics", "ik")


@pytest.fixture(scope="session")
def panda() -> ulna.Robot:
    return ulna.load("panda")


@pytest.fixture(scope="session", params=["float64", "float32"])
def exported(panda: ulna.Robot, tmp_path_factory: pytest.TempPathFactory, request: Any) -> Path:
    place = tmp_path_factory.mktemp("c") / request.param
    return ulna.export(panda, KERNELS, to="c", path=place, dtype=request.param)
