"""Compatibility packages in a test process that may have imported the libraries of the same names."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from ulna.compat.packages import FOLDERS, modules


@contextmanager
def using(library: str) -> Iterator[None]:
    """Within, `import` finds the compatibility packages of a library; modules of the library itself come back after."""
    replaced = set(modules(library))

    def removed() -> dict[str, object]:
        return {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] in replaced}

    originals, folder = removed(), str(FOLDERS[library])
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)
        removed()
        sys.modules.update(originals)  # type: ignore[arg-type]
