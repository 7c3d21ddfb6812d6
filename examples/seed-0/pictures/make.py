"""Runs the six scripts and draws what one should see: at the start, half way, at the end.

Run: ulna run examples/seed-0/pictures/make.py
"""

import os
import runpy
import tempfile
from pathlib import Path

os.environ |= {"ULNA_HEADLESS": "1", "MPLBACKEND": "Agg"}

import numpy as np
import swift
from PIL import Image

from ulna.viewer import Camera

HERE = Path(__file__).parent
CAMERA = Camera((2.1, -1.6, 1.1), (0.36, -0.05, 0.26))
WIDTH, HEIGHT = 360, 320


def save(pictures, name):
    """Pictures side by side, in 256 colours."""
    strip = Image.fromarray(np.concatenate(pictures, axis=1)[..., :3])
    few = strip.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=4, dither=Image.Dither.NONE)
    few.save(HERE / f"{name}.png", optimize=True)


def drawn(env, configurations):
    """The environment with the robot in each of some configurations."""
    out = []
    for q in configurations:
        for figure in env.viewer.robots:
            figure.q = q
        out.append(env.viewer.picture(width=WIDTH, height=HEIGHT))
    return out


def thirds(rows):
    """The first row, the one half way, the last."""
    return [rows[0], rows[len(rows) // 2], rows[-1]]


def opened(robot):
    """An environment with a robot in it."""
    env = swift.Swift()
    env.launch()
    env.add(robot)
    env.set_camera_pose(CAMERA.position, CAMERA.target)
    return env


def run(script):
    """What a script leaves behind, and where its robot was before each step."""
    seen, step = [], swift.Swift.step

    def noted(env, *arguments):
        if not seen:
            env.viewer.camera = CAMERA
            seen.append(env.viewer.robots[0].q)
        step(env, *arguments)
        seen.append(env.viewer.robots[0].q)

    swift.Swift.step = noted
    try:
        return runpy.run_path(str(script)), seen
    finally:
        swift.Swift.step = step


def main():
    """Draws them all."""
    os.chdir(tempfile.mkdtemp())
    for script in sorted(HERE.parent.glob("rtb_example*.py")):
        text = script.read_text()
        if "#robot.plot" in text:  # the film, which the document has as a remark
            filmed = Path("film.py")
            filmed.write_text(text.replace("#robot.plot", "robot.plot"))
            space, _ = run(filmed)
            rows = [space["robot"]._complete_configuration(q) for q in space["qt"].q]
            save(drawn(opened(space["robot"]), thirds(rows)), "rtb_example6")
            with Image.open("panda1.gif") as film:
                film.seek(film.n_frames // 2)
                save([np.asarray(film.convert("RGB"))], "panda1")
        else:
            space, seen = run(script)
            env = space.get("env") or opened(space["robot"])
            save(drawn(env, thirds(seen) if seen else [env.viewer.robots[0].q]), script.stem)


if __name__ == "__main__":
    main()
