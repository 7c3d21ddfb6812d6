"""Ulna's package gives the toolbox's answers: each probe is asked of both, of Ulna's package in a separate Python process."""

from __future__ import annotations

import importlib.util
import pickle
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

rtb = pytest.importorskip("roboticstoolbox")
import spatialmath  # noqa: E402

from ulna.compat.packages import FOLDERS, environment  # noqa: E402

HERE = Path(__file__).parent


def _probe(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


PROBES = {
    name: _probe(name)
    for name in ("kinematics_probe", "dynamics_probe", "catalogue_probe", "scene_probe", "written_probe")
}


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    file = tmp_path_factory.mktemp("face") / "answers.pickle"
    command = [sys.executable, str(HERE / "asked.py"), str(file), *PROBES]
    subprocess.run(command, env=environment(["roboticstoolbox"]), check=True, timeout=600)
    with file.open("rb") as stream:
        place, found = pickle.load(stream)
    assert place.startswith(str(FOLDERS["roboticstoolbox"]))
    return found


@pytest.mark.parametrize("part", [part for probe in PROBES.values() for part in probe.PARTS])
def test_answers_are_those_of_the_toolbox(part: str, answers: dict[str, Any]) -> None:
    asked = next(probe.PARTS[part] for probe in PROBES.values() if part in probe.PARTS)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # warnings of the toolbox about its calls
        theirs = asked(rtb, spatialmath)
    assert not str(rtb.__file__).startswith(str(FOLDERS["roboticstoolbox"]))
    ours = answers[part]
    wrong = [name for name in theirs if not _same(name, ours.get(name), theirs[name])]
    assert set(ours) >= set(theirs)
    assert not wrong, "\n".join(f"{name}:\n{ours[name]}\n{theirs[name]}" for name in wrong[:6]) + f"\n{wrong}"


def _same(name: str, ours: Any, theirs: Any) -> bool:
    """Whether words are equal, and numbers to 1e-9 of the largest of them.

    What the toolbox finds by differences is compared less closely; inverse kinematics by whether it finds anything.
    """
    if isinstance(theirs, str) or (isinstance(theirs, list) and theirs and isinstance(theirs[0], str)):
        return ours == theirs
    if name.startswith("at least"):
        return bool(np.all(np.asarray(ours) >= np.asarray(theirs)))
    a, b = np.asarray(ours, dtype=float), np.asarray(theirs, dtype=float)
    near = 1e-6 if name.endswith(("_x", "exp")) else 1e-9
    size = max(1.0, float(np.nanmax(np.abs(b), initial=0.0)))
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=1e-9, atol=near * size, equal_nan=True))
