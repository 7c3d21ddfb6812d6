"""Jobs on two worker processes beside one process, and beside joblib over Pinocchio; twenty kills in one job.

    python benchmarks/scale.py [--samples 1e8] [--rounds 3] [--kills 20] [--part jobs]

Ratios are medians of rounds in which all take turns. The cluster is started before the clock. One process has the
settings of the workers: one thread of BLAS, and memory that is kept. On a machine that does other work, processor time says more
than time: the time that two workers and the coordinator take together, beside that of one process.
"""

from __future__ import annotations

import argparse
import os
import signal
import statistics
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

import ulna
from ulna import scale
from ulna.collision import World
from ulna.geometry import Box
from ulna.scale.cluster import connected, worker_environment

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


def jobs(client: Any, samples: int, rounds: int) -> None:
    """Three jobs, in turns in this process and on two workers: time and processor time."""
    ur5 = ulna.load("ur5")

    def counted(count: int, chunk: int, solve: bool) -> Callable[..., Any]:
        job = Counted(ur5, scale.Samples(count, chunk, 0), solve)
        return lambda **where: scale.run(job, progress=False, **where)

    def plans(**where: Any) -> Any:
        return scale.plans("panda", max(samples // 10_000, 50), WORLD, chunk=25, progress=False, **where).cost

    calls = {
        f"{samples:.0e} FK, histogram, chunks of 1e5": counted(samples, 100_000, False),
        f"{samples // 100:.0e} IK, chunks of 1e4": counted(samples // 100, 10_000, True),
        f"{max(samples // 10_000, 50)} plans, chunks of 25": plans,
    }
    print(
        f"{'job':42s} {'one process':>12s} {'CPU':>8s} {'two workers':>12s} {'CPU':>8s} {'ratio':>7s} {'CPU more':>9s}"
    )
    for name, call in calls.items():
        rows = []
        call(workers=0), call(scheduler=client)
        for _ in range(rounds):
            a, x = time.perf_counter(), time.process_time()
            one = call(workers=0)
            b, y = time.perf_counter(), time.process_time()
            start, p = time.perf_counter(), processor_time(client)
            two = call(scheduler=client)
            rows.append((b - a, y - x, time.perf_counter() - start, processor_time(client) - p))
            assert np.array_equal(one, two, equal_nan=True), "the same bits"
        one_s, one_cpu, two_s, two_cpu = (statistics.median(column) for column in zip(*rows, strict=True))
        ratio = statistics.median(row[0] / row[2] for row in rows)
        more = statistics.median(row[3] / row[1] for row in rows) - 1.0
        print(
            f"{name:42s} {one_s:10.2f} s {one_cpu:6.2f} s {two_s:10.2f} s {two_cpu:6.2f} s {ratio:6.2f}x {100 * more:8.1f}%"
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
            while done[0] < count and not over.wait(0.8):
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

    scale.reach("ur5", 2e6, chunk=100_000, scheduler=client, **options)
    first = memory(client)
    times = in_turns(
        {
            "one process": mapped(1_000_000, workers=0),
            "two workers": mapped(1_000_000, scheduler=client),
            "two workers, chunks of 1e5": mapped(100_000, scheduler=client),
            "joblib over Pinocchio, 1/100 of them": lambda: joblib_heights(small, 2),
        },
        rounds,
    )
    last = memory(client)
    one = times["one process"]
    for name, seconds in times.items():
        print(f"{name:40s} {seconds:8.2f} s   {one / seconds:6.2f} x one process")
    per_sample = times["joblib over Pinocchio, 1/100 of them"] / small * n
    print(
        f"joblib over Pinocchio (FK alone) would take {per_sample / times['two workers']:.0f} times as long as two workers"
    )
    print(f"largest memory after 2e6 samples: {first}")
    print(f"after {3 * rounds * n:.0e} more: {last}")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=float, default=1e8)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--part", choices=("jobs", "map", "kills", "all"), default="all")
    chosen = parser.parse_args()
    if "MALLOC_TRIM_THRESHOLD_" not in os.environ:  # read when a process starts
        os.environ.update({name: str(value) for name, value in worker_environment().items()})
        os.execv(sys.executable, [sys.executable, *sys.argv])
    with connected(None, 2, 60.0) as client:
        if chosen.part in ("jobs", "all"):
            jobs(client, int(chosen.samples), chosen.rounds)
        if chosen.part in ("map", "all"):
            maps(client, int(chosen.samples), chosen.rounds)
    if chosen.kills and chosen.part in ("kills", "all"):
        kills(chosen.kills)


if __name__ == "__main__":
    main()
