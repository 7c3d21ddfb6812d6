"""Data sets in Zarr groups: the rows that were asked for, whole, the same after a stop and on any cluster."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import scale
from ulna.errors import InputError, MissingExtra, UnknownName
from ulna.scale.cluster import connected

zarr = pytest.importorskip("zarr")

COLUMNS = ("q", "v", "fk", "jacobian", "inverse_dynamics", "a", "collides")


def _made(to: Path, **options: Any) -> Any:
    return scale.data_set(
        "panda", 2500, COLUMNS, to=to, chunk=1000, **{"workers": 0, "progress": False, **options}
    )


def test_rows_are_what_the_robot_says(tmp_path: Path) -> None:
    robot = ulna.load("panda")
    group = _made(tmp_path / "data.zarr")
    rows = {name: group[name][...] for name in COLUMNS}
    q, v, a = rows["q"], rows["v"], rows["a"]
    assert q.shape == (2500, 7) and robot.limits.contains(q).all() and len(np.unique(q[:, 0])) == 2500
    np.testing.assert_array_equal(rows["fk"], robot.fk(q))
    np.testing.assert_array_equal(rows["jacobian"], robot.jacobian(q))
    np.testing.assert_array_equal(rows["inverse_dynamics"], robot.inverse_dynamics(q, v, a))
    np.testing.assert_array_equal(rows["collides"], robot.collides(q, method="spheres"))
    assert (abs(v) <= robot.limits.velocity).all() and abs(a).max() <= 10.0
    assert group.attrs["complete"] is True and group["fk"].chunks == (1000, 4, 4)
    other = scale.data_set(
        robot, 2500, ["q"], to=tmp_path / "q.zarr", dtype="float32", chunk=1000, workers=0, progress=False
    )
    np.testing.assert_array_equal(other["q"][...], q.astype("float32"))


def _ignores_ctrl_c() -> bool:
    import signal

    return signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_a_stopped_data_set_continues_and_is_the_same(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    whole = _made(tmp_path / "whole.zarr")

    def stop(progress: scale.Progress) -> None:
        if progress.done == 1:
            raise KeyboardInterrupt

    to = tmp_path / "data.zarr"
    with pytest.raises(KeyboardInterrupt):
        _made(to, progress=stop)
    assert zarr.open_group(to, mode="r").attrs["complete"] is False
    with connected(None, 1, 60.0) as client:
        assert list(client.run(_ignores_ctrl_c).values()) == [True]
        again = _made(to, workers=None, scheduler=client)
    for name in COLUMNS:
        np.testing.assert_array_equal(again[name][...], whole[name][...])
    assert again.attrs["checksums"] == whole.attrs["checksums"]
    assert not (tmp_path / "data.zarr.job").exists()


def test_invalid_data_sets_are_refused(tmp_path: Path) -> None:
    to = tmp_path / "data.zarr"
    with pytest.raises(UnknownName, match="jacobian"):
        scale.data_set("panda", 10, ["jacobain"], to=to)
    with pytest.raises(InputError, match="'collides' is not among `columns`"):
        scale.data_set("panda", 10, ["q"], to=to, world=ulna.collision.World())
    with pytest.raises(InputError, match="returns 3 arrays"):
        scale.data_set("panda", 10, ["inverse_dynamics_derivatives"], to=to, workers=0, progress=False)
    assert not (tmp_path / "data.zarr.job").exists(), "other arguments can be given now"
    with pytest.raises(InputError, match="`to` is None; expected the folder"):
        scale.data_set("ur5", 10, ["q"], to=None, workers=0)
    with pytest.raises(InputError, match="`columns` is empty"):
        scale.data_set("panda", 10, [], to=to)
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="is no Zarr group"):
        scale.data_set("panda", 10, ["q"], to=mine, workers=0, progress=False)
    assert (mine / "notes.txt").read_text() == "mine"


def test_parquet_files_hold_the_same_rows(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    whole, to = _made(tmp_path / "data.zarr"), tmp_path / "data.parquet"

    def stop(progress: scale.Progress) -> None:
        if progress.done == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _made(to, progress=stop)
    for found in (_made(to), _made(to)):  # continued, then there already
        table = found.to_table()
        assert table.column_names == list(COLUMNS) and len(table) == 2500
        for name in COLUMNS:
            column = table[name].combine_chunks()
            values = column if name == "collides" else column.flatten()
            rows = values.to_numpy(zero_copy_only=False).reshape(whole[name].shape)
            np.testing.assert_array_equal(rows, whole[name][...])
    with pytest.raises(InputError, match="its seed is 0, here it is 1"):
        _made(to, seed=1)
    assert sorted(path.name for path in to.iterdir())[1:] == [f"part-{k:06d}.parquet" for k in range(3)]


def test_parquet_needs_pyarrow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow.dataset", None)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(MissingExtra, match="pyarrow"):
        _made(tmp_path / "data.parquet")
    assert not (tmp_path / "data.parquet").exists()
