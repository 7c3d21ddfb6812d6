"""Gradients and products with Hessians beside the functions they are derivatives of.

    python benchmarks/gradients.py [Panda] [G1] [chain100] [chain1000] [--steps]

Costs of one configuration (the squared length of torques, of accelerations, of the last frame's position) by their
arguments q, and with `--steps` the sum of such costs along steps of a loop by the torques of all steps. Times of one call
and of a sample of a batch of 64, both into arrays that exist, in turns; the lowest sixth of the rounds, so that other
programs hit all alike. Compilation is that of one call, tracing included, with an empty cache.
"""

from __future__ import annotations

import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from typing import Any

os.environ["ULNA_QUIET"] = "1"
os.environ["ULNA_CACHE"] = "0"  # so that the times of compilation are those of LLVM
os.environ.setdefault("ULNA_MOST_OPERATIONS", "0")

import numpy as np
from _speed_robots import chain_file
from _timing import shown, table

import ulna
from ulna import numeric
from ulna.compiler import compile as compile_function
from ulna.compiler import trace

ROUNDS, SECONDS = 25, 0.01
STEPS = {"Panda": 100}


def robot(label: str) -> Any:
    if label.startswith("chain"):
        with tempfile.TemporaryDirectory() as folder:
            return ulna.load(chain_file(int(label.removeprefix("chain")), folder))
    return ulna.load(label.lower())


def costs(model: Any) -> dict[str, Any]:
    """Functions of one configuration, by name."""
    nq, nv = model.nq, model.nv
    torques, accelerations, pose = (
        model.function(name) for name in ("inverse_dynamics", "forward_dynamics", "fk")
    )
    square = lambda x: x @ x  # noqa: E731
    return {
        "inverse dynamics": trace(lambda q, v, a: square(torques(q, v, a)), q=(nq,), v=(nv,), a=(nv,)),
        "forward dynamics": trace(
            lambda q, v, tau: square(accelerations(q, v, tau)), q=(nq,), v=(nv,), tau=(nv,)
        ),
        "fk": trace(lambda q: square(pose(q)[:3, 3]), q=(nq,)),
    }


def steps(model: Any, name: str, count: int) -> Any:
    """A function of constant torques (or accelerations): the squared velocity after so many steps in a loop."""
    nq, nv, dynamics = model.nq, model.nv, model.function(name)

    def cost(q: Any, v: Any, u: Any) -> Any:
        def step(k: Any, *state: Any) -> Any:
            q, v = np.array(state[:nq]), np.array(state[nq:])
            v = v + 1e-3 * dynamics(q, v, u)
            q = model.integrate(q, 1e-3 * v) if nq != nv else q + 1e-3 * v
            return (k + 1.0, *q, *v)

        end = numeric.loop(lambda k, *_: k < count, step, (0.0, *q, *v), limit=count)
        return np.array(end[1 + nq :]) @ np.array(end[1 + nq :])

    return trace(cost, q=(nq,), v=(nv,), u=(nv,))


def turns(calls: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Seconds of one call of each."""
    counts, took = {}, {name: [] for name in calls}
    for name, call in calls.items():
        call()
        start, n = time.perf_counter(), 0
        while time.perf_counter() - start < SECONDS:
            call()
            n += 1
        counts[name] = n
    for _ in range(ROUNDS):
        for name, call in calls.items():
            start = time.perf_counter()
            for _ in range(counts[name]):
                call()
            took[name].append((time.perf_counter() - start) / counts[name])
    return {name: statistics.mean(sorted(each)[: ROUNDS // 6]) for name, each in took.items()}


def arguments(f: Any, rows: int, quaternion: bool) -> list[np.ndarray]:
    """Random arguments of a function, (rows, ...); a base has a unit quaternion."""
    rng = np.random.default_rng(0)
    found = [0.3 * rng.standard_normal((rows, *port.shape)) for port in f.inputs]
    if quaternion:
        found[0][:, 3:7] /= np.linalg.norm(found[0][:, 3:7], axis=1, keepdims=True)
    return found


def row(label: str, name: str, f: Any, wrt: str, quaternion: bool) -> list[str]:
    """Times of the function, its value with its gradient, and the product of its Hessian with a vector."""
    begin = time.perf_counter()
    functions = {"function": f, "gradient": f.value_and_gradient(wrt), "product": f.hvp(wrt)}
    kernels, compiled = {}, {}
    for key, function in functions.items():
        begin = time.perf_counter()
        kernels[key] = compile_function(function)
        kernels[key](*[a[0] for a in arguments(function, 1, quaternion)])
        compiled[key] = time.perf_counter() - begin
    took = []
    for rows in (None, 64):
        calls = {}
        for key, kernel in kernels.items():
            given = arguments(functions[key], rows or 1, quaternion)
            given = given if rows else [a[0] for a in given]
            results = kernel(*given)
            out = tuple(map(np.array, results)) if isinstance(results, tuple) else np.array(results)
            calls[key] = lambda kernel=kernel, given=given, out=out: kernel(*given, out=out)
        seconds = turns(calls)
        took.append({key: value / (rows or 1) for key, value in seconds.items()})
    one, many = took
    operations = {key: functions[key].operations for key in functions}
    ratio = lambda times, key: f"{times[key] / times['function']:.1f}"  # noqa: E731
    return [
        label, name, f"{operations['function']:,}", f"{operations['gradient'] / operations['function']:.1f}",
        shown(one["function"]), ratio(one, "gradient"), ratio(one, "product"),
        shown(many["function"]), ratio(many, "gradient"), ratio(many, "product"),
        shown(compiled["gradient"]),
    ]  # fmt: skip


def main() -> None:
    labels = [word for word in sys.argv[1:] if not word.startswith("--")] or ["Panda", "G1", "chain100"]
    head = [
        "robot", "cost", "operations", "those of its gradient", "one call", "its gradient", "Hessian-vector product",
        "in a batch", "its gradient", "Hessian-vector product", "gradient compiled",
    ]  # fmt: skip
    rows = []
    for label in labels:
        model = robot(label)
        if "--steps" in sys.argv:
            count = STEPS.get(label, 20)
            found = {
                f"{count} steps of {name.replace('_', ' ')}": (steps(model, name, count), "u")
                for name in ("inverse_dynamics", "forward_dynamics")
            }
        else:
            found = {name: (f, "q") for name, f in costs(model).items()}
        for name, (f, wrt) in found.items():
            rows.append(row(label, name, f, wrt, model.nq != model.nv))
            print("|", " | ".join(rows[-1]), "|", flush=True)
    print(table("Gradients", head, rows))


if __name__ == "__main__":
    main()
