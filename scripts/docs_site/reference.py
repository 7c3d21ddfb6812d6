"""Writes a page of the reference for each public module: Sphinx fills them from the docstrings."""

from __future__ import annotations

import ast
import importlib
import inspect
import sys
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import ulna
from docs_site.docstrings import inline
from docs_site.names import groups

MODULES = {
    "ulna": "What is imported first: loading, compiling, poses, the viewer",
    "ulna.model": "Models: joints, links, frames, inertias, the builder",
    "ulna.spatial": "Rotations, poses, twists, wrenches, inertias",
    "ulna.geometry": "Shapes",
    "ulna.ik": "Tasks and limits of differential inverse kinematics",
    "ulna.collision": "Worlds, collision checks, distances",
    "ulna.planning": "Motion planning",
    "ulna.trajectory": "Trajectories",
    "ulna.control": "Control laws",
    "ulna.sim": "Simulation",
    "ulna.identification": "Identification of dynamic parameters",
    "ulna.exporting": "Export to other languages and processors",
    "ulna.interop": "Kernels inside of PyTorch and JAX",
    "ulna.diagnosis": "What looks wrong with a description",
    "ulna.viewer": "The viewer, pictures and films",
    "ulna.formats.dh": "Denavit-Hartenberg tables",
    "ulna.formats.ets": "Chains of elementary transforms",
    "ulna.algorithms": "The algorithms, as functions of a model",
    "ulna.compiler": "The compiler",
    "ulna.numeric": "Functions for code that is traced",
    "ulna.kernels": "Kernels of quantities",
    "ulna.errors": "Errors and warnings",
    "ulna.typing": "Names of types",
}
"""The public modules and what each holds."""

INTERNAL = {"ulna.compat", "ulna.faces"}
"""Packages that `ulna.NAME` imports and that have no page: the compatibility packages have pages about them."""

MODULES |= {
    name: (importlib.import_module(name).__doc__ or name).splitlines()[0].rstrip(".")
    for name in (f"ulna.{package}" for package in ulna._PACKAGES)
    if name not in MODULES and name not in INTERNAL
}

NUMPY = {"ArrayLike": "Whatever NumPy makes an array of: `numpy.typing.ArrayLike`."}
"""Names of NumPy that are public here, too."""

LARGE = ("Robot",)
"""Names of `ulna` with a page for each."""

_PYTHONS = "tuple, dict, Exception, BaseException, ImportError, OSError, AttributeError, NameError"
"""Python's own classes, whose members are not listed again."""
_MEMBERS = f"   :members:\n   :inherited-members: {_PYTHONS}\n"


def public_names(module: str) -> list[str]:
    """The public names of a module: its `__all__`, or what is defined in it and below it.

    Args:
        module: The module's name.

    Returns:
        The names, sorted; modules and the version are left out.
    """
    home = importlib.import_module(module)
    names = getattr(home, "__all__", None)
    if names is None:
        names = [
            name
            for name, value in vars(home).items()
            if not name.startswith("_") and getattr(value, "__module__", "").startswith(module)
        ]
    return sorted(
        name for name in names if not name.startswith("__") and not inspect.ismodule(getattr(home, name))
    )


def write(folder: Path) -> None:
    """Write the pages.

    Args:
        folder: Where they go.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for module, about in MODULES.items():
        (folder / f"{module}.rst").write_text(_module_page(module, about), encoding="utf-8")
    (folder / "robot.rst").write_text(_robot_page(), encoding="utf-8")
    for name, kind in groups().items():
        (folder / f"robot.{name}.rst").write_text(_group_page(name, kind), encoding="utf-8")
    (folder / "index.rst").write_text(_index(), encoding="utf-8")


def _title(text: str, mark: str = "=") -> str:
    return f"{text}\n{mark * len(text)}\n\n"


def _home(name: str, value: Any) -> str:
    """The first public module that has this very object under this name: it is described there and nowhere else."""
    for module in MODULES:
        if getattr(importlib.import_module(module), name, None) is value and name in public_names(module):
            return module
    raise LookupError(name)


def _module_page(module: str, about: str) -> str:
    values = {name: getattr(importlib.import_module(module), name) for name in public_names(module)}
    homes = {name: _home(name, value) for name, value in values.items()}
    rows = [
        f"   * - :py:obj:`{name} <{homes[name]}.{name}>`\n     - {_summary(homes[name], name, value)}\n"
        for name, value in values.items()
    ]
    text = _title(module) + f"{about}.\n\n.. py:module:: {module}\n\n"
    text += ".. list-table::\n   :widths: 30 70\n\n" + "".join(rows) + "\n"
    for name, value in values.items():
        if homes[name] == module and not (module == "ulna" and name in LARGE):
            text += _title(name, "-") + _directive(module, name, value)
    return text


def _is_data(value: Any) -> bool:
    return not callable(value) or not getattr(value, "__module__", "").startswith("ulna")


def _directive(module: str, name: str, value: Any) -> str:
    if _is_data(value):
        return f".. py:data:: {module}.{name}\n\n   {_summary(module, name, value)}\n\n"
    if inspect.isclass(value):
        return f".. autoclass:: {module}.{name}\n{_MEMBERS}\n"
    return f".. autofunction:: {module}.{name}\n\n"


def _summary(module: str, name: str, value: Any) -> str:
    """The first sentence of the docstring of a name, in one line, as reStructuredText."""
    text = _data_docstring(module, name) if _is_data(value) else inspect.getdoc(value)
    return inline(" ".join((text or "See the guides.").split("\n\n")[0].split()))


def _data_docstring(module: str, name: str) -> str:
    """The string that stands below a value in the source of its module, or of one that the module imports it from."""
    if name in NUMPY:
        return NUMPY[name]
    for other in [module, *(n for n in sorted(sys.modules) if n.startswith("ulna."))]:
        file = getattr(sys.modules[other], "__file__", None)
        if file and hasattr(sys.modules[other], name):
            body = ast.parse(Path(file).read_text(encoding="utf-8")).body
            for statement, below in pairwise(body):
                targets = getattr(statement, "targets", [getattr(statement, "target", None)])
                if any(isinstance(t, ast.Name) and t.id == name for t in targets) and isinstance(
                    below, ast.Expr
                ):
                    return str(ast.literal_eval(below.value))
    return ""


def _robot_page() -> str:
    rows = "".join(
        f"* :doc:`robot.{name} <robot.{name}>`: {inline((inspect.getdoc(kind) or '').splitlines()[0])}\n"
        for name, kind in groups().items()
    )
    text = (
        _title("ulna.Robot")
        + "What is used daily is a method of the robot; the rest is in groups:\n\n"
        + rows
    )
    text += "\nAll methods in tables, with shapes and units: :doc:`/quantities`.\n\n"
    return text + f".. autoclass:: ulna.Robot\n{_MEMBERS}\n"


def _group_page(name: str, kind: type) -> str:
    """The page of a group; robots make it, so that its constructor has no arguments here."""
    return _title(f"robot.{name}") + f".. autoclass:: {kind.__module__}.{kind.__qualname__}()\n{_MEMBERS}\n"


def _index() -> str:
    robot = {"robot": "A robot: what is used daily"}
    robot |= {
        f"robot.{name}": (inspect.getdoc(kind) or "").splitlines()[0] for name, kind in groups().items()
    }
    return (
        _title("API")
        + "Every public name, from the docstrings. ``help(name)`` in Python shows the same text.\n\n"
        + _contents("Modules", MODULES)
        + _contents("A robot and its groups", robot)
    )


def _contents(title: str, pages: Mapping[str, str]) -> str:
    """A table of pages, by name, with what each is about."""
    rows = "".join(
        f"   * - :doc:`{'ulna.Robot' if name == 'robot' else name} <{name}>`\n     - {inline(about)}\n"
        for name, about in pages.items()
    )
    table = f".. list-table::\n   :widths: 30 70\n\n{rows}\n"
    listed = "".join(f"   {name}\n" for name in pages)
    return _title(title, "-") + table + f".. toctree::\n   :hidden:\n\n{listed}\n"
