"""Jobs on two worker processes beside one process, and beside joblib over Pinocchio; twenty kills in one job.

    python benchmarks/scale.py [--samples 1e7] [--rounds 3] [--kills 20]

Ratios are medians of rounds in which all take turns. The cluster is started before the clock.
"""

from __future__ import annotations

import argparse
import os
import signal
import statistics
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import ulna
from ulna import scale
from ulna.scale.cluster import connected


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


def worker_memory(client: Any) -> float:
    """The largest resident memory of a worker [MiB]."""

    def peak() -> float:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    return max(client.run(peak).values())


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


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=float, default=1e7)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--kills", type=int, default=20)
    chosen = parser.parse_args()
    n, small = int(chosen.samples), int(chosen.samples) // 100
    options: Any = {"voxel": 0.1, "progress": False}
    with connected(None, 2, 60.0) as client:
        scale.reach("ur5", 2e6, chunk=100_000, scheduler=client, **options)
        first = worker_memory(client)
        times = in_turns(
            {
                "one process": lambda: scale.reach("ur5", n, chunk=1_000_000, workers=0, **options),
                "two workers": lambda: scale.reach("ur5", n, chunk=1_000_000, scheduler=client, **options),
                "two workers, chunks of 1e5": lambda: scale.reach(
                    "ur5", n, chunk=100_000, scheduler=client, **options
                ),
                "joblib over Pinocchio, 1/100 of them": lambda: joblib_heights(small, 2),
            },
            chosen.rounds,
        )
        last = worker_memory(client)
    one = times["one process"]
    for name, seconds in times.items():
        print(f"{name:40s} {seconds:8.2f} s   {one / seconds:6.2f} x one process")
    per_sample = times["joblib over Pinocchio, 1/100 of them"] / small * n
    print(
        f"joblib over Pinocchio (FK alone) would take {per_sample / times['two workers']:.0f} times as long as two workers"
    )
    print(
        f"largest memory of a worker: {first:.0f} MiB after 2e6 samples, {last:.0f} MiB after {2 * chosen.rounds * n:.0e} more"
    )
    if chosen.kills:
        kills(chosen.kills)


if __name__ == "__main__":
    main()
