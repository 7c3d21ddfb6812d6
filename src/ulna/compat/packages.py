"""The folders of the compatibility packages, and how they get onto the path."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from ulna.errors import InputError, UnknownName

_FOLDER = Path(__file__).parent

FOLDERS: dict[str, Path] = {
    "roboticstoolbox": _FOLDER / "for-roboticstoolbox",
    "pinocchio": _FOLDER / "for-pinocchio",
}
"""Folders of compatibility packages, by the library they stand in for."""


def modules(library: str) -> tuple[str, ...]:
    """The names of the packages in the folder of a library."""
    folder = FOLDERS[library]
    packages = (p for p in folder.iterdir() if (p / "__init__.py").is_file()) if folder.is_dir() else ()
    return tuple(sorted(p.name for p in packages))


_LOADED: dict[str, ModuleType] = {}
"""Modules of compatibility packages that `compatibility_imports` loaded."""


@contextmanager
def compatibility_imports(folders: Iterable[Path], packages: Iterable[str]) -> Iterator[None]:
    """Within, `import` finds compatibility packages, even if the libraries are loaded; those come back after.

    Args:
        folders: Folders of compatibility packages.
        packages: Names of the packages in them.

    Returns:
        A context manager.
    """
    roots, names, path = tuple(map(str, folders)), frozenset(packages), list(sys.path)

    def removed() -> dict[str, ModuleType]:
        return {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] in names}

    def is_ours(module: ModuleType) -> bool:
        return str(getattr(module, "__file__", None) or "").startswith(roots)

    before = removed()
    if all(map(is_ours, before.values())):
        _LOADED.update(before)
    sys.modules.update({name: module for name, module in _LOADED.items() if is_ours(module)})
    sys.path[:0] = roots
    try:
        yield
    finally:
        sys.path[:] = path
        _LOADED.clear()
        _LOADED.update(removed())
        sys.modules.update(before)


def library_of(name: str) -> str:
    """The library whose folder holds a package: the name itself, or the library that the package comes with.

    Raises:
        UnknownName: There is no compatibility package of that name.
    """
    if name in FOLDERS:
        return name
    for library in FOLDERS:
        if name in modules(library):
            return library
    known = [*FOLDERS, *(module for library in FOLDERS for module in modules(library))]
    raise UnknownName("compatibility package", name, known)


def environment(libraries: Iterable[str], base: Mapping[str, str] | None = None) -> dict[str, str]:
    """The variables of a process whose Python imports compatibility packages in place of the libraries.

    Args:
        libraries: Names of `FOLDERS`.
        base: The variables to start from; those of this process when not given.

    Returns:
        All variables, with PYTHONPATH set.
    """
    variables = dict(os.environ if base is None else base)
    rest = [p for p in variables.get("PYTHONPATH", "").split(os.pathsep) if p]
    variables["PYTHONPATH"] = os.pathsep.join([*(str(FOLDERS[name]) for name in libraries), *rest])
    return variables


def use(*names: str) -> None:
    """Has this process import compatibility packages: in a notebook `use("pinocchio")`, then `import pinocchio`.

    Args:
        *names: Names of compatibility packages; each brings along the others of its library.

    Raises:
        UnknownName: There is no compatibility package of that name.
        InputError: The library itself is imported already; parts of both would mix.
    """
    chosen = [library_of(name) for name in names]
    for library in chosen:
        for module in modules(library):
            loaded = sys.modules.get(module)
            file = getattr(loaded, "__file__", None) if loaded is not None else None
            if loaded is not None and not str(file).startswith(str(FOLDERS[library])):
                raise InputError(
                    f"`{module}` is imported already, from {file}. Restart Python and call ulna.compat.use first."
                )
    for library in reversed(chosen):
        folder = str(FOLDERS[library])
        if folder not in sys.path:
            sys.path.insert(0, folder)
