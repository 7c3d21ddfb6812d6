"""Whether a field of a Data is Pinocchio's, or the truth of now, or says what to call."""

from __future__ import annotations

from typing import Any

import numpy as np

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


class FieldJudge:
    """Compares what both packages leave in the fields of a Data.

    Args:
        own, real: For "calls before | call", the fields before and after it; of Pinocchio for "fresh | call", too.
        truths: What fields may be at both states.
        mimic: Whether the robot has mimic joints.
    """

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
