"""The scripts that set up the project's environment: what they ask of pip, first, again and after an interruption."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BASH = shutil.which("bash")

PYTHON = """#!/bin/sh
echo "$@" >>calls
case "$*" in
  *"-m venv"*) mkdir -p .venv/bin && cp "$0" .venv/bin/python && touch .venv/pip ;;
  *"pip --version"*) [ -e .venv/pip ] ;;
esac
"""

pytestmark = pytest.mark.skipif(BASH is None or os.name == "nt", reason="the scripts are for bash")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A folder with the script, a project file and a Python that only notes what is asked of it."""
    (tmp_path / "scripts").mkdir()
    shutil.copy(ROOT / "scripts" / "environment", tmp_path / "scripts")
    (tmp_path / "pyproject.toml").write_text("")
    stub = tmp_path / "stub"
    stub.write_text(PYTHON)
    stub.chmod(0o755)
    return tmp_path


def calls(project: Path, extras: str, groups: str = "", complete: str = "") -> list[str]:
    """What one run of `environment` asks of Python."""
    (project / "calls").unlink(missing_ok=True)
    subprocess.run(
        [str(BASH), "-euo", "pipefail", "-c", '. scripts/environment; environment "$0" "$1"', extras, groups],
        cwd=project,
        env={**os.environ, "ULNA_PYTHON": str(project / "stub"), "ULNA_ENVIRONMENT": complete},
        check=True,
    )
    file = project / "calls"
    return file.read_text().splitlines() if file.exists() else []


def test_without_groups_no_group_is_asked_for(project: Path) -> None:
    """`scripts/demo` needs no dependency group."""
    made, *_, installed, compiled = calls(project, "viewer,mesh")
    assert made.endswith("venv --clear .venv")
    assert installed.endswith("-e .[viewer,mesh]")
    assert "-m compileall" in compiled


def test_every_group_is_asked_for(project: Path) -> None:
    assert calls(project, "all", "test lint")[-2].endswith("-e .[all] --group test --group lint")


def test_nothing_is_asked_for_where_everything_is_installed(project: Path) -> None:
    assert calls(project, "all", "test", complete="complete") == []


def test_the_second_run_does_nothing(project: Path) -> None:
    calls(project, "all", "test")
    assert calls(project, "all", "test") == []


def test_other_extras_are_added_to_the_same_environment(project: Path) -> None:
    calls(project, "all", "test")
    assert not any("venv --clear" in call for call in calls(project, "all"))


def test_an_environment_left_without_pip_is_made_again(project: Path) -> None:
    """As it is when the machine had no `ensurepip` at first, or when someone pressed ctrl-C."""
    calls(project, "all")
    (project / ".venv" / "pip").unlink()
    for stamp in (project / ".venv").glob("installed-*"):
        stamp.unlink()
    assert any("venv --clear" in call for call in calls(project, "all"))
