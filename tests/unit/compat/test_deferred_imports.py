"""Stand-ins for packages that a library needs only now and then."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ulna.compat.deferred_imports import deferred_imports

LIBRARY = """
from __future__ import annotations
from typing import Tuple, Union
import heavy_one
import heavy_one as one
import heavy_two.part as part
from heavy_one import Thing, make
Known = Union[Thing, Tuple[Thing, ...]]

def is_thing(x):
    return isinstance(x, (int, Thing)), isinstance(x, heavy_one.Thing)

def used():
    return make(3).number, one.make(4).number, Thing(5).number, Thing.of(6).number, part.VALUES[0], part.f()

def derived():
    class More(Thing):
        pass
    return More
"""
ONE = """
class Thing:
    def __init__(self, number):
        self.number = number
    @classmethod
    def of(cls, number):
        return cls(number)

def make(number):
    return Thing(number)
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    (tmp_path / "library.py").write_text(LIBRARY)
    (tmp_path / "heavy_one").mkdir()
    (tmp_path / "heavy_one" / "__init__.py").write_text(ONE)
    (tmp_path / "heavy_one" / "below.py").write_text("from heavy_one import Thing\nX = Thing(1)\n")
    (tmp_path / "heavy_two").mkdir()
    (tmp_path / "heavy_two" / "__init__.py").write_text("")
    (tmp_path / "heavy_two" / "other.py").write_text("")
    (tmp_path / "heavy_two" / "part.py").write_text("VALUES = (7,)\ndef f():\n    return 8\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    before = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - before:
        del sys.modules[name]


HEAVY = {"heavy_one": ("Thing", "make"), "heavy_two": (), "heavy_two.part": ("f",), "not_installed": ("x",)}


def imported() -> Any:
    with deferred_imports(HEAVY):
        return importlib.import_module("library")


def test_packages_are_imported_when_they_are_used(folder: Path) -> None:
    library = imported()
    assert not set(HEAVY) & set(sys.modules)
    assert library.is_thing(1.0) == (False, False) and library.is_thing(1) == (True, False)
    assert "heavy_one" not in sys.modules
    assert library.used() == (3, 4, 5, 6, 7, 8)
    real = importlib.import_module("heavy_one")
    assert library.is_thing(real.Thing(1)) == (True, True) and library.is_thing("no") == (False, False)
    assert issubclass(library.derived(), real.Thing)
    assert "heavy_one.Thing, imported when used" in repr(library.Thing)
    with pytest.raises(AttributeError, match="heavy_one"):
        library.one.no_such_thing


def test_who_imports_a_package_afterwards_gets_it_itself(folder: Path) -> None:
    imported()
    real = importlib.import_module("heavy_one")
    assert type(real).__name__ == "module" and isinstance(real.Thing, type)
    assert importlib.import_module("heavy_two.part").VALUES == (7,)


def test_what_is_imported_already_stays(folder: Path) -> None:
    real = importlib.import_module("heavy_one")
    library = imported()
    assert library.Thing is real.Thing and sys.modules["heavy_one"] is real


def test_unlisted_imports_are_resolved_to_the_package(folder: Path) -> None:
    (folder / "library.py").write_text("from heavy_two.part import VALUES\nimport heavy_one\n")
    library = imported()
    assert library.VALUES == (7,) and "heavy_two.part" in sys.modules and "heavy_one" not in sys.modules


def test_a_part_of_a_package_brings_the_whole(folder: Path) -> None:
    (folder / "library.py").write_text("import heavy_one.below\nx = heavy_one.below.X.number\n")
    assert imported().x == 1
    real = importlib.import_module("heavy_one")
    assert isinstance(real.Thing, type) and real.below.X.number == 1

    (folder / "library.py").write_text("import heavy_two.part as part\nimport heavy_two.other\n")
    del sys.modules["library"]
    assert imported().part.f() == 8
    assert importlib.import_module("heavy_two").part.VALUES == (7,)


def test_what_is_used_while_the_library_is_imported_is_imported(folder: Path) -> None:
    """As matplotlib.markers makes a Path when pyplot is imported: the placeholder called itself without end."""
    (folder / "library.py").write_text(
        "from heavy_one import Thing, make\nx, y = Thing.of(1), make(2).number\n"
    )
    library, real = imported(), importlib.import_module("heavy_one")
    assert type(library.x) is real.Thing and (library.x.number, library.y) == (1, 2)
    assert library.Thing(3).number == 3 and isinstance(library.x, real.Thing)


def test_placeholders_are_removed_when_an_import_fails(folder: Path) -> None:
    (folder / "library.py").write_text("import heavy_one\n1 / 0\n")
    finders = list(sys.meta_path)
    with pytest.raises(ZeroDivisionError):
        imported()
    assert "heavy_one" not in sys.modules and sys.meta_path == finders
