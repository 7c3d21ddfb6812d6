"""`ulna.export`: what it takes, what it refuses, and that it leaves nothing half-written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.cli import main
from ulna.errors import DtypeError, InputError, UnknownName
from ulna.exporting import TARGETS


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def test_a_folder_is_written_and_lists_its_files(panda: ulna.Robot, tmp_path: Path) -> None:
    place = ulna.export(panda, ["fk", "jacobian"], to="c", path=tmp_path / "out" / "panda")
    listed = json.loads((place / "ulna_export.json").read_text())
    assert listed["target"] == "c" and listed["kernels"] == ["fk", "jacobian"]
    assert sorted(listed["files"]) == sorted(p.name for p in place.iterdir())
    assert {"panda.h", "panda_fk.c", "panda_jacobian.c"} <= set(listed["files"])
    assert [p.name for p in place.parent.iterdir()] == ["panda"]


def test_an_earlier_export_is_replaced_as_a_whole(panda: ulna.Robot, tmp_path: Path) -> None:
    ulna.export(panda, "jacobian", to="c", path=tmp_path / "x")
    ulna.export(panda, "fk", to="c", path=tmp_path / "x")
    assert (tmp_path / "x" / "panda_fk.c").exists() and not (tmp_path / "x" / "panda_jacobian.c").exists()


def test_folders_with_other_files_are_left_alone(panda: ulna.Robot, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match=r"has 'notes.txt', which no export wrote"):
        ulna.export(panda, "fk", to="c", path=tmp_path)
    ulna.export(panda, "fk", to="c", path=tmp_path / "x")
    (tmp_path / "x" / "mine").mkdir()
    (tmp_path / "x" / "mine" / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match=r"has 'mine/notes.txt'"):
        ulna.export(panda, "fk", to="c", path=tmp_path / "x")
    with pytest.raises(InputError, match=r"is a file; expected a folder"):
        ulna.export(panda, "fk", to="c", path=tmp_path / "notes.txt")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["notes.txt", "x"]


def test_an_error_while_writing_leaves_the_former_folder(
    panda: ulna.Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ulna.export(panda, "fk", to="c", path=tmp_path / "x")
    before = {p.name: p.read_text() for p in (tmp_path / "x").iterdir()}
    from ulna.exporting.c import folder

    written = folder.write

    def fails(export: Any, place: Path) -> None:
        written(export, place)
        raise OSError("no space left")

    monkeypatch.setattr(folder, "write", fails)
    for name in ("x", "y"):
        with pytest.raises(OSError, match="no space left"):
            ulna.export(panda, "jacobian", to="c", path=tmp_path / name)
    assert [p.name for p in tmp_path.iterdir()] == ["x"]
    assert {p.name: p.read_text() for p in (tmp_path / "x").iterdir()} == before


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"kernels": ["fk", "jacobain"]}, UnknownName, r"No kernel named 'jacobain'. Did you mean 'jacobian'"),
        ({"to": "cc"}, UnknownName, r"No export target named 'cc'. Did you mean 'c'"),
        ({"to": None}, UnknownName, r"No export target named None"),
        ({"fame": "panda_hand"}, UnknownName, r"target 'c' or of its kernels named 'fame'. Did you mean 'frame'"),
        ({"frame": "panda_hnd"}, UnknownName, r"Did you mean 'panda_hand'"),
        ({"kernels": []}, InputError, r"`kernels` is empty; expected names such as"),
        ({"kernels": 3}, InputError, r"`kernels` is 3; expected"),
        ({"kernels": [np.sin]}, InputError, r"`kernels` has <ufunc 'sin'>; expected"),
        ({"kernels": ["fk", "fk"]}, InputError, r"Two kernels have the name 'fk'"),
        ({"kernels": {"2d": "fk"}}, InputError, r"name of a kernel is '2d'; expected a letter"),
        ({"kernels": [("fk", {"reference": "local"})]}, UnknownName, r"No option of kernel 'fk' named 'reference'"),
        ({"name": "my robot"}, InputError, r"`name` is 'my robot'; expected a letter"),
        ({"dtype": "int32"}, DtypeError, r"expected float64 or float32"),
        ({"path": ""}, InputError, r"`path` is empty"),
        ({"path": 3}, InputError, r"`path` is 3; expected the path of a folder"),
        ({"robot": "panda"}, InputError, r"`robot` is 'panda'; expected a Robot"),
        ({"robot": None}, InputError, r"'fk' is a quantity of a robot; expected a robot"),
    ],
)  # fmt: skip
def test_refusals_name_the_closest_and_write_nothing(
    panda: ulna.Robot, tmp_path: Path, change: dict[str, Any], error: type[Exception], message: str
) -> None:
    arguments: dict[str, Any] = {
        "robot": panda,
        "kernels": ["fk"],
        "to": "c",
        "path": tmp_path / "x",
        **change,
    }
    with pytest.raises(error, match=message):
        ulna.export(**arguments)
    assert list(tmp_path.iterdir()) == []


def test_own_functions_are_exported_without_a_robot(tmp_path: Path) -> None:
    half = ulna.compile(lambda x: np.sin(x) / 2, x=(3,), dtype=np.float32)
    place = ulna.export(None, {"half_sine": half}, to="c", path=tmp_path / "x", name="mine")
    assert "void mine_half_sine(const float x[3], float out[3]);" in (place / "mine.h").read_text()


def test_types_that_differ_must_be_chosen(tmp_path: Path) -> None:
    two = {n: ulna.compile(lambda x: x * 2, x=(), dtype=n) for n in ("float32", "float64")}
    with pytest.raises(DtypeError, match=r"expected one type for all functions"):
        ulna.export(None, two, to="c", path=tmp_path / "x")
    ulna.export(None, two, to="c", path=tmp_path / "x", dtype="float32")


def test_the_command_writes_the_same(panda: ulna.Robot, tmp_path: Path, capsys: Any) -> None:
    options = ["--frame", "panda_hand", "--option", "reference=local"]
    output = ["--output", str(tmp_path / "a")]
    assert main(["export", "panda", "--kernel", "fk,jacobian", "--to", "c", *output, *options]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "a")
    other = ulna.export(
        panda, ["fk", "jacobian"], to="c", path=tmp_path / "b", frame="panda_hand", reference="local"
    )
    for file in other.iterdir():
        assert (tmp_path / "a" / file.name).read_text() == file.read_text()


def test_options_of_the_command_are_lists_numbers_or_texts(tmp_path: Path) -> None:
    joints = "joints=panda_joint1,panda_joint2,panda_joint4"
    words = ["--kernel", "ik", "--option", joints, "--option", "mask=1,1,0,0,0,0", "--option", "test=false"]
    assert main(["export", "panda", *words, "--option", "seed=3", "--output", str(tmp_path / "x")]) == 0
    text = (tmp_path / "x" / "panda.h").read_text()
    assert "joints: panda_joint1, panda_joint2, panda_joint4." in text and not list(tmp_path.glob("x/test_*"))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--kernel", "fkk"], "No kernel named 'fkk'. Did you mean 'fk'"),
        (["--to", "wsam"], "No export target named 'wsam'"),
        (["--kernel", "ik", "--option", "joints=panda_joint"], "No joint named 'panda_joint'. Did you mean"),
        (["--option", "frame"], "--option 'frame' has no value; expected OPTION=VALUE"),
    ],
)
def test_the_command_says_what_is_wrong(words: list[str], message: str, tmp_path: Path, capsys: Any) -> None:
    assert main(["export", "panda", "--output", str(tmp_path / "x"), *words]) == 2
    assert message in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_every_target_has_a_module_that_writes() -> None:
    from importlib import import_module

    for name, target in TARGETS.items():
        assert target.name == name and target.text
        assert callable(import_module(target.module).write)
