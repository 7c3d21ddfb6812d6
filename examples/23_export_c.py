"""A robot as C for a controller: kernels, inverse kinematics and a function of your own.

You should see the files, what the header says of the Jacobian, and, where there is a C compiler, its test program pass.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import ulna


def main() -> None:
    """Writes a folder of C, compiles it and runs its test."""
    robot = ulna.load("panda")

    def spring(q: Any, v: Any, target: Any) -> Any:
        """Torques that pull the joints to a target, against gravity."""
        return 50.0 * (target - q) - 5.0 * v + robot.gravity_forces(q)

    law = ulna.compile(spring, robot, target=(robot.nq,))
    with tempfile.TemporaryDirectory() as place:
        kernels = {"fk": "fk", "jacobian": ("jacobian", {"reference": "local"}), "ik": "ik", "spring": law}
        folder = ulna.export(robot, kernels, to="c", path=Path(place) / "panda_c")
        for file in sorted(folder.iterdir()):
            print(f"{file.stat().st_size:8,d} bytes  {file.name}")
        header = (folder / "panda.h").read_text()
        print(header[header.index("/* The Jacobian") : header.index("/* Torques")])
        compiler = shutil.which("cc") or shutil.which("gcc")
        if compiler is None:
            print("There is no C compiler here.")
            return
        program = Path(place) / "test"
        words = [compiler, "-std=c99", "-O2", "-o", program, *sorted(folder.glob("*.c")), "-lm"]
        subprocess.run(words, check=True)
        print(subprocess.run([program], capture_output=True, text=True, check=True).stdout)


if __name__ == "__main__":
    main()
