"""Which optional package a test lacked."""

from __future__ import annotations

from importlib.machinery import PathFinder


def missing_package(error: BaseException | None) -> str:
    """The optional package that is not installed and whose absence raised an error; empty where it was something else."""
    while error is not None:
        name = getattr(error, "package", "") or getattr(error, "name", "")
        if isinstance(error, ImportError) and isinstance(name, str) and name:
            module = name.partition(".")[0].replace("-", "_")
            if module != "ulna" and PathFinder.find_spec(module) is None:
                return module
        error = error.__cause__ or error.__context__
    return ""
