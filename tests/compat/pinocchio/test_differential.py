"""Calls generated of Pinocchio's overloads have the same outcome here: values, types, shapes, texts, classes of errors."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from differential import MODES, compare, documented, generated


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


@pytest.mark.slow
@pytest.mark.parametrize(("mode", "every", "equal"), [("operators", 9, 0.98), ("containers", 3, 0.8)])
def test_operators_and_lists(tmp_path: Path, mode: str, every: int, equal: float) -> None:
    """All but few outcomes are equal, and nearly all others have a reason; lists have more functions than there."""
    pytest.importorskip("pinocchio")
    make, reasons = MODES[mode]
    found = compare(list(make(tmp_path))[1::every])
    assert len(found) > 4000
    wrong = [(text, what) for _, text, what, *_ in found if what and not documented(what, text, reasons)]
    print(*wrong, sep="\n")
    assert sum(not what for _, _, what, *_ in found) >= equal * len(found)
    assert len(wrong) <= 0.002 * len(found)
