"""Jobs end with the same bits whatever happens to workers, disks and schedulers, or say what is missing."""

from __future__ import annotations

import contextlib
import logging
import os
import pickle
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from support.clusters import cluster
from support.jobs import Drawn, Patient, Rows, Sums
from ulna import scale
from ulna.errors import InputError, JobStopped, VersionMismatch
from ulna.scale import engine, task_sizes, task_work
from ulna.scale.cluster import _WITHOUT_MESSAGES, worker_environment

pytest.importorskip("distributed")


def _find_tests() -> None:
    sys.path.insert(0, str(Path(__file__).parents[2]))


def _expected(count: int) -> Any:
    return scale.run(Sums(count), workers=0, progress=False)


def _expected_in_order(count: int) -> Any:
    job = Sums(count)
    state = job.start()
    for part in range(count):
        job.fold(state, part, job.work(part))
    return state["sum"]


def test_parts_are_added_in_order_on_any_number_of_workers(client: Any) -> None:
    seen: list[scale.Progress] = []
    got = scale.run(Sums(40), scheduler=client, progress=seen.append)
    np.testing.assert_array_equal(got, _expected(40))
    assert seen[-1].done == seen[-1].parts == 40 and seen[0].done == 0
    assert "40 of 40 parts, 100 %" in str(seen[-1])


def test_parts_are_sent_together_and_what_they_need_with_them(
    client: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows, submit, tasks = np.random.default_rng(0).standard_normal((4000, 3)), client.submit, []

    def counted(*args: Any, **options: Any) -> Any:
        tasks.append(options["key"])
        return submit(*args, **options)

    monkeypatch.setattr(client, "submit", counted)
    got = scale.run(Rows(rows), scheduler=client, progress=False)
    np.testing.assert_array_equal(got, scale.run(Rows(rows), workers=0, progress=False))
    assert len(set(tasks)) == len(tasks) < 500, "of 1000 parts"


@pytest.mark.parametrize(
    ("limit", "size", "many"), [(100.0, 3, 6), (8.0, 3, 3), (0.0, 3, 1), (100.0, 2**20, 2)]
)
def test_a_task_ends_early_where_time_or_memory_is_used_up(
    monkeypatch: pytest.MonkeyPatch, limit: float, size: int, many: int
) -> None:
    now = iter([0.0, *np.arange(5.0, 50.0, 2.0)])  # the first part compiles for 3 s
    monkeypatch.setattr(task_work, "time", SimpleNamespace(perf_counter=lambda: next(now)))

    def work(part: int, row: int) -> dict[str, Any]:
        return {"numbers": np.array([part, row]), "zeros": np.zeros(size)}

    inputs = [(k,) for k in range(6)]
    content, count, seconds, total = task_work.work_parts("task", work, range(5, 11), inputs, limit)
    numbers = [result["numbers"].tolist() for result in pickle.loads(content)]
    assert numbers == [[5 + k, k] for k in range(many)] and count == many
    assert seconds == (5.0 if many == 1 else 2.0) and total == many * 8 * (size + 2)


def test_a_task_gives_back_parts_that_it_has_not_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    """Asked in its second part of 1 s, when it has four more, for half of them; then in the last, when it has none."""
    now, kept = [0.0], list[dict[str, int]]()
    monkeypatch.setattr(task_work, "time", SimpleNamespace(perf_counter=lambda: now[0]))

    def work(part: int) -> dict[str, Any]:
        now[0] += 1.0
        if part in (1, 3):
            kept.append(task_work.give_back(["another", "task"], 0.5))
        return {"part": np.array(part)}

    content, count, _, _ = task_work.work_parts("task", work, range(6), None, 100.0)
    assert [int(result["part"]) for result in pickle.loads(content)] == [0, 1, 2, 3] and count == 4
    assert kept == [{"task": 4}, {"task": 4}]
    assert task_work.give_back(["task"], 0.5) == {}, "it has ended"


def test_a_task_keeps_what_it_has_done_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    now, kept = [0.0], list[dict[str, int]]()
    monkeypatch.setattr(task_work, "time", SimpleNamespace(perf_counter=lambda: now[0]))

    def work(part: int) -> dict[str, Any]:
        now[0] += 0.02
        kept.append(task_work.give_back(["task"], 0.5))
        return {}

    task_work.work_parts("task", work, range(7), None, 100.0)
    assert kept == [{"task": 4}] * 4, "six parts of 20 ms are worth it, three are not"


def test_a_worker_that_has_nothing_to_do_gets_parts_of_others(client: Any, tmp_path: Path) -> None:
    """The first part ends once three quarters are done: without help its task would wait for its own parts."""
    job = Patient(40, str(tmp_path), 30)
    np.testing.assert_array_equal(scale.run(job, scheduler=client, progress=False), np.arange(40))
    assert len(list(tmp_path.iterdir())) == 40, "each part was done once"


def test_parts_that_a_task_left_are_done_by_others(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A task ends after the part in which its time is over."""
    monkeypatch.setattr(task_sizes, "_LONGEST", 0.1)
    job, seen = Sums(30, seconds=0.06), list[int]()
    got = scale.run(job, scheduler=client, progress=lambda progress: seen.append(progress.done))
    np.testing.assert_array_equal(got, _expected(30))
    assert seen == sorted(seen) and len(seen) > 10


def test_workers_have_one_thread_for_linear_algebra() -> None:
    environment = worker_environment()
    assert environment["OPENBLAS_NUM_THREADS"] == environment["OMP_NUM_THREADS"] == 1
    assert environment["MALLOC_TRIM_THRESHOLD_"] == 2**28


def test_killed_workers_and_passing_faults(client: Any, tmp_path: Path) -> None:
    trouble = ((3, "kill"), (5, "raise"), (9, "kill"))
    got = scale.run(Sums(12, str(tmp_path), trouble), scheduler=client, progress=False)
    np.testing.assert_array_equal(got, _expected(12))
    assert len(list(tmp_path.iterdir())) == 3


def test_a_full_disk_stops_the_job_which_then_continues(client: Any, tmp_path: Path) -> None:
    job = Sums(12, str(tmp_path), ((6, "full"),))
    to = tmp_path / "sums.npy"
    with pytest.raises(
        JobStopped, match=r"cannot write: .*No space left.* of 12 parts are in .*run the same job again"
    ):
        scale.run(job, to, scheduler=client, progress=False)
    assert not to.exists()
    (tmp_path / "room").touch()
    seen: list[scale.Progress] = []
    got = scale.run(job, to, scheduler=client, progress=seen.append)
    np.testing.assert_array_equal(got, _expected(12))
    np.testing.assert_array_equal(np.load(to), got)
    assert not (tmp_path / "sums.npy.job").exists()
    np.testing.assert_array_equal(scale.run(job, to, workers=0), got)  # it is there: nothing is done again


def test_a_state_that_cannot_be_written_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    to = tmp_path / "sums.npy"
    with monkeypatch.context() as patch:
        patch.setattr(np, "savez", _no_space)
        with pytest.raises(JobStopped, match=r"Nothing can be written: .*No space left.* 0 of 5 parts"):
            scale.run(Sums(5), to, workers=0, progress=False)
    np.testing.assert_array_equal(scale.run(Sums(5), to, workers=0, progress=False), _expected(5))


def _no_space(*_: Any, **__: Any) -> None:
    raise OSError(28, "No space left on device")


def test_a_job_that_writes_no_result_keeps_its_parts(tmp_path: Path) -> None:
    to = tmp_path / "mean.npy"
    with pytest.raises(
        InputError, match=r"Drawn\.finish wrote nothing to .*mean\.npy.* expected the result there"
    ):
        scale.run(Drawn(scale.Samples(100, 10, 0)), to, workers=0, progress=False)
    assert (tmp_path / "mean.npy.job" / "state.npz").exists()


def test_a_job_does_not_go_on_with_another_seed(tmp_path: Path) -> None:
    to = tmp_path / "mean.npy"

    def stop(progress: scale.Progress) -> None:
        if progress.done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        scale.run(Drawn(scale.Samples(100, 10, 0)), to, workers=0, progress=stop)
    for samples in (scale.Samples(100, 10, 5), scale.Samples(100, 20, 0)):
        with pytest.raises(InputError, match="seed|chunk"):
            scale.run(Drawn(samples), to, workers=0, progress=False)


class _Written(Drawn):
    """A mean in a file without an ending, which holds nothing but the number."""

    def finish(self, state: Any, to: Path | None) -> Any:
        mean = super().finish(state, to)
        if to is not None:
            with to.open("wb") as file:
                np.save(file, mean)
        return mean


def test_a_result_is_returned_to_the_same_job_only(tmp_path: Path) -> None:
    to, job = tmp_path / "mean", _Written(scale.Samples(100, 10, 0))
    got = scale.run(job, to, workers=0, progress=False)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mean", "mean.job.json"]
    assert scale.run(job, to, workers=0, progress=False) == got
    for other, difference in (((100, 10, 5), "seed is 0, here it is 5"), ((90, 10, 0), "count is 100, here")):
        with pytest.raises(InputError, match=f"holds another job: its {difference}.*Give `to` another name"):
            scale.run(_Written(scale.Samples(*other)), to, workers=0, progress=False)
    for content in ("[]", "damaged"):
        (tmp_path / "mean.job.json").write_text(content)
        with pytest.raises(
            InputError, match=r"mean.job.json', which names its job, is absent or damaged.* remove"
        ):
            scale.run(job, to, workers=0, progress=False)
    (tmp_path / "mean.job.json").unlink()
    with pytest.raises(InputError, match=r"mean' exists, but .*mean.job.json'.* is absent"):
        scale.run(job, to, workers=0, progress=False)


def test_results_that_hold_their_description_need_no_file_beside_them(tmp_path: Path) -> None:
    pytest.importorskip("zarr")
    options: dict[str, Any] = {"voxel": 0.2, "to": tmp_path / "reach.zarr", "workers": 0, "progress": False}
    scale.reach("ur5", 1_000, **options)
    assert [path.name for path in tmp_path.iterdir()] == ["reach.zarr"]
    with pytest.raises(InputError, match="samples is 1000, here it is 2000"):
        scale.reach("ur5", 2_000, **options)


def test_ctrl_c_keeps_what_is_done(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    to = tmp_path / "sums.npy"

    def stop(progress: scale.Progress) -> None:
        if progress.done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        scale.run(Sums(9), to, workers=0, progress=stop)
    assert "Stopped by Ctrl-C. 4 of 9 parts are in" in capsys.readouterr().err
    seen: list[scale.Progress] = []
    np.testing.assert_array_equal(scale.run(Sums(9), to, workers=0, progress=seen.append), _expected(9))
    assert [p.done for p in seen] == [4, 5, 6, 7, 8, 9]


def test_parts_that_wait_for_those_before_them_are_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The first part comes last, as where its worker was lost: a job that stopped said "0 of 9 parts", and began anew."""
    to, done = tmp_path / "sums.npy", list[int]()

    def backwards(job: Sums, parts: Any, *_: Any) -> Any:
        for part in sorted(parts, reverse=True):
            done.append(part)
            yield part, job.work(part)

    def stop(progress: scale.Progress) -> None:
        if progress.done == 4:
            raise KeyboardInterrupt

    monkeypatch.setattr(engine, "_results", backwards)
    with pytest.raises(KeyboardInterrupt):
        scale.run(Sums(9), to, progress=stop)
    assert "Stopped by Ctrl-C. 4 of 9 parts are in" in capsys.readouterr().err
    with pytest.raises(InputError, match="holds another job"):
        scale.run(Sums(10), to, progress=False)
    seen: list[scale.Progress] = []
    np.testing.assert_array_equal(scale.run(Sums(9), to, progress=seen.append), _expected_in_order(9))
    assert done == [*range(8, -1, -1)] and [p.done for p in seen] == [4, 5, 6, 7, 8, 9]
    assert [p.here for p in seen] == [0, 1, 2, 3, 4, 5]


def test_another_job_in_the_store_is_not_continued(tmp_path: Path) -> None:
    to = tmp_path / "sums.npy"

    def stop(progress: scale.Progress) -> None:
        if progress.done == 2:
            raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        scale.run(Sums(9), to, workers=0, progress=stop)
    with pytest.raises(
        InputError, match="holds another job: its count is 9, here it is 10.* remove '.*sums.npy.job'"
    ):
        scale.run(Sums(10), to, workers=0, progress=False)
    for name in ("state.npz", "job.json"):
        (tmp_path / "sums.npy.job" / name).write_bytes(b"PK damaged")
        with pytest.raises(InputError, match=f"{name}' is damaged .*; remove '.*sums.npy.job' to begin anew"):
            scale.run(Sums(9), to, workers=0, progress=False)


def test_a_store_without_any_part_is_that_of_the_next_job(tmp_path: Path) -> None:
    to = tmp_path / "sums.npy"
    with pytest.raises(InputError, match="No scheduler answers"):
        scale.run(Sums(9), to, scheduler="nonsense", progress=False)
    assert (tmp_path / "sums.npy.job").exists()
    np.testing.assert_array_equal(scale.run(Sums(10), to, workers=0, progress=False), _expected(10))


def test_two_processes_do_not_share_a_store(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    to = tmp_path / "sums.npy"

    def again(progress: scale.Progress) -> None:
        with pytest.raises(InputError, match="Another process works on"):
            scale.run(Sums(3), to, workers=0, progress=False)

    scale.run(Sums(3), to, workers=0, progress=again)


def test_wrong_arguments() -> None:
    with pytest.raises(InputError, match=r"No scheduler answers at 'tcp://127.0.0.1:1'"):
        scale.run(Sums(3), scheduler="tcp://127.0.0.1:1", progress=False, patience=0.5)
    with pytest.raises(InputError, match="`workers` is given beside `scheduler`"):
        scale.run(Sums(3), scheduler="tcp://127.0.0.1:1", workers=2)
    with pytest.raises(InputError, match="`workers` is -1"):
        scale.run(Sums(3), workers=-1)
    with pytest.raises(InputError, match="`scheduler` is 3; expected an address"):
        scale.run(Sums(3), scheduler=3, progress=False)
    for to in ("", 5):
        with pytest.raises(InputError, match=f"`to` is {to!r}; expected a path"):
            scale.run(Sums(3), to, workers=0)  # pyright: ignore[reportArgumentType]


def test_a_result_in_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "sums.npy.job").touch()
    for to in ("file/sums.npy", "sums.npy"):
        with pytest.raises(InputError, match=r"sums.npy.job' cannot be made: there is a file"):
            scale.run(Sums(3), tmp_path / to, workers=0, progress=False)


@pytest.mark.parametrize(
    ("greeting", "reason"),
    [
        (b"HTTP/1.1 400 Bad Request\r\n\r\n" * 9, "another kind"),
        (b"", "Timed out"),
        (bytes(64), "another kind"),
        (struct.pack("<QQQ", 17, 1, 1) + b"\x05", "another kind"),
        (struct.pack("<QQQ", 32, 1, 8) + b"\xc1" * 64, "another kind"),
    ],
)
def test_servers_that_are_no_schedulers_are_said(
    greeting: bytes, reason: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """A dashboard's address given by mistake; and one that never says anything, which must not hang."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            with contextlib.suppress(OSError):
                while True:
                    taken.append(server.accept()[0])
                    taken[-1].sendall(greeting)

        taken: list[socket.socket] = []
        threading.Thread(target=answer, daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(InputError, match=f"No scheduler answers at '{address}' .*{reason}"):
            scale.run(Sums(3), scheduler=address, progress=False, patience=0.5)
        for connection in taken:
            connection.close()
    assert "Traceback" not in capfd.readouterr().err


def test_an_encrypted_address_asks_for_a_client() -> None:
    with pytest.raises(InputError, match=r"No scheduler answers at 'tls://127.0.0.1:9' .*security="):
        scale.run(Sums(3), scheduler="tls://127.0.0.1:9", progress=False, patience=0.5)


def test_settings_are_restored_where_contexts_overlap() -> None:
    """As of two jobs in threads, of which the one that began first ends first."""
    logger = logging.getLogger("distributed.client")
    level = logger.level
    first, second = _WITHOUT_MESSAGES(), _WITHOUT_MESSAGES()
    first.__enter__()
    second.__enter__()
    first.__exit__(None, None, None)
    assert logger.level > logging.CRITICAL
    second.__exit__(None, None, None)
    assert logger.level == level


def test_a_scheduler_without_workers_is_said(tmp_path: Path) -> None:
    from distributed import Client, LocalCluster

    settings: Any = {"n_workers": 0, "processes": False, "dashboard_address": ":0", "silence_logs": 50}
    with LocalCluster(**settings) as local, Client(local) as alone:
        message = r"no workers, after 0.1 s: `dask worker .*` starts one. 0 of 3 parts are in"
        with pytest.raises(JobStopped, match=message):
            scale.run(Sums(3), tmp_path / "s.npy", scheduler=alone, progress=False, patience=0.1)


def _pretend(version: str) -> None:
    from ulna import version as module

    module.__version__ = version


def test_workers_of_another_version_are_refused_before_anything_starts(client: Any) -> None:
    from ulna import __version__

    client.run(_pretend, "0.0.1")
    try:
        with pytest.raises(VersionMismatch, match="made with Ulna .* has Ulna 0.0.1"):
            scale.run(Sums(3), scheduler=client, progress=False)
    finally:
        client.run(_pretend, __version__)


def test_a_lost_scheduler_is_said_and_the_job_continues(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    to, said = tmp_path / "sums.npy", list[str]()
    monkeypatch.setattr(task_sizes, "_LONGEST", 0.2)  # else one task would have all parts
    for name in ("client", "batched"):
        logger = logging.getLogger(f"distributed.{name}")
        monkeypatch.setattr(logger, "handle", lambda record: said.append(record.getMessage()))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[2]), *sys.path])}

    def start(*words: str) -> Any:
        command = [sys.executable, "-m", "distributed.cli." + words[0], *words[1:]]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.Popen(command, env=environment, cwd=tmp_path, **quiet)

    file = tmp_path / "scheduler.json"
    running = [
        start("dask_scheduler", "--port", "0", "--dashboard-address", ":0", "--scheduler-file", str(file))
    ]
    try:
        running.append(
            start(
                "dask_worker",
                "--scheduler-file",
                str(file),
                "--no-nanny",
                "--nthreads",
                "1",
                "--no-dashboard",
            )
        )
        address = _address(file)

        def lose(progress: scale.Progress) -> None:
            if progress.done == 1:
                running[0].send_signal(signal.SIGKILL)

        with pytest.raises(JobStopped, match=r"scheduler does not answer any more. \d+ of 30 parts are in"):
            scale.run(Sums(30, seconds=0.05), to, scheduler=address, progress=lose, patience=1.0)
    finally:
        for process in reversed(running):
            process.kill()
            process.wait()
    assert not said, "the job says it"
    got = scale.run(Sums(30), to, workers=0, progress=False)
    np.testing.assert_array_equal(got, _expected(30))


def _address(file: Path) -> str:
    import json

    for _ in range(6000):
        if file.exists():
            try:
                return json.loads(file.read_text())["address"]
            except ValueError:
                pass
        time.sleep(0.1)
    raise AssertionError("the scheduler did not start")


@pytest.mark.slow
def test_twenty_kills_in_one_job_leave_no_trace(tmp_path: Path) -> None:
    """Workers are killed one after the other, at any time; the bits are those of an undisturbed run."""
    with cluster(2) as client:
        client.run(_find_tests)
        kills, over = [0], threading.Event()

        def kill() -> None:
            rng = np.random.default_rng(0)
            while kills[0] < 20 and not over.wait(0.8):
                pids = [nanny.pid for nanny in client.cluster.workers.values() if nanny.pid]
                if pids:
                    os.kill(int(rng.choice(pids)), signal.SIGKILL)
                    kills[0] += 1

        killer = threading.Thread(target=kill, daemon=True)
        killer.start()
        try:
            got = scale.run(Sums(400, seconds=0.05), tmp_path / "sums.npy", scheduler=client, progress=False)
        finally:
            over.set()
            killer.join(600.0)
    np.testing.assert_array_equal(got, _expected(400))
    assert kills[0] >= 5


@pytest.mark.slow
def test_a_script_without_the_main_guard_gets_a_hint(tmp_path: Path) -> None:
    script = tmp_path / "job.py"
    script.write_text(
        'from ulna import scale\nprint(scale.reach("panda", samples=1000, voxel=0.2, workers=1))\n'
    )
    result = subprocess.run(
        [sys.executable, str(script)], check=False, capture_output=True, text=True, timeout=300
    )
    assert result.returncode == 1
    assert result.stderr.rstrip().endswith("`workers=0` needs none.") and "__main__" in result.stderr
