"""A robot for web pages: forward and inverse kinematics as WebAssembly with typed JavaScript around it.

You should see the files with their sizes and, where node is installed, answers by the code that runs in a page.
"""

from __future__ import annotations

import gzip
import shutil
import subprocess
import tempfile
from pathlib import Path

import ulna

SCRIPT = """
import { load } from "./panda.js";

const robot = await load();
const T = robot.fk([0.3, -0.5, 0.1, -2.0, 0.2, 1.6, 0.8]);
const found = robot.ik(T);
console.log("tool at", Array.from([T[3], T[7], T[11]], (x) => x.toFixed(4)).join(", "), "m");
const error = found.positionError.toExponential(1);
console.log("solved:", found.success, "in", found.iterations, "steps, off by", error, "m");
try {
  robot.fk([0.3, -0.5]);
} catch (refusal) {
  console.log(refusal.message);
}
"""


def main() -> None:
    """Writes a folder for a web page and calls it from node."""
    robot = ulna.load("panda")
    with tempfile.TemporaryDirectory() as place:
        folder = ulna.export(robot, ["fk", "ik"], to="wasm", path=Path(place) / "panda_web")
        for file in sorted(folder.iterdir()):
            packed = len(gzip.compress(file.read_bytes()))
            print(f"{file.stat().st_size:7,d} bytes, {packed:6,d} gzipped  {file.name}")
        node = shutil.which("node")
        if node is None:
            print("node is not installed here; the files run in any browser.")
            return
        (folder / "call.mjs").write_text(SCRIPT)
        subprocess.run([node, "call.mjs"], cwd=folder, check=True)


if __name__ == "__main__":
    main()
