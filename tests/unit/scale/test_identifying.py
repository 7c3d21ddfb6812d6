"""Identification from large logs: what is found in memory, in one pass, and again after a stop."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import scale
from ulna.errors import InputError, NonFiniteError, ShapeError
from ulna.identification import identify

QUIET: Any = {"workers": 0, "progress": False}
ROWS = 300


@pytest.fixture(scope="module")
def ur5() -> ulna.Robot:
    return ulna.load("ur5")


@pytest.fixture(scope="module")
def log(ur5: ulna.Robot) -> dict[str, Any]:
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-1.0, 1.0, (3, ROWS, 6))
    tau = ur5.perturbed(0.2, seed=1).inverse_dynamics(q, v, a) + 0.3 * v + 0.5 * np.tanh(v / 1e-2)
    tau += rng.normal(size=tau.shape) * [0.5, 0.4, 0.3, 0.05, 0.05, 0.02]
    return {"q": q, "v": v, "a": a, "tau": tau}


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"damping": True, "friction": True, "noise": "auto"},
        {"armature": True, "noise": [0.5, 0.4, 0.3, 0.05, 0.05, 0.02], "ridge": 1e-3},
    ],
)
def test_blocks_find_what_is_found_in_memory(ur5: ulna.Robot, log: dict[str, Any], options: Any) -> None:
    whole = identify(ur5, **log, **options)
    found = scale.identify(ur5, log, chunk=128, **options, **QUIET)
    assert found.rows == ROWS and found.base.independent == whole.base.independent
    np.testing.assert_allclose(found.base.matrix, whole.base.matrix, atol=1e-9)
    for name in (
        "parameters",
        "damping",
        "armature",
        "friction",
        "base_values",
        "base_deviations",
        "rms",
        "rms_before",
        "explained",
    ):
        expected = getattr(whole, name)
        np.testing.assert_allclose(
            getattr(found, name), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max(), err_msg=name
        )
    assert found.condition == pytest.approx(whole.condition, rel=1e-9)
    assert f"{ROWS} samples" in found.report() and "explained" in found.report()
    assert found.report().split("\n")[1] == whole.report().split("\n")[1], "how well the log determines it"


def test_a_log_that_does_not_determine_the_parameters_is_warned_of(ur5: ulna.Robot) -> None:
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-0.01, 0.01, (3, 400, 6))
    log = {"q": q, "v": v, "a": a, "tau": 1e6 * rng.normal(size=(400, 6))}
    assert "WARNING: the log hardly determines" in scale.identify(ur5, log, **QUIET).report()


def test_physical_bodies_are_found_too(ur5: ulna.Robot, log: dict[str, Any]) -> None:
    whole = identify(ur5, **log, physical=True, damping=True, friction=True)
    found = scale.identify(ur5, log, chunk=128, physical=True, damping=True, friction=True, **QUIET)
    np.testing.assert_allclose(found.rms, whole.rms, rtol=1e-6)
    assert found.new_model.mass > 0.0 and found.physical


def test_logs_on_disk_are_read_once_and_continued(
    client: Any, ur5: ulna.Robot, log: Any, tmp_path: Path
) -> None:
    zarr = pytest.importorskip("zarr")
    folder, group = tmp_path / "log", zarr.open_group(tmp_path / "log.zarr", mode="w")
    folder.mkdir()
    np.savez(tmp_path / "log.npz", **log)
    for name, array in log.items():
        np.save(folder / f"{name}.npy", array)
        group.create_array(name, data=array, chunks=(256, 6))
    expected = scale.identify(ur5, log, chunk=60, **QUIET)

    def stop(progress: scale.Progress) -> None:
        if progress.done == 2:
            raise KeyboardInterrupt

    to = tmp_path / "sums.zarr"
    with pytest.raises(KeyboardInterrupt):
        scale.identify(ur5, folder, chunk=60, to=to, workers=0, progress=stop)
    found = scale.identify(ur5, tmp_path / "log.zarr", chunk=60, to=to, scheduler=client, progress=False)
    np.testing.assert_allclose(found.parameters, expected.parameters, rtol=1e-9, atol=1e-12)
    memory = scale.identify(ur5, tmp_path / "log.npz", chunk=60, scheduler=client, progress=False)
    np.testing.assert_allclose(memory.parameters, expected.parameters, rtol=1e-9, atol=1e-12)
    again = scale.identify(ur5, folder, chunk=60, to=to, noise="auto", **QUIET)  # no further pass
    assert again.rows == ROWS and (again.parameters != found.parameters).any()


def test_logs_that_do_not_fit(ur5: ulna.Robot, log: dict[str, Any], tmp_path: Path) -> None:
    for other, error, text in (
        ({"q": log["q"]}, InputError, "no v, a, tau"),
        ({**log, "v": log["v"][:5]}, ShapeError, r"`v`.*\(5, 6\)"),
        ({name: array[:0] for name, array in log.items()}, InputError, "no samples"),
        ({**log, "a": np.full((ROWS, 6), np.nan)}, NonFiniteError, r"`a\[0, 0\]` is nan"),
        (tmp_path / "none", InputError, "There is no log in"),
        (3, InputError, "`log` is a int"),
    ):
        with pytest.raises(error, match=text):
            scale.identify(ur5, other, **QUIET)  # type: ignore[arg-type]
    bad = {name: array.copy() for name, array in log.items()}
    bad["tau"][200, 4] = np.inf
    with pytest.raises(NonFiniteError, match=r"`tau\[200, 4\]` is inf"):
        scale.identify(ur5, bad, chunk=128, **QUIET)
