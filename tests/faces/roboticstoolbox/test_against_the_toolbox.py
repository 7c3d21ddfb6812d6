"""The face gives the toolbox's answers: each probe is asked of both, of the face in a Python of its own."""

from __future__ import annotations

import importlib.util
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

rtb = pytest.importorskip("roboticstoolbox")
import spatialmath  # noqa: E402

from ulna.faces.shelves import SHELVES, environment  # noqa: E402

HERE = Path(__file__).parent


def _probe(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


PROBES = {name: _probe(name) for name in ("kinematics_probe", "dynamics_probe")}


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for name in PROBES:
        file = tmp_path_factory.mktemp("face") / "answers.pickle"
        command = [sys.executable, str(HERE / f"{name}.py"), str(file)]
        subprocess.run(command, env=environment(["roboticstoolbox"]), check=True, timeout=300)
        with file.open("rb") as stream:
            place, found = pickle.load(stream)
        assert place.startswith(str(SHELVES["roboticstoolbox"]))
        out |= found
    return out


@pytest.mark.parametrize("part", [part for probe in PROBES.values() for part in probe.PARTS])
def test_answers_are_those_of_the_toolbox(part: str, answers: dict[str, Any]) -> None:
    asked = next(probe.PARTS[part] for probe in PROBES.values() if part in probe.PARTS)
    theirs = asked(rtb, spatialmath)
    assert not str(rtb.__file__).startswith(str(SHELVES["roboticstoolbox"]))
    ours = answers[part]
    wrong = [name for name in theirs if not _same(ours.get(name), theirs[name])]
    assert set(ours) >= set(theirs)
    assert not wrong, "\n".join(f"{name}:\n{ours[name]}\n{theirs[name]}" for name in wrong[:6]) + f"\n{wrong}"


def _same(ours: Any, theirs: Any) -> bool:
    if isinstance(theirs, str) or (isinstance(theirs, list) and theirs and isinstance(theirs[0], str)):
        return ours == theirs
    a, b = np.asarray(ours, dtype=float), np.asarray(theirs, dtype=float)
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=1e-9, atol=1e-9))
