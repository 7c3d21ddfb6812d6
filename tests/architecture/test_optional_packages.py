"""Tests are collected on a Python that lacks any or all of the optional packages: they skip and do not fail."""

from __future__ import annotations

import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import ulna
from support.missing_packages import missing_package
from ulna.errors import MissingExtra

ROOT = Path(__file__).parents[2]
INSIDE_CMEEL = [
    "pinocchio",
    "coal",
    "example_robot_data",
]  # they lie in a folder that the metadata do not name
TOOLS = {"ulna", "pytest", "pytest-xdist", "pytest-rerunfailures", "hypothesis", "coverage"}
BLOCK = """
import os, sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in os.environ["ABSENT"].split():
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
"""


def optional_modules() -> list[str]:
    """The modules of the optional packages and of those that only tests need, as far as they are installed."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    extras = project["project"]["optional-dependencies"].values()
    wanted = [text for group in (*extras, project["dependency-groups"]["test"]) for text in group]
    packages = {_normal(re.split(r"[\\[<>=]", text)[0]) for text in wanted} - TOOLS
    modules = importlib.metadata.packages_distributions()
    return INSIDE_CMEEL + [name for name, owners in modules.items() if set(map(_normal, owners)) & packages]


def _path(folder: Path) -> str:
    """PYTHONPATH with a folder, and this very Ulna, whichever one is installed."""
    return os.pathsep.join([str(folder), str(Path(ulna.__file__).parents[1])])


def _normal(name: str) -> str:
    return name.lower().replace("_", "-")


@pytest.mark.slow
def test_without_the_optional_packages_every_test_file_is_collected(tmp_path: Path) -> None:
    absent = optional_modules()
    (tmp_path / "absent_packages.py").write_text(BLOCK)
    done = subprocess.run(
        [
            *(sys.executable, "-m", "pytest", "--collect-only", "-q"),
            *("-p", "absent_packages", "-p", "no:cacheprovider", "-p", "no:zarr"),  # zarr brings a plugin of pytest
        ],
        cwd=ROOT, env=os.environ | {"ABSENT": " ".join(absent), "PYTHONPATH": _path(tmp_path)},
        capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0, (
        "\n".join(re.findall(r"^(?:ERROR|E  ) .*", done.stdout, re.MULTILINE)) or done.stderr
    )


def test_a_test_that_lacks_a_package_is_distinguished_from_one_that_fails() -> None:
    assert missing_package(MissingExtra("no-such-package", "all", "This test")) == "no_such_package"
    assert missing_package(ModuleNotFoundError("No module", name="no_such_package.part")) == "no_such_package"
    assert missing_package(ModuleNotFoundError("No module", name="ulna.no_such_part")) == ""
    assert missing_package(MissingExtra("numpy", "all", "A test that hides it")) == ""
    assert missing_package(importlib.metadata.PackageNotFoundError("no-such-package")) == "no-such-package"
    lacking = MissingExtra("no-such-package", "all", "This test")
    printed = "Traceback (most recent call last):\n  ...\nModuleNotFoundError: No module named 'no_such_package.part'\n"
    assert missing_package(AssertionError(printed)) == "no_such_package"
    assert (
        missing_package(AssertionError(f"ulna.errors.{MissingExtra.__name__}: {lacking}"))
        == "no_such_package"
    )
    assert missing_package(AssertionError(printed.replace("no_such_package", "numpy"))) == ""
    assert (
        missing_package(AssertionError("expected ModuleNotFoundError: No module named 'no_such_package'"))
        == ""
    )
    assert missing_package(ImportError("cannot import name", name="numpy")) == ""
    assert missing_package(ValueError("something else")) == ""
    chained = AssertionError("another error")
    chained.__cause__ = MissingExtra("no-such-package", "all", "This test")
    assert missing_package(chained) == "no_such_package"


@pytest.mark.parametrize(("environment", "outcome"), [("", "1 skipped"), ("complete", "1 failed")])
def test_a_complete_environment_lacks_nothing(tmp_path: Path, environment: str, outcome: str) -> None:
    shutil.copy(ROOT / "tests" / "conftest.py", tmp_path)
    (tmp_path / "test_one.py").write_text("def test_it():\n    import no_such_package\n")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "-p", "no:xdist", "--rootdir", tmp_path, tmp_path],
        cwd=tmp_path, env=os.environ | {"ULNA_ENVIRONMENT": environment, "PYTHONPATH": _path(ROOT / "tests")},
        capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip
    assert outcome in done.stdout, done.stdout + done.stderr
    assert ("'no_such_package' is not installed" in done.stdout) == (environment == "")
