"""How long first calls take with an empty cache, of every quantity: each in a process of its own.

    python benchmarks/first_calls.py [--all] [--avx2] [--kernels NAME,NAME] [--jobs N] [robot ...]

Needs `pin` and `example-robot-data`, as derivatives.py does, with whose robots it works. All times are those of the processor, tracing included, so that a
busy machine distorts them little. "one call" is what a first call waits for, "batch" what the first batch waits for after that, or, of "batch only", where
none came before. Of each, "tracing" is the part that makes graphs and "LLVM" the part that LLVM takes; the rest writes text. LLVM is loaded before, and the
model is there. Quantities above the goal are listed, with `--all` the others as well; `--avx2` compiles for registers of 256 bits.

Arms stand on a contact of their tool where a quantity asks for contacts, legged robots on their feet. "NAME packed" is `robot.kernel(NAME).packed()`.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from _timing import table
from constraints import STANDING
from derivatives import ROBOTS, load

from ulna import kernels
from ulna.compiler import compile
from ulna.compiler.language import function
from ulna.compiler.runtime import jit
from ulna.model import FrameContact, Model
from ulna.robot import Robot

GOALS = {"Panda": 0.2, "UR5": 0.2, "Solo12": 1.0, "G1": 1.0, "Talos": 1.0}
"""Seconds for one call, and for a batch."""
PACKED = (
    "mass_matrix",
    "inverse_mass_matrix",
    "coriolis_matrix",
    "jacobian",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
    "constrained_dynamics_derivatives",
    "centroidal_derivatives",
    "joint_torque_regressor",
)
GRADIENTS = ("manipulability", "kinetic_energy", "potential_energy")
SEARCHES = ("ik",)


def names() -> list[str]:
    """What is measured."""
    packed = [f"{name} packed" for name in PACKED]
    return [*kernels.QUANTITIES, *packed, *(f"{name} gradient" for name in GRADIENTS), *SEARCHES]


class Clock:
    """Time of the processor that goes into calls of a function.

    Args:
        module: Where the function is looked up.
        name: Its name there.
    """

    def __init__(self, module: Any, name: str) -> None:
        self.seconds, self._depth, call = 0.0, 0, getattr(module, name)

        def timed(*args: Any, **options: Any) -> Any:
            start, self._depth = time.process_time(), self._depth + 1
            try:
                return call(*args, **options)
            finally:
                self._depth -= 1
                if not self._depth:
                    self.seconds += time.process_time() - start

        setattr(module, name, timed)


def options_of(label: str, model: Model, name: str) -> dict[str, Any]:
    """The options of a kernel, where default values do not make sense."""
    if "constraints" not in kernels.QUANTITIES[name].options:
        return {}
    contacts = STANDING[label][1] if label in STANDING else [FrameContact(model.tool)]
    return {"constraints": tuple(contacts)}


def first_calls(label: str, model: Model, name: str, batch_only: bool) -> list[float]:
    """Seconds of a first call, of its tracing and of LLVM, and of a first batch, its tracing and LLVM."""
    clocks = Clock(function, "_returned"), Clock(jit, "_object")
    steps = _search(model) if name in SEARCHES else _kernel(label, model, name, batch_only)
    found: list[float] = []
    for step in steps:
        before = [clock.seconds for clock in clocks]
        start = time.process_time()
        step()
        found.append(time.process_time() - start)
        found += [clock.seconds - b for clock, b in zip(clocks, before, strict=True)]
    return found


def _kernel(label: str, model: Model, name: str, batch_only: bool) -> list[Callable[[], Any]]:
    """First call and first batch of a kernel."""
    base, _, form = name.partition(" ")
    made: list[Any] = []

    def one() -> None:
        kernel = kernels.kernel(model, base, **options_of(label, model, base))
        if form == "packed":
            kernel = kernel.packed()
        elif form == "gradient":
            kernel = kernel.value_and_gradient()
        made.append(kernel)
        if not batch_only:
            kernel(*(np.zeros(port.shape) for port in kernel.function.inputs))

    def many() -> None:
        made[0](*(np.zeros((64, *port.shape)) for port in made[0].function.inputs))

    return [one, many]


def _search(model: Model) -> list[Callable[[], Any]]:
    """First search and first batch of searches."""
    robot = Robot(model)
    goal = np.asarray(robot.fk(robot.random_configuration(seed=1)))
    return [lambda: robot.ik(goal), lambda: robot.ik(np.stack([goal] * 16))]


def apart(task: Callable[[], list[float]]) -> list[float] | str:
    """What a task returns in a process of its own, with an empty cache; the message of an error."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        try:
            with tempfile.TemporaryDirectory() as folder:
                os.environ["ULNA_CACHE"] = folder
                try:
                    result: Any = task()
                except Exception as error:
                    result = f"{type(error).__name__}: {error}"
            os.write(writing, json.dumps(result).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        text = pipe.read()
    os.waitpid(child, 0)
    return json.loads(text) if text else "the process ended"


def use_narrow_registers() -> None:
    """Compiles for a processor like this one whose registers have 256 bits."""
    target = jit.target()
    features = [f for f in target.features.split(",") if "avx512" not in f and "avx10" not in f]
    features = ",".join([*features, "-avx512f"])
    narrow = dataclasses.replace(target, cpu="x86-64-v3", features=features, register_bytes=32)
    jit.target = lambda: narrow  # type: ignore[assignment]
    jit._machine_of_level.cache_clear()
    jit._engine.cache_clear()


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--all", action="store_true", help="list what meets the goal, too")
    parser.add_argument("--avx2", action="store_true", help="compile for registers of 256 bits")
    parser.add_argument("--batch-only", action="store_true", help="batches without a single call before")
    parser.add_argument("--kernels", default=",".join(names()))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(ROBOTS)}; default all")
    given = parser.parse_args()
    os.environ |= {"ULNA_QUIET": "1", "ULNA_CACHE": "0"}
    models = {label: load(ROBOTS[label])[0] for label in given.robots or ROBOTS}
    chosen = [(label, name) for label in models for name in given.kernels.split(",")]
    if given.avx2:
        use_narrow_registers()
    for shape in ((2,), (9, 2)):  # LLVM has started
        compile(np.sin, x=(2,))(np.zeros(shape))

    def measured(pair: tuple[str, str]) -> list[float] | str:
        label, name = pair
        return apart(lambda: first_calls(label, models[label], name, given.batch_only))

    with ThreadPoolExecutor(given.jobs) as pool:
        results = list(pool.map(measured, chosen))
    rows, failed = [], []
    for (label, name), result in sorted(zip(chosen, results, strict=True), key=_largest):
        if isinstance(result, str):
            failed.append(f"{label}, {name}: {result.splitlines()[0][:120]}")
        elif given.all or max(result[0], result[3]) > GOALS[label]:
            rows.append([label, name, *(f"{x:.2f}" for x in result)])
    head = ["robot", "quantity", "one call", "tracing", "LLVM", "batch", "tracing", "LLVM"]
    goal = f"{len(rows)} of {len(chosen)}" + ("" if given.all else " above the goal")
    bits = "AVX2" if given.avx2 else f"registers of {8 * jit.target().register_bytes} bits"
    print(f"Python {sys.version.split()[0]}, {jit.target().cpu}, {bits}\n")
    print(table(f"First calls [s of processor time], {goal}", head, rows))
    for line in failed:
        print(f"- not measured: {line}")


def _largest(measured: tuple[tuple[str, str], list[float] | str]) -> float:
    result = measured[1]
    return 0.0 if isinstance(result, str) else -max(result[0], result[3])


if __name__ == "__main__":
    main()
