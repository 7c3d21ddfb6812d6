"""After every call of random sequences on one Data all fields are Pinocchio's, or the truth of now, or say what to call."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from field_judge import FieldJudge

from support.two_pythons import both


@pytest.mark.parametrize(("first", "count"), [(0, 8), pytest.param(8, 300, marks=pytest.mark.slow)])
def test_random_sequences(first: int, count: int, tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    script, at_once = Path(__file__).with_name("asked_sequences.py"), 20
    faults: list[Any] = []
    compared = 0
    for begin in range(first, first + count, at_once):
        asked = min(at_once, first + count - begin)
        answers = zip(*both(script, tmp_path, str(begin), str(asked)), strict=True)
        for seed, (own, real) in enumerate(answers, begin):
            wrong, number = compared_steps(own, real)
            faults += [(seed, real["tree"], *each) for each in wrong]
            compared += number
    assert not faults
    assert compared > 150 * count


def compared_steps(own: Any, real: Any) -> tuple[list[tuple[str, str, dict[str, str]]], int]:
    """For each call that leaves something wrong the calls before, itself, and the fields; and how many were compared."""
    faults, before, compared = [], "", 0
    for k, (call, state, after, alone) in enumerate(real["steps"][1:], start=1):
        mine = own["steps"][k][2]
        if isinstance(after, str):  # Pinocchio does not take mimic joints there
            break
        held = real["steps"][k - 1][2]
        theirs = {f"{before} | {call}": [held, after], f"fresh | {call}": [{}, alone]}
        truths = real["truths"][1 - state], real["truths"][state]
        judge = FieldJudge(
            {f"{before} | {call}": mine if isinstance(mine, str) else [{}, mine]},
            theirs,
            truths,
            real["tree"] == "mimic",
        )
        found = judge.faults(f"{before} | {call}")
        kept = {
            name for name in found if held[name] == after[name] and own["steps"][k - 1][2][name] == mine[name]
        }
        if found.keys() - kept:
            faults.append((before, call, {name: found[name] for name in found.keys() - kept}))
        if isinstance(mine, str):
            break
        before, compared = f"{before}; {call}", compared + judge.compared
    return faults, compared
