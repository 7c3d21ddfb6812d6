"""`viz.display(q)` through the face, beside Pinocchio's own MeshCat and Viser visualizers, taking turns.

python benchmarks/compat_pinocchio_display.py        # needs pin, example-robot-data, meshcat and viser

No browser looks: it is what a control loop pays. All have their page's server running.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

from _pair import answer_rounds, environments, in_turns
from _timing import shown, table

ROBOTS = {"UR5": "ur5", "Talos": "talos"}
VISUALIZERS = ("MeshcatVisualizer", "ViserVisualizer")
ROUNDS, CALLS = 9, 40


def prepared(file: str, visualizer: str) -> Callable[[], dict[str, float]]:
    """One visualizer of whatever `pinocchio` is, ready to be measured."""
    import numpy as np
    import pinocchio as pin
    from pinocchio import visualize

    made = pin.RobotWrapper.BuildFromURDF(file, [file.split("/example-robot-data/", maxsplit=1)[0]])
    viz = getattr(visualize, visualizer)(made.model, made.collision_model, made.visual_model)
    viz.initViewer(open=False)
    viz.loadViewerModel()
    rows = [made.q0]
    for _ in range(CALLS):
        rows.append(pin.integrate(made.model, rows[-1], np.full(made.model.nv, 0.01)))

    def measure() -> dict[str, float]:
        start = time.perf_counter()
        for q in rows:
            viz.display(q)
        return {"display": (time.perf_counter() - start) / len(rows)}

    measure()
    return measure


def main() -> None:
    from ulna.robots.example_robot_data import files

    faced, plain = environments("pinocchio")
    rows = []
    for title, robot in ROBOTS.items():
        for visualizer in VISUALIZERS:
            answers = in_turns(
                [__file__, str(files(robot)[0]), visualizer], {"face": faced, "pin": plain}, ROUNDS
            )
            own, real = (answers[who]["display"] for who in ("face", "pin"))
            rows.append([title, visualizer, shown(own), shown(real), f"{real / own:.0f}"])
    print(table("display(q)", ["robot", "visualizer", "face", "pin", "pin / face"], rows))


if __name__ == "__main__":
    if len(sys.argv) == 3:
        answer_rounds(lambda: prepared(*sys.argv[1:]))
    else:
        main()
