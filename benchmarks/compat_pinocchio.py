"""Pinocchio's calls through the compatibility package, beside real Pinocchio: each in a separate Python process, in turns.

python benchmarks/compat_pinocchio.py [--groups NAME ...] [--robots NAME ...] [--rounds N] [--slower RATIO] [--markdown]

needs pin and example-robot-data. Solo12 stands on four points, Talos and G1 on two frames, along the world's axes.
--slower lists the calls alone whose time is more than that part of Pinocchio's.
"""

from __future__ import annotations

import argparse
import sys

from _pair import answer_rounds, environments, in_turns
from _pinocchio_rows import GROUPS, KINDS, prepared

ROBOTS = {
    "UR5": ("ur5", "fixed", ""),
    "Panda": ("panda", "fixed", ""),
    "Solo12": ("solo12", "floating", "CONTACT_3D,FL_KFE,FR_KFE,HL_KFE,HR_KFE"),
    "Talos": ("talos", "floating", "CONTACT_6D,leg_left_6_joint,leg_right_6_joint"),
    "G1": ("g1", "floating", "CONTACT_6D,left_ankle_roll_joint,right_ankle_roll_joint"),
    KINDS: (KINDS, "fixed", ""),
}
"""The name of a description, its root, and its contacts."""

Times = dict[str, tuple[float, float]]
"""For each call, the medians of the package and of Pinocchio [us]."""


def _robots_of(group: str) -> list[str]:
    """The robots that the calls of a group are timed on: small objects and solvers need none, contacts a robot that stands."""
    if group in ("objects", "assignments", "constructors", "operations", "solvers"):
        return ["UR5"]
    if group == "joints":
        return ["UR5", "Talos"]
    if group == "geometries":
        return ["UR5", "Panda", "Solo12"]
    if group == "constraints":
        return [name for name, (*_, feet) in ROBOTS.items() if feet]
    return [name for name in ROBOTS if group == "configurations" or name != KINDS]


def _times(group: str, robot: str, rounds: int) -> Times:
    from ulna.robots.example_robot_data import files

    key, *words = ROBOTS[robot]
    source = KINDS if key == KINDS else str(files(key)[0])
    packaged, plain = environments("pinocchio")
    workers = {"package": packaged, "pin": plain}
    found = in_turns([__file__, "worker", group, source, *words], workers, rounds)
    return {title: (found["package"][title], found["pin"][title]) for title in GROUPS[group]}


def _shown(group: str, columns: dict[str, Times], slower: float, markdown: bool) -> None:
    if markdown:
        print(f"\n| {group} | " + " | ".join(f"{robot} Ulna | pin" for robot in columns) + " |")
        print("|---" * (1 + 2 * len(columns)) + "|")
    else:
        print(f"\n{group + ', us a call':<42}" + "".join(f"{robot:>24}" for robot in columns))
        print(" " * 42 + f"{'Ulna     pin  ratio':>24}" * len(columns))
    for title in GROUPS[group]:
        pairs = [times[title] for times in columns.values()]
        if max(own / real for own, real in pairs) <= slower:
            continue
        if markdown:
            cells = [f"{x:.2g}" if x < 1e3 else f"{x:.0f}" for pair in pairs for x in pair]
            print(f"| {title} | {' | '.join(cells)} |")
        else:
            cells = [f"{own:8.3g}{real:8.3g}{own / real:6.2f}x" for own, real in pairs]
            print(f"{title:<42}" + "".join(f"{cell:>24}" for cell in cells), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--groups", nargs="+", default=list(GROUPS), choices=list(GROUPS))
    parser.add_argument("--robots", nargs="+", default=list(ROBOTS), choices=list(ROBOTS))
    parser.add_argument("--rounds", type=int, default=41)
    parser.add_argument("--slower", type=float, default=0.0)
    parser.add_argument("--markdown", action="store_true")
    words = parser.parse_args()
    for group in words.groups:
        robots = [robot for robot in _robots_of(group) if robot in words.robots]
        columns = {robot: _times(group, robot, words.rounds) for robot in robots}
        if columns:
            _shown(group, columns, words.slower, words.markdown)


if __name__ == "__main__":
    if sys.argv[1:2] == ["worker"]:
        answer_rounds(lambda: prepared(*sys.argv[2:]))
    else:
        main()
