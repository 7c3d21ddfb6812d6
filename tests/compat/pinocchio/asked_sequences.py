"""Random sequences of calls on one Data, and what every field holds after each: asked of both packages, by a test.

`python asked_sequences.py out.json first count`: the seeds from `first` on, each a robot, two states and five to ten calls.
"""

from __future__ import annotations

import json
import random
import sys
import warnings
from typing import Any

import numpy as np
import pinocchio as pin
from asked_fields import CALLS, FIELDS, REAL, Asked, field, state

warnings.simplefilter("ignore")
TREES = {
    "arm": "RZ0 RY1 RY2 RX3 RY4 RX5",
    "floating": "FreeFlyer0 RX1 RY2 PZ1 RX4",
    "mimic": "RZ0 RX1 RY2 PX2 RZ4",
    "balls": "Spherical0 RX1 Spherical2 Planar1 RUBZ4",
}
"""Kinds of joints, each with the joint before it."""


def robot(tree: str) -> Any:
    model, rng = pin.Model(), np.random.default_rng(len(tree))
    for text in TREES[tree].split():
        M = pin.exp6(0.7 * rng.standard_normal(6))
        joint = model.addJoint(
            int(text[-1]), getattr(pin, f"JointModel{text[:-1]}")(), M, f"j{model.njoints}"
        )
        heavy = pin.Inertia(1.0 + rng.random(), 0.2 * rng.random(3), np.diag(0.3 + 0.1 * rng.random(3)))
        model.appendBodyToJoint(joint, heavy, pin.SE3.Identity())
        model.addJointFrame(joint, -1)
    model.addFrame(pin.Frame("tool", model.njoints - 1, 0, M, pin.FrameType.OP_FRAME))
    if tree == "mimic":
        model = pin.transformJointIntoMimic(model, 2, 4, 0.5, 0.1)
    return model


class Sequence(Asked):
    """One robot with two states."""

    def __init__(self, tree: str, seed: int) -> None:
        self.model = m = robot(tree)
        rng = np.random.default_rng(seed)
        self.states = [state(m, rng), state(m, rng)]
        M = pin.exp6(np.array([0.1, 0.2, 0.3, 0.0, 0.0, 0.6]))
        kind, world = pin.ContactType.CONTACT_3D, pin.SE3.Identity()
        self.contact = pin.RigidConstraintModel(kind, m, m.njoints - 1, M, 0, world, pin.LOCAL)
        self.names = {"pin": pin, "m": m, "end": m.njoints - 1, "last": m.nframes - 1, "M": M}

    def steps(self, draws: random.Random) -> list[Any]:
        """For each call what the fields hold after it; of Pinocchio what they do after this call alone, too."""
        # Pinocchio has no constraints with mimic joints, and lcaba is off where velocities break the constraints
        bound = self.model.nv == self.model.nvExtended
        calls = [
            call for call in CALLS.strip().splitlines() if "lcaba" not in call and (bound or "cm" not in call)
        ]
        calls = draws.sample(calls, draws.randint(5, 10))
        data, contacts = self.prepared("cm" if bound else "", [])
        found: list[Any] = [["", 0, fields_of(data), None]]
        for call in calls:
            k = draws.randrange(2)
            failed = self.run(call, data, self.states[k], contacts)
            alone: Any = None
            if REAL and not failed:
                fresh, others = self.prepared(call, [])
                self.run(call, fresh, self.states[k], others)
                alone = fields_of(fresh)
            found.append([call, k, failed or fields_of(data), alone])
        return found


def fields_of(data: Any) -> dict[str, Any]:
    return {name: field(data, name) for name in FIELDS.split()}


def main(target: str, first: str, count: str) -> None:
    found = []
    for seed in range(int(first), int(first) + int(count)):
        tree = list(TREES)[seed % len(TREES)]
        asked = Sequence(tree, seed)
        truths = [asked.truths(given) for given in asked.states] if REAL else None
        found.append({"tree": tree, "steps": asked.steps(random.Random(seed)), "truths": truths})
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": found}))


if __name__ == "__main__":
    main(*sys.argv[1:])
