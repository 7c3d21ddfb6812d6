"""Finds the file that a mesh or texture URI of a robot description means."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final
from urllib.parse import unquote

from lxml import etree  # pyright: ignore[reportAttributeAccessIssue]

from ulna.files import read_regular

_MAX_PACKAGE_XML = 1024 * 1024  # [bytes]
_PACKAGE = re.compile(r"(?:package|model):/+([^/]+)/*(.*)", re.DOTALL)
_FILE = re.compile(r"file:(?://localhost(?=/)|//)?(.+)", re.DOTALL)
_NETWORK = re.compile(r"(?:https?|ftp)://")


@dataclass(frozen=True)
class Resolution:
    """What a URI was resolved to.

    Attributes:
        uri: the URI as the description has it.
        path: the file, absolute; None when there is none.
        tried: the places looked in, in order.
    """

    uri: str
    path: str | None
    tried: tuple[str, ...]


@final
class Resolver:
    """Finds files by `package://`, `model://`, `file://` and relative or absolute paths.

    A package is looked for, in this order: in `package_dirs` and below them; among the folders above the
    description (by folder name, or by the name in a package.xml) and beside them; in ROS_PACKAGE_PATH; in
    share/ of AMENT_PREFIX_PATH. Where no folder of that name holds the file, the folders above the
    description are tried with the package name left out, so that a checkout under another name works. Nothing
    is fetched from the network.

    Args:
        file: the description whose URIs are resolved; None for one that came as text.
        package_dirs: folders that hold packages, or are packages.
        environ: the environment; the process's own when left out.
    """

    def __init__(
        self,
        file: str | os.PathLike[str] | None = None,
        package_dirs: Sequence[str | os.PathLike[str]] = (),
        environ: Mapping[str, str] | None = None,
    ) -> None:
        self._folder = Path(file).absolute().parent if file is not None else None
        self._dirs = tuple(Path(d).expanduser().absolute() for d in package_dirs)
        self._environ = os.environ if environ is None else environ
        self._names: dict[Path, str | None] = {}

    def resolve(self, uri: str) -> Resolution:
        """The file that `uri` means, and where it was looked for."""
        tried: list[str] = []
        for candidate in self._candidates(uri.strip()):
            path = os.path.normpath(candidate)
            if path in tried:
                continue
            tried.append(path)
            if os.path.isfile(path):
                return Resolution(uri, path, tuple(tried))
        return Resolution(uri, None, tuple(tried))

    def find_package(self, name: str) -> str | None:
        """The folder of the package of that name, or None."""
        for folder in self._packages(name):
            if os.path.isdir(folder):
                return str(folder)
        return None

    def _candidates(self, uri: str) -> Iterator[str]:
        if not uri or _NETWORK.match(uri):
            return
        package = _PACKAGE.match(uri)
        if package:
            name, rest = package.groups()
            for spelling in _spellings(rest):
                for folder in self._packages(name):
                    yield os.path.join(folder, spelling)
                for folder in (*self._dirs, *self._above()):
                    yield os.path.join(folder, spelling)
            return
        file = _FILE.match(uri)
        for spelling in _spellings(file.group(1) if file else uri):
            if os.path.isabs(spelling):
                yield spelling
                continue
            drive = re.match(r"/?([A-Za-z]:[/\\].*)", spelling)
            if drive and os.name == "nt":
                yield drive.group(1)
            for folder in (
                *((self._folder,) if self._folder else (Path.cwd(),)),
                *self._dirs,
                *self._above(),
            ):
                yield os.path.join(folder, spelling)

    def _packages(self, name: str) -> Iterator[Path]:
        for folder in (*self._dirs, *self._above()):
            if name in (folder.name, self._package_name(folder)):
                yield folder
            yield folder / name
        for entry in self._path("ROS_PACKAGE_PATH"):
            if entry.name == name:
                yield entry
            yield entry / name
        for entry in self._path("AMENT_PREFIX_PATH"):
            yield entry / "share" / name

    def _above(self) -> tuple[Path, ...]:
        if self._folder is None:
            return ()
        folders = (self._folder, *self._folder.parents)
        # The root of the file system is nobody's package; looking there only clutters the report.
        return folders[:-1] if len(folders) > 1 else folders

    def _path(self, variable: str) -> Iterator[Path]:
        for entry in self._environ.get(variable, "").split(os.pathsep):
            if entry:
                yield Path(entry).expanduser()

    def _package_name(self, folder: Path) -> str | None:
        """The name that a package.xml in the folder gives."""
        if folder not in self._names:
            self._names[folder] = _read_package_name(folder / "package.xml")
        return self._names[folder]


def _read_package_name(file: Path) -> str | None:
    if not os.path.isfile(file):
        return None
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        root = etree.fromstring(read_regular(file, _MAX_PACKAGE_XML), parser)
        return (root.findtext("name") or "").strip() or None
    except (etree.LxmlError, OSError, ValueError):
        return None


def _spellings(path: str) -> tuple[str, ...]:
    """The path as written, with its percent escapes undone, and with the slashes of another system turned."""
    forms = [path, unquote(path), unquote(path).replace("\\", "/")]
    return tuple(dict.fromkeys(forms))
