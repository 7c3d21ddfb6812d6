"""Which optional package a test lacked, itself or in a process that it started."""

from __future__ import annotations

import re
from importlib.machinery import PathFinder
from importlib.metadata import PackageNotFoundError

_IN_ANOTHER_PROCESS = re.compile(
    r"^\s*(?:E\s+)?(?:(?:ModuleNotFoundError|ImportError): No module named|[\w.]*MissingExtra: .* needs the package) '([\w-]+)",
    re.MULTILINE,
)


def missing_package(error: BaseException | None) -> str:
    """The optional package that is not installed and whose absence raised an error; empty where it was something else."""
    while error is not None:
        name = getattr(error, "package", "") or getattr(error, "name", "")
        if isinstance(error, PackageNotFoundError):
            return error.name
        if isinstance(error, ImportError) and isinstance(name, str) and _is_missing(name):
            return _module(name)
        if isinstance(error, AssertionError):  # its text may be what another process printed
            for name in _IN_ANOTHER_PROCESS.findall(str(error)):
                if _is_missing(name):
                    return _module(name)
        error = error.__cause__ or error.__context__
    return ""


def _module(name: str) -> str:
    return name.partition(".")[0].replace("-", "_")


def _is_missing(name: str) -> bool:
    return name != "" and _module(name) != "ulna" and PathFinder.find_spec(_module(name)) is None
