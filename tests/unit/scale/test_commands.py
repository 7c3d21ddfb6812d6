"""Jobs on the command line: what they write, and one line for what cannot be."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna.cli import main

pytest.importorskip("zarr")
WHERE = ("--workers", "0")


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _refused(capsys: pytest.CaptureFixture[str], words: str, message: str) -> None:
    capsys.readouterr()
    assert main(words.split()) == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert last.startswith("ulna: ") and re.search(message, last), last


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("reach panda --picture a.png --chunk inf --workers 0", "`chunk` is inf; expected a whole number"),
        ("reach panda --picture a.png --chunk nan --workers 0", "`chunk` is nan; expected a whole number"),
        ("reach panda --picture a.txt --workers 0", "No kind of picture named '.txt'"),
        ("reach panda --page a.png --workers 0", "No kind of page named '.png'"),
        ("dataset panda q --to d.zarr --dtype blah --workers 0", "`dtype` has dtype blah; expected float64"),
        (
            "dataset ur5 q --to d.csv",
            r"no \.csv file is written; expected .* 'result.zarr' or 'result.parquet'",
        ),
        (
            "reach ur5 --to r.npz",
            r"`to` is 'r.npz', but no \.npz file is written; .* such as 'result.zarr'\.",
        ),
        ("plans panda --problems 1 --to p.json", r"no \.json file is written"),
        ("sweep ur5 gravity_forces --vary mass=0.1 --to s.h5", r"no \.h5 file is written"),
        ("sweep panda gravity_forces --vary mass=1 --vary mass=2", "`--vary mass=` is given more than once"),
        ("identify panda log.npy", "There is no log in .*log.npy'; expected a Zarr group, .* an NPZ file"),
        ("identify panda .", "holds neither q.npy, .* nor a Zarr group"),
    ],
)
def test_wrong_words_are_refused_before_any_work(
    words: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    _refused(capsys, words, message)


def test_files_that_are_no_archives_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    Path("text.npz").write_text("hello")
    Path("empty.npz").touch()
    np.save("one.npy", np.zeros(3))
    np.savez("objects.npz", starts=np.array([{}], dtype=object), goals=np.zeros(7))
    np.savez("half.npz", q=np.zeros((3, 7)))
    for name in ("text.npz", "empty.npz", "one.npy", "objects.npz"):
        _refused(
            capsys, f"plans panda --from {name}", f"'{name}' is no NPZ file with the arrays starts, goals"
        )
    _refused(capsys, "identify panda text.npz", "is no NPZ file with the arrays q, v, a, tau")
    _refused(capsys, "identify panda half.npz", r"has no v, a, tau; it holds \['q'\]")


@pytest.mark.parametrize("address", ["nonsense", "foo://host:1", "tcp://host", "tcp://no host:1"])
def test_an_address_that_is_none_is_refused_at_once(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed = pytest.importorskip("distributed")
    from ulna import scale
    from ulna.errors import InputError

    monkeypatch.setattr(distributed.Client, "_start", None)  # none is to be started
    with pytest.raises(InputError, match=f"No scheduler answers at '{address}'"):
        scale.reach("ur5", 1000, voxel=0.2, scheduler=address, to=tmp_path / "r.zarr", progress=False)


def test_parquet_files_are_written_and_said(capsys: pytest.CaptureFixture[str]) -> None:
    pyarrow = pytest.importorskip("pyarrow.parquet")
    assert (
        main(
            [
                *["dataset", "panda", "q", "fk", "--to", "d.parquet", "--samples", "1e3", "--chunk", "400"],
                *WHERE,
            ]
        )
        == 0
    )
    assert capsys.readouterr().out.splitlines() == [
        "q: fixed_size_list<element: double>[7]",
        "fk: fixed_size_list<element: double>[16]",
        "1000 rows",
    ]
    table = pyarrow.read_table("d.parquet")
    q, T = (table[name].combine_chunks().flatten().to_numpy() for name in ("q", "fk"))
    np.testing.assert_array_equal(T.reshape(-1, 4, 4), ulna.load("panda").fk(q.reshape(-1, 7)))


def test_parameters_of_a_log_are_written_where_there_is_no_folder_yet(
    capsys: pytest.CaptureFixture[str],
) -> None:
    robot = ulna.load("ur5")
    q, v, a = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 100, 6))
    np.savez("log.npz", q=q, v=v, a=a, tau=robot.inverse_dynamics(q, v, a))
    assert main([*["identify", "ur5", "log.npz", "--parameters", "found/p.npy"], *WHERE]) == 0
    assert "Identification of 'ur5'" in capsys.readouterr().out
    assert np.load("found/p.npy").shape == (60,)
