"""No field of a Data is ever silently what it was before: each is Pinocchio's, or the truth of now, or says what to call."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.two_pythons import both
from ulna.robots.example_robot_data import share_folder

ROBOTS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "", ""),
    "solo12": ("solo_description/robots/solo12.urdf", "FreeFlyer", ""),
    "panda": ("panda_description/urdf/panda.urdf", "", ""),
    "panda, fingers coupled": ("panda_description/urdf/panda.urdf", "", "mimic"),
}
UNIVERSE = dict.fromkeys(("v", "a", "a_gf", "ov", "oa", "oa_gf", "f", "h", "of", "oh"), 6)
UNIVERSE |= dict.fromkeys(("com", "vcom", "acom"), 3)
"""How many numbers of a field are of the universe; Pinocchio adds to some of them at every call."""
TRUER = {
    "a f of": "aba",  # there of an intermediate step
    "com vcom mass": "",  # of subtrees: there weighted sums, or in other frames, or left as they were
    "dHdq dFdq dFdv dFda": "CentroidalDynamicsDerivatives",  # there about the world's origin
    "v": "getCentroidalDynamicsDerivatives",  # there scratch
    "dAg": "computeCentroidalMapTimeVariation",  # there of the centre's velocity of an earlier call
    "M": "Dynamic",  # there the upper triangle alone
    "oa_gf": "constraintDynamics",  # there the universe does not feel gravity
    "liMi oMi": "Jacobian(",  # there along one branch alone
    "J": "jacobianSubtreeCenterOfMass",  # the same
}
"""Where the truth is not what Pinocchio leaves: fields, and what the calls have in their names."""
ELSEWHERE = {
    "oa lambda_c": "lcaba",  # there with gravity; none
    "impulse_c": "onstraint Delassus lcaba",  # there, without an impact, whatever the memory held
    "joints": "Jacobian(",  # there along one branch alone
    "J dJ C oMf": "mimic",  # there columns of mimic joints are apart
}
"""What is not compared."""
SPOILT = "Ag Jcom dFda dFdq dFdv dtau_dq dtau_dv dlambda_dtau g oa of tau"
"""Where Pinocchio leaves intermediate steps."""


@pytest.mark.parametrize(
    ("robot", "used"),
    [
        ("ur5", "everything"),
        pytest.param(
            "solo12", "everything", marks=pytest.mark.slow
        ),  # on a free flyer; another arm would show the same
        pytest.param("panda, fingers coupled", "nothing", marks=pytest.mark.slow),
        pytest.param("ur5", "each", marks=pytest.mark.slow),
    ],
)
def test_no_field_is_silently_what_it_was(robot: str, used: str, tmp_path: Path) -> None:
    file, root, mimic = ROBOTS[robot]
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    own, real = both(
        Path(__file__).parent / "asked_fields.py", tmp_path, str(share / "robots" / file), root, mimic, used
    )
    judge = _Judge(own["after"], real["after"], real["truths"], bool(mimic))
    faults = {asked: found for asked in real["after"] if (found := judge.faults(asked))}
    assert not faults
    assert judge.compared > 2000


class _Judge:
    def __init__(self, own: Any, real: Any, truths: Any, mimic: bool) -> None:
        self.own, self.real, self.mimic, self.compared = own, real, mimic, 0
        self.then, self.now = truths

    def faults(self, asked: str) -> dict[str, str]:
        """What is wrong after calls, by fields."""
        before, call = asked.split(" | ")
        real, own = self.real[asked], self.own[asked]
        if isinstance(real, str):  # not with mimic joints
            return {}
        if isinstance(own, str):
            return {"the call": own}
        words = [before, call, *(["mimic"] if self.mimic else [])]
        fields = [name for name in real[1] if not _listed(ELSEWHERE, name, words)]
        said = {name: self._said(name, before, call) for name in fields}
        return {name: word for name, word in said.items() if word}

    def _said(self, name: str, before: str, call: str) -> str:
        (held, after), own = self.real[f"{before} | {call}"], self.own[f"{before} | {call}"][1][name]
        self.compared += 1
        if isinstance(own, str):
            fine = own.startswith("InputError") and "Call " in own and name in SPOILT.split()
            return "" if fine else own
        skip = 0 if before == "fresh" else UNIVERSE.get(name, 0)
        tolerance = 1e-6 if "cm_data" in before + call + before.replace("everything", "cm_data") else 1e-9

        def is_one_of(*values: Any) -> bool:
            return any(_near(own[skip:], value[skip:], tolerance) for value in values)

        if is_one_of(after[name]):
            return ""
        if _near(held[name][skip:], after[name][skip:], 1e-9):
            return "" if is_one_of(*self.then[name], *self.now[name]) else "neither kept nor right"
        if is_one_of(self.real[f"fresh | {call}"][1][name]):  # there the Data's past counts
            return ""
        if _listed(TRUER, name, [call]) and is_one_of(*self.now[name]):
            return ""
        return "what it was before" if is_one_of(held[name], *self.then[name]) else "wrong"


def _listed(table: dict[str, str], name: str, words: list[str]) -> bool:
    return any(
        name in fields.split() and any(part in word for part in parts.split(" ") for word in words)
        for fields, parts in table.items()
    )


def _near(own: Any, wanted: Any, tolerance: float) -> bool:
    a, b = np.asarray(own, dtype=float), np.asarray(wanted, dtype=float)
    return a.shape == b.shape and bool(
        np.abs(a - b).max(initial=0.0) <= tolerance * max(1.0, np.abs(b).max(initial=0.0))
    )
