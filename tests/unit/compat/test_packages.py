"""Compatibility packages get onto the path of a script and of a notebook; the doctor reads what a script uses."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

import ulna
from ulna.cli import main
from ulna.compat import doctor, packages
from ulna.errors import FormatError, InputError, UnknownName


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with one compatibility package, which offers one name and says of another what to use."""
    package = tmp_path / "for-mini" / "minipeer"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text(
        "class Arm:\n    length = 3\n\n"
        "def __getattr__(name):\n    raise AttributeError(f'minipeer.{name} is not offered; use ulna.load.')\n"
    )
    monkeypatch.setattr(packages, "FOLDERS", {"minipeer": package.parent})
    monkeypatch.setattr(doctor, "FOLDERS", {"minipeer": package.parent})
    monkeypatch.setattr(sys, "path", list(sys.path))
    yield package.parent
    sys.modules.pop("minipeer", None)


def _python(words, **options):
    return subprocess.run([sys.executable, *words], check=False, capture_output=True, text=True, **options)


def test_a_script_runs_with_compatibility_packages_in_a_new_process(folder, tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import sys, minipeer\nprint(__name__, sys.argv[1:], minipeer.Arm.length)\nsys.exit(3)\n"
    )
    variables = packages.environment(["minipeer"], {"PYTHONPATH": "elsewhere"})
    assert variables["PYTHONPATH"].endswith("elsewhere")
    done = _python([script, "a", "b"], env=variables)
    assert done.returncode == 3 and done.stdout.split() == ["__main__", "['a',", "'b']", "3"]


def test_the_command_runs_a_script(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import os, sys\nprint(os.environ['PYTHONPATH'], sys.argv[1])\nsys.exit(5)\n")
    done = _python(["-m", "ulna", "run", script, "--flag"])
    assert done.returncode == 5 and "for-pinocchio" in done.stdout and "--flag" in done.stdout
    only = _python(["-m", "ulna", "run", "--only", "pinocchio", script, "--flag"])
    assert "for-roboticstoolbox" not in only.stdout and "for-pinocchio" in only.stdout


def test_a_script_that_is_not_there_is_named(capsys):
    assert main(["run", "nowhere.py"]) == 2
    assert "nowhere.py" in capsys.readouterr().err
    assert main(["run"]) == 2
    assert "needs a program" in capsys.readouterr().err


def test_a_notebook_uses_a_compatibility_package(folder):
    packages.use("minipeer")
    import minipeer  # pyright: ignore[reportMissingImports]

    assert minipeer.Arm.length == 3
    packages.use("minipeer")
    assert sys.path.count(str(folder)) == 1


def test_a_compatibility_package_does_not_mix_with_the_library(folder, monkeypatch):
    other = type(sys)("minipeer")
    other.__file__ = "elsewhere/minipeer/__init__.py"
    monkeypatch.setitem(sys.modules, "minipeer", other)
    with pytest.raises(InputError, match="imported already"):
        packages.use("minipeer")


def test_an_unknown_package_is_named(folder):
    with pytest.raises(UnknownName, match="minipeer"):
        packages.use("minipear")


def test_the_doctor_lists_what_is_missing(folder, tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import minipeer as mp\nfrom minipeer import Arm, Leg\nimport numpy\n"
        "arm = mp.Arm\nprint(mp.Arm.length, mp.wheel.spin(), Arm.width, numpy.pi)\n"
    )
    found = {f.name: f for f in doctor.examine(script)}
    assert {n for n, f in found.items() if f.offered} == {"minipeer", "minipeer.Arm", "minipeer.Arm.length"}
    assert found["minipeer.Leg"].line == 2 and "use ulna.load" in found["minipeer.Leg"].hint
    assert not found["minipeer.wheel.spin"].offered and not found["minipeer.Arm.width"].offered
    assert "line 2: minipeer.Leg is not offered" in doctor.report(script, list(found.values()))
    assert main(["doctor", str(script)]) == 1


def test_the_doctor_refuses_what_is_no_script(folder, tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        doctor.examine(tmp_path / "none.py")
    broken = tmp_path / "broken.py"
    broken.write_text("import (\n")
    with pytest.raises(FormatError, match=r"broken\.py:1"):
        doctor.examine(broken)


def test_the_former_name_still_works():
    import ulna.faces
    import ulna.faces.shelves

    assert ulna.faces.wear is packages.use and ulna.faces.shelves.SHELVES is packages.FOLDERS
    assert ulna.compat.use is packages.use


def test_benchmarks_measure_this_ulna_beside_the_library(monkeypatch):
    """Workers of the library had lost PYTHONPATH: another copy of Ulna was measured, where one is installed."""
    source, benchmarks = Path(ulna.__file__).parents[1], Path(__file__).parents[3] / "benchmarks"
    folders = {name: str(folder) for name, folder in packages.FOLDERS.items()}
    path = [folders["pinocchio"], str(source), "", f"{folders['roboticstoolbox']}{os.sep}"]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path))
    monkeypatch.syspath_prepend(str(benchmarks))
    faced, plain = importlib.import_module("_pair").environments("roboticstoolbox")
    assert plain["PYTHONPATH"] == str(source)
    assert faced["PYTHONPATH"] == os.pathsep.join([folders["roboticstoolbox"], str(source)])
    assert {**faced, "PYTHONPATH": ""} == {**plain, "PYTHONPATH": ""}
    for variables in (faced, plain):
        found = _python(["-c", "import ulna; print(ulna.__file__)"], env=variables, cwd=source.parent)
        assert Path(found.stdout.strip()).samefile(ulna.__file__), found.stderr
