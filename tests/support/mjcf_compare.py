"""In what Ulna's results for an MJCF file differ from MuJoCo's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from support.mjcf_physics import BALL, FREE, compiled, coupled_state, loaded, of_mujoco, of_ulna, same
from ulna.model import Model
from ulna.typing import Floats


def differences(source: str | Path, seed: int = 0) -> list[str]:
    """In what Ulna's results for a file differ from MuJoCo's."""
    m = compiled(source)
    model, _ = loaded(source)
    q, v, qpos, G = coupled_state(model, m, np.random.default_rng(seed))
    theirs, ours = of_mujoco(m, qpos, G @ v), of_ulna(model, m, q, v, G)
    bias = G.T @ (theirs["bias"] + theirs["mass"] @ ours.pop("convective"))
    joints = [j for j, joint in enumerate(model.joints) if joint.mimic is None]
    expected = {
        **theirs,
        "mass": G.T @ theirs["mass"] @ G,
        "bias": bias,
        "gravity": G.T @ theirs["gravity"],
        "passive": G.T @ theirs["passive"],
        "friction": np.abs(G.T) @ theirs["friction"] if joints != [*range(m.njnt)] else theirs["friction"],
        "contacts": {pair for pair in theirs["contacts"] if not _joined_to_world(m, pair)},
        "configurations": {name: _converted(m, k) for name, k in theirs["configurations"].items()},
        **_within_followers(model, theirs["lower"], theirs["upper"]),
    }
    followed = np.array(expected.pop("equalities"))
    wrong = [
        name for name, value in expected.items() if name != "configurations" and not same(value, ours[name])
    ]
    for name, value in expected["configurations"].items():
        taken = ours["configurations"].get(name)
        if taken is None or (taken.shape == value.shape and not same(value, taken)):
            wrong.append(f"configuration {name}")
    if np.abs(followed).max(initial=0.0) > 1e-9:
        wrong.append("equalities")
    return wrong


def _within_followers(model: Model, lower: Floats, upper: Floats) -> dict[str, Floats]:
    """Limits of joints, where leaders stay in the ranges of their followers unless that leaves no position."""
    least, greatest = lower.copy(), upper.copy()
    for j, joint in enumerate(model.joints):
        if joint.mimic is not None:
            k, ratio, offset = joint.mimic.source, joint.mimic.multiplier, joint.mimic.offset
            ends = sorted(((lower[j] - offset) / ratio, (upper[j] - offset) / ratio))
            least[k], greatest[k] = max(least[k], ends[0]), min(greatest[k], ends[1])
    kept = least <= greatest
    return {"lower": np.where(kept, least, lower), "upper": np.where(kept, greatest, upper)}


def _joined_to_world(m: Any, pair: frozenset[str]) -> bool:
    """Whether a pair is of what stands still and a body that one joint, not a free one, joins to it.

    Ulna takes such links as neighbours, MuJoCo looks at them.
    """
    welded = {int(m.body_weldid[m.body(name).id]) for name in pair}
    if 0 not in welded or len(welded) == 1:
        return False
    body = max(welded)
    hangs = m.body_weldid[m.body_parentid[body]] == 0 and m.body_jntnum[body] == 1
    return bool(hangs and m.jnt_type[m.body_jntadr[body]] != FREE)


def _converted(m: Any, qpos: Floats) -> Floats:
    out = np.array(qpos)
    for j in range(m.njnt):
        if m.jnt_type[j] in (FREE, BALL):
            at = int(m.jnt_qposadr[j]) + 3 * int(m.jnt_type[j] == FREE)
            out[at : at + 4] = np.roll(out[at : at + 4], -1)
    return out
