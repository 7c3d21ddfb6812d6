"""`ulna run` starts programs as `python` does: scripts, modules, code and the standard input, whatever their arguments."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ulna.compat.run import run, split
from ulna.errors import InputError

_TELL = """
import sys, __main__
spec = __main__.__spec__
print(__name__, sys.argv, repr(sys.path[0]), spec and spec.name, __main__.__dict__.get("__package__"))
"""
_ENV = {**os.environ, "ULNA_CACHE": "0"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "script.py").write_text(_TELL + "print(__file__)\n")
    (tmp_path / "fails.py").write_text("def f():\n    raise ValueError('seven')\nf()\n")
    (tmp_path / "ends.py").write_text("import sys\nprint(sys.stdin.read())\nsys.exit(7)\n")
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "__init__.py").write_text("")
    (tmp_path / "package" / "__main__.py").write_text(_TELL + "print(__file__)\n")
    (tmp_path / "package" / "part.py").write_text(_TELL + "from . import __name__ as n\nprint(n)\n")
    return tmp_path


def _result(command: list[str], folder: Path, given: str) -> tuple[int, str, str]:
    done = subprocess.run(
        command, cwd=folder, input=given, capture_output=True, text=True, timeout=600, env=_ENV, check=False
    )
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ["script.py", "--only", "x", "-m", "-h", "--", "a b"],
        ["-m", "package", "-c", "--help"],
        ["-m", "package.part", "1"],
        ["-mpackage", "1"],
        ["-c", _TELL, "-m", "x", "--only"],
        ["-c", "import sys; sys.exit('text')"],
        ["-", "a", "-b"],
        ["ends.py"],
        ["fails.py"],
        ["-m", "fails"],
        ["-m", "nothing_of_that_name"],
        ["-u", "-W", "ignore", "script.py", "-u"],
        ["package", "1"],
        ["-c", "import os, signal; os.kill(os.getpid(), signal.SIGTERM)"],
    ],
)
def test_programs_run_as_under_python(folder: Path, words: list[str]):
    given = _TELL if words[0] == "-" else "given"
    wanted = _result([sys.executable, *words], folder, given)
    assert _result([sys.executable, "-m", "ulna", "run", *words], folder, given) == wanted


@pytest.mark.parametrize("own", [[], ["--only", "pinocchio"], ["--only=pinocchio", "--"]])
@pytest.mark.parametrize("words", [["-m", "uses", "1"], ["-c", "import uses", "1"], ["uses.py", "1"]])
def test_the_program_finds_the_faces(tmp_path: Path, own: list[str], words: list[str]):
    (tmp_path / "uses.py").write_text(
        "import sys, importlib.util as u\n"
        "f = lambda n: 'for-' in str(u.find_spec(n) and u.find_spec(n).origin)\n"
        "print(sys.argv[1:], f('pinocchio'), f('roboticstoolbox'))\n"
    )
    code, out, err = _result([sys.executable, "-m", "ulna", "run", *own, *words], tmp_path, "")
    assert code == 0, err
    assert out == f"['1'] True {not own}\n"


@pytest.mark.parametrize(
    ("given", "own", "program"),
    [
        ([], [], []),
        (["-m", "a", "--only", "x"], [], ["-m", "a", "--only", "x"]),
        (["--only", "x", "--on=y", "s.py", "-h"], ["--only", "x", "--on=y"], ["s.py", "-h"]),
        (["-h", "s.py"], ["-h"], ["s.py"]),
        (["--only"], ["--only"], []),
        (["--", "-m", "a"], [], ["-m", "a"]),
    ],
)
def test_own_options_end_where_the_program_begins(given: list[str], own: list[str], program: list[str]):
    assert split(given) == (own, program)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "needs a program"),
        (["-u"], "needs a program"),
        (["none.py", "-m"], "no file 'none.py'"),
        (["-W", "ignore", "none.py"], "no file 'none.py'"),
        (["-I", "script.py"], "-I makes Python ignore PYTHONPATH"),
        (["-uEm", "package"], "-E makes Python ignore PYTHONPATH"),
    ],
)
def test_what_cannot_run_is_refused(folder: Path, monkeypatch, words: list[str], said: str):
    monkeypatch.chdir(folder)
    with pytest.raises(InputError, match=said):
        run(words)
