"""Recordings in .csv files: what was saved is loaded, and other tables are refused with what they lack."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import pytest

from ulna.errors import InputError, ShapeError
from ulna.sim import Recording


def test_what_was_saved_is_loaded_with_every_digit(tmp_path: Path) -> None:
    rng, run = np.random.default_rng(0), Recording()
    for k in range(100):
        run.add(
            k / 3, rng.normal(size=2), tau=rng.normal(size=2), T=rng.normal(size=(4, 4)), speed=k, joint_2=1.0
        )
    run.save(tmp_path / "log.csv")
    loaded = Recording.load(tmp_path / "log.csv")
    assert loaded.names == run.names and len(loaded) == 100
    for name in run.names:
        np.testing.assert_array_equal(loaded[name], run[name])
    loaded.add(50.0, np.ones(2))
    assert loaded.q[-1].tolist() == [1.0, 1.0] and np.isnan(loaded["tau"][-1]).all()


def test_tables_of_other_programs_are_read(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(
        "\ufefft, tau_0, q_1, q_0\r\n0,1,2,3\r\n0.5,4,5,6\r\n", encoding="utf-8"
    )
    log = Recording.load(tmp_path / "log.csv")
    np.testing.assert_array_equal(log.q, [[3, 2], [6, 5]])
    np.testing.assert_array_equal(log["tau"], [[1], [4]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,q_0\n0,1\n", "expected 't' and 'q_0', 'q_1'"),
        ("t,q_0,q_2\n0,1,2\n", "expected 't' and 'q_0', 'q_1'"),
        ("t,q_0\n0,1\n1\n", "row 3, has 1 entries; expected 2"),
        ("t,q_0\n0,one\n", "no number"),
        ("t,q_0,q_0\n0,1,2\n", "two columns 'q_0'"),
        ("", "expected 't'"),
        ("t,q_0\n0,1\n1,1\n0.5,1\n", "row 4, has the time 0.5 s after 1 s"),
        ("t,q_0\n0,1\nnan,1\n", "row 3, has the time nan s"),
    ],
)
def test_other_tables_are_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "log.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        Recording.load(tmp_path / "log.csv")


def test_paths_are_checked(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing to save"):
        Recording().save(tmp_path / "log.csv")
    with pytest.raises(InputError, match=r"ends in \.csv"):
        Recording.load(tmp_path / "log.txt")
    with pytest.raises(InputError, match="There is no file"):
        Recording.load(tmp_path / "log.csv")


def test_a_row_that_is_refused_changes_nothing(tmp_path: Path) -> None:
    run = Recording()
    with pytest.raises(InputError, match="`tau` is 'x'"):
        run.add(0.0, [1.0, 2.0], tau="x")
    assert run.names == () and len(run) == 0
    with pytest.raises(InputError, match="nothing to save"):
        run.save(tmp_path / "log.csv")
    run.add(1.0, [1.0, 2.0, 3.0])
    with pytest.raises(InputError, match=r"`t` is 0.5 s, and the last row is of 1 s"):
        run.add(0.5, [1.0, 2.0, 3.0])
    with pytest.raises(ShapeError, match="as in the rows before"):
        run.add(2.0, [1.0], tau=[1.0])
    assert run.names == ("t", "q") and len(run) == 1


def test_rows_are_added_to_a_file_without_rows(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t,q_0,q_1\n")
    run = Recording.load(tmp_path / "log.csv")
    run.add(0.0, [1.0, 2.0])
    assert run.q.tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize("number", ["1000000000000", "9" * 5000, "40000_40000_40000"])
def test_a_column_with_a_huge_number_in_its_name_is_an_ordinary_one(tmp_path: Path, number: str) -> None:
    (tmp_path / "log.csv").write_text(f"t,q_0,q_1,x_{number}\n0,1,2,3\n")
    run = Recording.load(tmp_path / "log.csv")
    assert run.names == ("t", "q", f"x_{number}") and run.q.tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize(
    ("columns", "head"),
    [
        ({"tau": (2,), "tau_1": ()}, "tau_0,tau_1,tau_1[]"),
        ({"force_0": (), "force_1": ()}, "force_0[],force_1[]"),
        ({"force_0": (2,), "force_1": (2,)}, "force_0[0],force_0[1],force_1[0],force_1[1]"),
        ({"d_0": (1, 2)}, '"d_0[0,0]","d_0[0,1]"'),
        ({"q_5": (), "x_0": (), "y[0]": (), "y[7]": ()}, "q_5[],x_0[],y[0],y[7]"),
        ({"y[0]": ()}, "y[0][]"),
        ({"t ": (), "": (2,), "x[]": (2,)}, "t [],[0],[1],x[]_0,x[]_1"),
        ({"f_0": (2,), "f_1": (3,)}, "f_0_0,f_0_1,f_1_0,f_1_1,f_1_2"),
    ],
)
def test_columns_whose_titles_would_be_those_of_others_come_back(
    tmp_path: Path, columns: dict[str, tuple[int, ...]], head: str
) -> None:
    """Numbers "force_0" and "force_1" came back as one array "force"; "tau_1" beside "tau" was refused."""
    rng, run = np.random.default_rng(6000), Recording()
    for k in range(3):
        run.add(k, rng.normal(size=2), **{name: rng.normal(size=shape) for name, shape in columns.items()})
    run.save(tmp_path / "log.csv")
    assert (tmp_path / "log.csv").read_text().splitlines()[0] == "t,q_0,q_1," + head
    again = Recording.load(tmp_path / "log.csv")
    assert again.names == run.names
    for name in run.names:
        np.testing.assert_array_equal(again[name], run[name])


def test_brackets_of_other_programs_are_read(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t,q[0],q[1],x[2],u [m]\n0,1,2,3,4\n")
    run = Recording.load(tmp_path / "log.csv")
    assert run.names == ("t", "q", "x[2]", "u [m]") and run.q.tolist() == [[1.0, 2.0]]
    (tmp_path / "log.csv").write_text("t,q_0,x,x[]\n0,1,2,3\n")
    with pytest.raises(InputError, match="two columns 'x'"):
        Recording.load(tmp_path / "log.csv")


@pytest.mark.parametrize("time", ["nan", "inf"])
def test_times_of_a_file_are_finite(tmp_path: Path, time: str) -> None:
    (tmp_path / "log.csv").write_text(f"t,q_0\n0,1\n{time},1\n")
    with pytest.raises(InputError, match=rf"row 3, has the time {time} s; expected finite ones"):
        Recording.load(tmp_path / "log.csv")


def test_rows_are_added_to_a_copy_alone() -> None:
    run = Recording()
    run.add(0.0, [1.0])
    other = copy.copy(run)
    other.add(1.0, [2.0])
    run.add(0.5, [3.0])
    assert run.q.tolist() == [[1.0], [3.0]] and other.q.tolist() == [[1.0], [2.0]]


def test_names_that_end_in_numbers_come_back(tmp_path: Path) -> None:
    """Arrays "force_1" and "force_2" came back as columns of single numbers, and "x_01" as "x_1"."""
    recording = Recording()
    for k in range(3):
        arrays = {"force_1": [1.0, k], "force_2": [2.0, k], "d_7": np.full((2, 2), k)}
        recording.add(k, [1.0, 2.0], **arrays, x_01=3.0, x_1=4.0 + k, single_3=k, plain=np.ones((2, 3)))
    recording.save(tmp_path / "a.csv")
    again = Recording.load(tmp_path / "a.csv")
    assert set(again.names) == set(recording.names)
    for name in recording.names:
        np.testing.assert_array_equal(again[name], recording[name])


def test_titles_with_many_numbers_are_ordinary_ones(tmp_path: Path) -> None:
    title = "x" + "_1" * 3000
    (tmp_path / "a.csv").write_text(f"t,q_0,{title}\n0,1,2\n")
    assert Recording.load(tmp_path / "a.csv")[title][0] == 2.0


def test_arrays_without_entries_come_back(tmp_path: Path) -> None:
    """Those of robots without joints could not be saved: NumPy cannot reshape them."""
    recording = Recording()
    for k in range(3):
        recording.add(
            k, np.zeros(0), tau=np.zeros((2, 0, 3)), force=[1.0, k], **{"x[:0]": k, "y[:0]": [k, 1.0]}
        )
    recording.save(tmp_path / "a.csv")
    again = Recording.load(tmp_path / "a.csv")
    assert set(again.names) == set(recording.names)
    for name in recording.names:
        np.testing.assert_array_equal(again[name], recording[name])
        assert again[name].shape == recording[name].shape
    (tmp_path / "b.csv").write_text("t,q[:0],q[:0]\n0,0,0\n", encoding="utf-8")
    with pytest.raises(InputError, match="two columns 'q'"):
        Recording.load(tmp_path / "b.csv")
