"""Calls generated of Pinocchio's overloads have the same outcome here: values, types, shapes, texts, classes of errors."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from differential import compare, documented, generated


def _share(folder: Path, every: int, offset: int) -> float:
    """The share of calls with equal outcomes, or that differ as documented."""
    pytest.importorskip("pinocchio")
    pairs = generated(folder)
    assert len(pairs) > 5000
    found = compare(pairs[offset::every])
    wrong = [
        (text, what, own, theirs)
        for _, text, what, own, theirs in found
        if what and not documented(what, text)
    ]
    for each in wrong:
        print(*each)
    return 1.0 - len(wrong) / len(found)


def test_a_sample_of_generated_calls(tmp_path: Path) -> None:
    assert _share(tmp_path, 300, 7) >= 0.9


@pytest.mark.slow
def test_many_generated_calls(tmp_path: Path) -> None:
    assert _share(tmp_path, 12, 3) >= 0.95
