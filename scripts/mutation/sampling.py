"""Random samples of the mutants of many files."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path

from mutation.mutant import Mutant
from mutation.mutants import mutants


def sample(root: Path, files: list[Path], count: int, seed: int) -> list[Mutant]:
    """`count` mutants of `files`: lines are drawn uniformly among all that have mutants, then one mutant of the line.

    The first mutants of a longer sample are those of a shorter one with the same seed, also after other lines changed.
    """
    lines: dict[tuple[str, int], list[Mutant]] = {}
    for file in sorted(files):
        path = file.relative_to(root).as_posix()
        for mutant in mutants(file.read_bytes(), path):
            lines.setdefault((path, mutant.line), []).append(mutant)
    chosen = [min(candidates, key=lambda mutant: _lot(seed, mutant.key)) for candidates in lines.values()]
    return sorted(chosen, key=lambda mutant: _lot(seed, f"{mutant.path} {mutant.place}"))[:count]


def _lot(seed: int, text: str) -> bytes:
    """A random number for a text: a change elsewhere in the sources leaves it, and so the sample, as it is."""
    return hashlib.sha256(f"{seed} {text}".encode()).digest()


def all_files(source: Path) -> Iterator[Path]:
    """The Python files of a source tree."""
    return (path for path in sorted(source.rglob("*.py")) if "__pycache__" not in path.parts)
