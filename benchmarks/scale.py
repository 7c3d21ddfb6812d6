"""Jobs on two workers beside one process, two plain processes, and joblib over Pinocchio; their memory; twenty kills.

    python benchmarks/scale.py [--part fk ik "long ik" plans map memory kills] [--samples 1e8] [--rounds 3]

Each part takes a minute or less, and can run alone. Ratios are medians of rounds in which all take turns. The cluster is
started before the clock. One process has the settings of the workers: one thread of BLAS, and memory that is kept. Two
plain processes, which share the parts without Dask, show what the machine can do; the extra time with workers is spent
in the engine. Rounds in which other programs use more than 3 % of the processors that a job has are tried again while
there is time (--seconds), and those with least of it count; the last column says what they used.
"""

from __future__ import annotations

import argparse
import os
import signal
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from _two_processes import TwoProcesses, busy

import ulna
from ulna import scale
from ulna.collision import World
from ulna.geometry import Box
from ulna.scale.cluster import connected, worker_environment
from ulna.scale.plan_job import Plans

_QUIET = 0.03  # of a processor that other programs use in a quiet round
JOBS, PARTS = ("fk", "ik", "long ik", "plans"), ("map", "memory", "kills")
WORLD = World().add("post", Box((0.1, 0.1, 1.0)), (0.5, 0.0, 0.3))


@dataclass(frozen=True, eq=False)
class Counted(scale.Job):
    """A histogram of heights: of poses, or of solutions of inverse kinematics of random poses."""

    kind: ClassVar[str] = "counted"
    robot: ulna.Robot
    samples: scale.Samples
    solve: bool

    @property
    def parts(self) -> int:
        """How many parts there are."""
        return self.samples.parts

    def description(self) -> dict[str, Any]:
        """What the result depends on."""
        return {"kind": self.kind, "samples": self.samples.count, "solve": self.solve}

    def start(self) -> dict[str, Any]:
        """No heights yet."""
        return {"count": np.zeros(20, dtype=int)}

    def work(self, part: int, *inputs: Any) -> dict[str, Any]:
        """The heights of a part."""
        rng, left, out = self.samples.generator(part), self.samples.size(part), np.zeros(20, dtype=int)
        while left:
            rows = min(left, 16_384)
            T = self.robot.fk(self.robot.random_configuration(rows, rng))
            heights = T[:, 2, 3]
            if self.solve:
                heights = heights[self.robot.ik(T).success]
            out += np.bincount(np.clip(((heights + 2.0) * 5.0).astype(int), 0, 19), minlength=20)
            left -= rows
        return {"count": out}

    def fold(self, state: Any, part: int, result: Any) -> None:
        """Adds those of a part."""
        state["count"] += result["count"]

    def existing(self, to: Any) -> Any:
        """The histogram in a file."""
        return np.load(to)

    def finish(self, state: Any, to: Any) -> Any:
        """The histogram."""
        return state["count"]


def processor_time(client: Any) -> float:
    """Of the workers and of this process, where the scheduler is, too [s]."""
    return time.process_time() + sum(client.run(time.process_time).values())


def plans_job(problems: int) -> scale.Job:
    """The job of `scale.plans` with its usual options."""
    lengths = {"margin": 0.0, "step": 0.01, "longest": 1.0}
    searching = {"shorten": 5, "improve": 0, "iterations": 100_000, "timeout": np.inf}
    samples = scale.Samples(problems, 25, 0)
    return Plans(ulna.load("panda"), samples, None, None, (WORLD,), 1, None, lengths, searching)


def measured(
    call: Callable[[], Any], clock: Callable[[], float], processes: int
) -> tuple[Any, float, float, float]:
    """A result, its time, its processor time, and what other programs used of its processors [s, s, processors]."""
    used, all_used, start = clock(), busy(), time.perf_counter()
    result = call()
    seconds = time.perf_counter() - start
    all_used, used = busy() - all_used, clock() - used
    idle = max((os.cpu_count() or 1) - processes, 0)  # others may have these
    return result, seconds, used, max((all_used - used) / seconds - idle, 0.0)


def named_jobs(samples: int) -> dict[str, tuple[str, scale.Job]]:
    """What each of the jobs is called in the table, and the job."""
    ur5 = ulna.load("ur5")
    n_ik, n_plans = samples // 100, max(samples // 10_000, 50)
    return {
        "fk": (
            f"{samples:.0e} FK, histogram, chunks of 1e5",
            Counted(ur5, scale.Samples(samples, 100_000, 0), False),
        ),
        "ik": (f"{n_ik:.0e} IK, chunks of 1e4", Counted(ur5, scale.Samples(n_ik, 10_000, 0), True)),
        "long ik": (
            f"{10 * n_ik:.0e} IK, chunks of 1e5",
            Counted(ur5, scale.Samples(10 * n_ik, 100_000, 0), True),
        ),
        "plans": (f"{n_plans:.0e} plans, chunks of 25", plans_job(n_plans)),
    }


def jobs(client: Any, pair: TwoProcesses, chosen: argparse.Namespace) -> None:
    """Jobs in turns in this process, in two plain processes, and on two workers: time and processor time."""
    heads = ("one process", "two plain processes", "two workers")
    print(f"{'time and processor time [s]':40s}" + "".join(f"{head:>20s}" for head in heads), end="")
    print("   times as fast: plain, workers   processor time more: plain, workers   others")
    for part, (name, job) in named_jobs(int(chosen.samples)).items():
        if part not in chosen.part:
            continue
        run = partial(scale.run, job, progress=False)
        job_rows = undisturbed(
            lambda run=run, job=job: (
                measured(lambda: run(workers=0), time.process_time, 1),
                measured(lambda: pair.run(job), pair.processor_time, 2),
                measured(lambda: run(scheduler=client), lambda: processor_time(client), 2),
            ),
            chosen.rounds,
            chosen.seconds,
        )
        times, used = np.array([[(m[1], m[2]) for m in row] for row in job_rows]).transpose(2, 1, 0)
        row = "".join(f"{np.median(t):12.2f}{np.median(u):8.2f}" for t, u in zip(times, used, strict=True))
        faster, more = (np.median(x, axis=-1) for x in (times[0] / times[1:], used[1:] / used[0] - 1.0))
        others = max(m[3] for row in job_rows for m in row)
        print(f"{name:40s}{row}{faster[0]:18.2f}{faster[1]:10.2f}{more[0]:26.1%}{more[1]:10.1%}{others:9.1%}")


def undisturbed(turn: Callable[[], Any], rounds: int, seconds: float) -> list[Any]:
    """Rounds in which other programs used little; those with least of it where no more of them fit into the time."""
    end = time.monotonic() + seconds
    turn()
    found: list[Any] = []
    longest = 0.0
    while len(found) < rounds or time.monotonic() + longest < end:
        start = time.monotonic()
        found.append(turn())
        longest = max(longest, time.monotonic() - start)
        first, *others = (result for result, *_ in found[-1])
        assert all(same(first, other) for other in others), "the same bits"
        found.sort(key=lambda row: max(m[3] for m in row))
        if len(found) >= rounds and max(m[3] for m in found[rounds - 1]) < _QUIET:
            break
    return found[:rounds]


def same(a: Any, b: Any) -> bool:
    """Whether two results have the same bits."""
    if isinstance(a, np.ndarray):
        return np.array_equal(a, b, equal_nan=True)
    return all(
        np.array_equal(getattr(a, n), getattr(b, n), equal_nan=n == "cost") for n in ("points", "cost")
    )


def pinocchio_heights(name: str, seed: int, count: int) -> Any:
    import pinocchio as pin

    robot = ulna.load(name)
    model = pin.buildSampleModelManipulator()  # six turning joints, as a UR5 has
    data, frame = model.createData(), model.nframes - 1
    heights = np.empty(count)
    for k, q in enumerate(robot.random_configuration(count, seed)):
        pin.framesForwardKinematics(model, data, q)
        heights[k] = data.oMf[frame].translation[2]
    return np.histogram(heights, 20, (-2.0, 2.0))[0]


def joblib_heights(count: int, workers: int) -> Any:
    from joblib import Parallel, delayed

    parts = Parallel(n_jobs=workers)(delayed(pinocchio_heights)("ur5", k, count // 10) for k in range(10))
    return sum(parts)


def timed(call: Callable[[], Any]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def in_turns(calls: dict[str, Callable[[], Any]], rounds: int) -> dict[str, float]:
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            times[name].append(timed(call))
    return {name: statistics.median(values) for name, values in times.items()}


def peak() -> float:
    """The largest resident memory of this process so far [MiB]."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def memory(client: Any) -> str:
    """The largest resident memory of a worker, and of this process."""
    return f"{max(client.run(peak).values()):.0f} MiB of a worker, {peak():.0f} MiB of the coordinator"


def kills(count: int) -> None:
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        cluster.adapt(minimum=2, maximum=2, interval="1s")
        done, over = [0], threading.Event()

        def kill() -> None:
            rng = np.random.default_rng(0)
            while done[0] < count and not over.wait(0.4):
                pids = [nanny.pid for nanny in cluster.workers.values() if nanny.pid]
                if pids:
                    os.kill(int(rng.choice(pids)), signal.SIGKILL)
                    done[0] += 1

        thread = threading.Thread(target=kill, daemon=True)
        thread.start()
        options: Any = {"voxel": 0.1, "chunk": 200_000, "progress": False}
        seconds = time.perf_counter()
        found = scale.reach("ur5", 6e7, scheduler=client, **options)
        seconds = time.perf_counter() - seconds
        over.set()
        thread.join()
    calm = scale.reach("ur5", 6e7, workers=0, **options)
    same = all(
        (getattr(found, n) == getattr(calm, n)).all()
        for n in ("count", "directions", "manipulability", "mean_manipulability")
    )
    print(f"{done[0]} kills in {seconds:.0f} s: {'the same bits' if same else 'OTHER BITS'}")


def maps(client: Any, n: int, rounds: int) -> None:
    """A reachability map, beside joblib over Pinocchio, which does forward kinematics alone."""
    small, options = n // 100, {"voxel": 0.1, "progress": False}

    def mapped(chunk: int, **where: Any) -> Callable[[], Any]:
        return lambda: scale.reach("ur5", n, chunk=chunk, **where, **options)

    for chunk in (1_000_000, 100_000):
        scale.reach("ur5", 2e6, chunk=chunk, scheduler=client, **options)
    joblib_heights(100, 2)
    times = in_turns(
        {
            "one process": mapped(1_000_000, workers=0),
            "two workers": mapped(1_000_000, scheduler=client),
            "two workers, chunks of 1e5": mapped(100_000, scheduler=client),
            "joblib over Pinocchio, 1/100 of them": lambda: joblib_heights(small, 2),
        },
        rounds,
    )
    one = times["one process"]
    for name, seconds in times.items():
        print(f"{name:40s} {seconds:8.2f} s   {one / seconds:6.2f} x one process")
    per_sample = times["joblib over Pinocchio, 1/100 of them"] / small * n
    print(
        f"joblib over Pinocchio (FK alone) would take {per_sample / times['two workers']:.0f} times as long as two workers"
    )


def memories(n: int) -> None:
    """The largest memory of workers and coordinator in jobs of some samples, and in ten times as large ones after them."""
    options: Any = {"progress": False}

    def rows(count: float, client: Any) -> None:
        with tempfile.TemporaryDirectory() as folder:
            to = Path(folder, "rows.zarr")
            scale.data_set("ur5", count, ["q", "fk"], chunk=100_000, to=to, scheduler=client, **options)

    jobs: dict[str, tuple[float, Callable[[float, Any], Any]]] = {
        "map, chunks of 1e6": (
            n,
            lambda count, client: scale.reach(
                "ur5", count, voxel=0.1, chunk=1_000_000, scheduler=client, **options
            ),
        ),
        "data set in Zarr, chunks of 1e5": (n / 20, rows),
        "plans, chunks of 25": (
            n / 10_000,
            lambda count, client: scale.plans("panda", count, WORLD, chunk=25, scheduler=client, **options),
        ),
    }
    for name, (count, call) in jobs.items():
        with connected(None, 2, 60.0) as client:  # memory that a process has had stays its largest
            call(count / 10, client)
            first = memory(client)
            call(count, client)
            print(f"{name:34s} {count / 10:.0e}: {first}   {count:.0e}: {memory(client)}")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=float, default=1e8)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=60.0, help="for the rounds of one job")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--part", choices=(*JOBS, *PARTS), nargs="+", default=(*JOBS, *PARTS))
    chosen = parser.parse_args()
    if "MALLOC_TRIM_THRESHOLD_" not in os.environ:  # read when a process starts
        os.environ.update({name: str(value) for name, value in worker_environment().items()})
        os.execv(sys.executable, [sys.executable, *sys.argv])
    if {*JOBS, "map"} & {*chosen.part}:
        with connected(None, 2, 60.0) as client:
            if {*JOBS} & {*chosen.part}:
                pair = TwoProcesses()
                jobs(client, pair, chosen)
                pair.close()
            if "map" in chosen.part:
                maps(client, int(chosen.samples) // 5, chosen.rounds)
    if "memory" in chosen.part:
        memories(int(chosen.samples))
    if "kills" in chosen.part:
        kills(chosen.kills)


if __name__ == "__main__":
    main()
