"""Faces imported in a test process that may hold the packages they stand for: these are put aside meanwhile."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from ulna.compat.packages import FOLDERS, modules


@contextmanager
def worn(shelf: str) -> Iterator[None]:
    """Within, `import` finds the faces of a shelf."""
    faced = set(modules(shelf))

    def put_aside() -> dict[str, object]:
        return {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] in faced}

    packages, folder = put_aside(), str(FOLDERS[shelf])
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)
        put_aside()
        sys.modules.update(packages)  # type: ignore[arg-type]
