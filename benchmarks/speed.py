"""One table of speed: every robot and quantity beside Pinocchio and MuJoCo, in turns, with what limits each row.

    python benchmarks/speed.py [--quick] [--only NAME,NAME] [--store FILE] [--seconds S] [--table] [robot ...]

Robots: those of derivatives.py (Panda, UR5, Solo12, G1, Talos), and chains of 100, 1,000 and 5,000 revolute joints. Needs
`pin` and `example-robot-data`; MuJoCo where it is installed and reads the file. All libraries read the same URDF, without
meshes; robots that walk have a free flyer, and stand on contacts for constrained dynamics (as in constraints.py).

With `--store FILE` each row is written to the file as soon as it is measured, rows that are there are not measured again,
and `--seconds S` begins no row after S seconds: call it again, on a quiet machine each time, until nothing is missing.
`--table` measures nothing and prints the table of the file. Columns:

- one call from Python of Ulna's kernel, of Pinocchio's function, their ratio, and of MuJoCo's functions, each computing all
  that the quantity needs of a new configuration (MuJoCo's mass matrix is sparse);
- one of 1,000 samples in a batch, beside a loop over Pinocchio; the same in float32, and its largest error beside the largest
  entry; how many times as fast a batch of some 10 ms is with two threads;
- how long the single call and the batch take to compile with an empty cache and with a full one, tracing included;
- what limits the single call and the batch, as `kernel.report()` estimates it;
- the memory limit: how long NumPy takes to write as many numbers as the batch returns, as a part of the batch's time.

A second table has what methods of robots cost beyond their kernels. CasADi's C stands beside exported C in export_c.py.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["ULNA_QUIET"] = "1"

import constraints
import numpy as np
import pinocchio as pin
from _speed_robots import CONTACTS, LABELS, PEERS, models, mujoco_calls, on_contacts
from _timing import medians, shown, table
from large_robots import SQUARE

from ulna import kernels
from ulna.errors import UlnaError
from ulna.robot import Robot

BATCH = 1_000
LARGE = 99
"""Joints from which on batches are smaller."""
QUICK = ("fk", "jacobian", "inverse_dynamics", "mass_matrix", "forward_dynamics")

METHODS = {
    "fk": ("q",), "jacobian": ("q",), "gravity_forces": ("q",), "mass_matrix": ("q",), "inverse_dynamics": ("q", "v", "a"),
    "forward_dynamics": ("q", "v", "a"), "bias_forces": ("q", "v"), "frame_velocity": ("q", "v"), "manipulability": ("q",),
}  # fmt: skip
"""Methods of robots that have the names of their kernels, and their arguments."""

HEAD = ["robot", "quantity", "one call", "pin", "ratio", "MuJoCo", "in a batch", "ratio", "float32", "its error",
        "two threads", "compiled", "from cache", "limit", "limit of batch", "only writing"]  # fmt: skip

Row = dict[str, Any]


def ready(robot: Robot, name: str, options: dict[str, Any], few: list[Any]) -> tuple[float, Any]:
    """Seconds until a kernel has answered one call and a batch, and the kernel."""
    kernels._made.clear()
    kernels._recent.clear()
    start = time.perf_counter()
    kernel = robot.kernel(name, **options)
    kernel(*(array[0] for array in few))
    kernel(*few)
    return time.perf_counter() - start, kernel


def batch_size(robot: Robot) -> int:
    """Samples of a batch."""
    return BATCH if robot.nv <= LARGE else 100 if robot.nv <= 200 else 4


def row(label: str, robot: Robot, peer: Any, theirs: dict[str, Any], name: str, quick: bool) -> Row:
    """One robot and one quantity, in seconds."""
    memory = None if peer is None else peer.createData()
    count, function = PEERS.get(name, (0, None))
    options: dict[str, Any] = {}
    if name in CONTACTS:
        count, function, options = on_contacts(label, name, peer, memory)
    elif name in ("fk", "jacobian") and peer is not None:
        options = {"frame": peer.frames[peer.nframes - 1].name}  # the one that Pinocchio is asked for
    rng, size = np.random.default_rng(0), batch_size(robot)
    few = [robot.random_configuration((size,), seed=1), *rng.standard_normal((2, size, robot.nv))][:count]
    one = [array[0].copy() for array in few]
    cold, kernel = ready(robot, name, options, [array[:2] for array in few])
    cached, kernel = ready(robot, name, options, [array[:2] for array in few])
    out = kernel(*few)
    result: Row = {"robot": label, "quantity": name, "compiled": cold, "from cache": cached}
    seconds, repeat = (0.005, 5) if quick else (0.01, 15)
    result |= single_calls(kernel, one, function, peer, memory, theirs.get(name), repeat, seconds)
    result |= batches(kernel, few, out, repeat // 2 + 1, seconds)
    result |= in_float32(robot, name, options, few, out, repeat // 2 + 1, seconds)
    if robot.nv <= LARGE:
        copies = int(np.clip(0.01 / (result["in a batch"] * size), 1, 100))
        many = [np.tile(array, (copies, 1)) for array in few]
        into = kernel(*many)
        calls = [lambda: kernel(*many, out=into), lambda: kernel(*many, threads=2, out=into)]
        alone, two = medians(calls, repeat // 2 + 1, seconds)
        result["two threads"] = alone / two
    if not quick:
        result["limit"], result["limit of batch"] = kernel.report().limit, kernel.report(batch=True).limit
    return result


def single_calls(
    kernel: Any,
    one: list[Any],
    function: Any,
    peer: Any,
    memory: Any,
    other: Any,
    repeat: int,
    seconds: float,
) -> Row:
    """One call of ours and of the others, without that of an empty function."""
    calls = {"empty": lambda: None, "one call": lambda: kernel(*one)}
    if peer is not None:
        rng = np.random.default_rng(1)
        state = [pin.randomConfiguration(peer), *rng.standard_normal((2, peer.nv))][: len(one)]
        calls["pin"] = lambda: function(peer, memory, *state)
    if other is not None:
        calls["MuJoCo"] = other
    took = dict(zip(calls, medians([*calls.values()], repeat, seconds), strict=True))
    empty = took.pop("empty")
    return {key: max(value - empty, 1e-9) for key, value in took.items()}


def batches(kernel: Any, few: list[Any], out: Any, repeat: int, seconds: float) -> Row:
    """A sample of a batch, and of NumPy writing as many numbers to the same place."""
    results = out if isinstance(out, tuple) else (out,)

    def write() -> None:
        for array in results:
            array.fill(0.0)

    batch, written = medians([lambda: kernel(*few, out=out), write], repeat, seconds)
    return {"in a batch": batch / len(few[0]), "only writing": written / batch}


def in_float32(
    robot: Robot, name: str, options: dict[str, Any], few: list[Any], out: Any, repeat: int, seconds: float
) -> Row:
    """A sample of a batch in float32, and the largest error beside the largest entry."""
    small = robot.kernel(name, dtype=np.float32, **options)
    few32 = [array.astype(np.float32) for array in few]
    out32 = small(*few32)
    exact = robot.kernel(name, **options)(*(array.astype(float) for array in few32))
    pairs = zip(*(x if isinstance(x, tuple) else (x,) for x in (exact, out32)), strict=True)
    errors = [np.abs(x - y).max() / max(np.abs(x).max(), 1e-300) for x, y in pairs if np.ndim(x) > 1]
    (batch,) = medians([lambda: small(*few32, out=out32)], repeat, seconds)
    return {"float32": batch / len(few[0]), "its error": float(max(errors, default=0.0))}


def cells(row: Row) -> list[str]:
    """A row as text."""
    if "note" in row:
        return [row["robot"], row["quantity"], row["note"], *[""] * (len(HEAD) - 3)]
    time_of = lambda key: shown(row[key]) if key in row else ""  # noqa: E731
    ratio = lambda key: f"{row['pin'] / row[key]:.1f}" if "pin" in row else ""  # noqa: E731
    return [
        row["robot"], row["quantity"], time_of("one call"), time_of("pin"), ratio("one call"), time_of("MuJoCo"),
        time_of("in a batch"), ratio("in a batch"), time_of("float32"), f"{row['its error']:.0e}",
        f"{row['two threads']:.2f}" if "two threads" in row else "", time_of("compiled"), time_of("from cache"),
        row.get("limit", ""), row.get("limit of batch", ""), f"{row['only writing']:.0%}",
    ]  # fmt: skip


def stored(path: Path | None) -> dict[tuple[str, str], Row]:
    """The rows of a file, by robot and quantity; the last one counts."""
    lines = path.read_text().splitlines() if path is not None and path.exists() else []
    rows = map(json.loads, lines)
    return {(row["robot"], row["quantity"]): row for row in rows}


def measure(wanted: Sequence[tuple[str, str]], path: Path | None, quick: bool, until: float) -> list[Row]:
    """Measures rows until it is that late; what cannot be measured becomes a note."""
    rows: list[Row] = []
    for label in dict.fromkeys(label for label, _ in wanted):
        if time.monotonic() > until:
            break
        with tempfile.TemporaryDirectory() as folder:
            os.environ["ULNA_CACHE"] = folder
            model, peer, other = models(label, folder)
            robot, theirs = Robot(model), {} if other is None else mujoco_calls(other)
            for name in (name for of, name in wanted if of == label):
                if time.monotonic() > until:
                    break
                print(f"{label}, {name} ...", file=sys.stderr, flush=True)
                try:
                    made = (
                        beyond(robot) if name == "methods" else row(label, robot, peer, theirs, name, quick)
                    )
                except UlnaError as error:
                    made = {"note": f"{type(error).__name__}: {str(error).split('. ')[0]}."}
                rows.append({"robot": label, "quantity": name, **made})
                if path is not None:
                    with path.open("a") as file:
                        file.write(json.dumps(rows[-1]) + "\n")
    return rows


def beyond(robot: Robot) -> Row:
    """What methods cost beyond the kernels that they call."""
    rng = np.random.default_rng(0)
    values: dict[str, Any] = {"q": robot.random_configuration(seed=0)}
    values |= dict(zip("va", rng.standard_normal((2, robot.nv)), strict=True))
    calls: dict[str, tuple[float, float]] = {}
    for name, arguments in METHODS.items():
        scope = {"robot": robot, "kernel": robot.kernel(name, checked=True), **values}
        listed = ", ".join(arguments)
        method, kernel = (eval(f"lambda: {f}({listed})", scope) for f in (f"robot.{name}", "kernel"))
        over, under = medians([method, kernel], 41, 0.003)
        calls[f"robot.{name}({listed})"] = over, under
    return {"calls": calls}


def choices() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="five quantities, few repetitions, no limits")
    parser.add_argument("--only", help=f"quantities, out of {', '.join([*PEERS, *CONTACTS, 'methods'])}")
    parser.add_argument("--store", type=Path, help="file of rows, which is continued")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin no row later than this")
    parser.add_argument("--table", action="store_true", help="print the rows of the store, measure none")
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(LABELS)}; default all")
    given = parser.parse_args()
    known = [*PEERS, *CONTACTS, "methods"]
    given.names = given.only.split(",") if given.only else [*QUICK, "methods"] if given.quick else known
    for word, valid in [
        *((name, known) for name in given.names),
        *((label, LABELS) for label in given.robots),
    ]:
        if word not in valid:
            parser.error(f"{word!r} is unknown; expected one of {', '.join(valid)}")
    return given


def main() -> None:
    """Measures what is missing, and prints the tables."""
    given, start = choices(), time.monotonic()
    wanted = [
        (label, name)
        for label in given.robots or LABELS
        for name in given.names
        if (name not in CONTACTS or label in constraints.STANDING)
        and (name != "methods" or label == "Panda")
        and (name not in SQUARE or label != "chain 5000")
    ]
    rows = stored(given.store)
    if not given.table:
        missing = [key for key in wanted if key not in rows]
        made = measure(missing, given.store, given.quick, start + given.seconds)
        rows |= {(row["robot"], row["quantity"]): row for row in made}
    chosen = [rows[key] for key in wanted if key in rows]
    left = len(wanted) - len(chosen)
    versions = f"Python {sys.version.split()[0]}, NumPy {np.__version__}, pin {pin.__version__}"
    print(f"{versions}, {platform.machine()}{f'; {left} rows are missing' if left else ''}\n")
    title = f"Speed: one call, and one of {BATCH:,} samples in a batch, one core"
    print(table(title, HEAD, [cells(row) for row in chosen if "calls" not in row]))
    head = ["call", "method", "kernel", "beyond"]
    for row in (row for row in chosen if "calls" in row):
        costs = [[f, shown(a), shown(b), f"{(a - b) * 1e9:.0f} ns"] for f, (a, b) in row["calls"].items()]
        print(table(f"What methods of {row['robot']} cost beyond their kernels", head, costs))


if __name__ == "__main__":
    main()
