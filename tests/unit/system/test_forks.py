"""Children forked while other threads compile, draw and hold locks: they compile, load and draw, and never hang."""

from __future__ import annotations

import os
import threading

import pytest

from support.fork_scripts import run_script
from ulna.system import forks

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


def test_a_child_forked_during_a_compilation_compiles(tmp_path):
    out = run_script(
        """
        robot = ulna.load("ur5")
        known = robot.kernel("fk")
        q = np.zeros(6)
        T = known(q)
        going = threading.Event()
        def forever():
            n = 0
            while not going.is_set():
                n += 1
                heavy(n)
        thread = threading.Thread(target=forever, daemon=True)
        thread.start()
        def work():
            assert (known(q) == T).all()
            fresh()
            assert "panda" in [e.name for e in ulna.robots.catalogue.entries()]
            panda = ulna.load("panda")
            assert panda.fk(np.zeros(7)).shape == (4, 4)
            assert panda.fk(np.zeros((40, 7))).shape == (40, 4, 4)
        import ulna.robots.catalogue
        for k in range(4):
            time.sleep(0.1)
            status = child(work)
            assert status == 0, status
        going.set()
        thread.join()
        fresh()
        print("done")
        """,
        cache=str(tmp_path),
    )
    assert out == "done\n"


def test_multiprocessing_forks_during_compilations():
    run_script(
        """
        import multiprocessing
        going = threading.Event()
        def forever(seed):
            while not going.is_set():
                seed += 2
                heavy(seed)
        def thrice(k):
            return float(compile(lambda q: (3.0 + 0.0 * k) * q, q=())(float(k)))
        threads = [threading.Thread(target=forever, args=(k,), daemon=True) for k in range(2)]
        for thread in threads:
            thread.start()
        with multiprocessing.get_context("fork").Pool(2) as pool:
            assert pool.map_async(thrice, range(4)).get(600) == [3.0 * k for k in range(4)]
        going.set()
        for thread in threads:
            thread.join()
        """
    )


def test_a_fork_within_the_report_of_a_compilation():
    run_script(
        """
        from ulna.compiler.runtime import jit
        jit._ANNOUNCE_FROM = 0.0
        seen = []
        def watcher(what, how_long):
            if not seen:
                seen.append(None)
                seen[0] = child(fresh)
        jit.watchers.append(watcher)
        fresh()
        assert seen == [0], seen
        """
    )


def test_a_fork_while_inverse_kinematics_is_compiled_elsewhere():
    # Python 3.11 holds a lock in functools.cached_property
    run_script(
        """
        robots = [ulna.load("ur5"), ulna.load("panda")]
        def solve(robot):
            q = robot.configurations.get("qr", np.full(robot.nq, 0.3))
            assert robot.ik(robot.fk(q)).success
        thread = threading.Thread(target=solve, args=(robots[0],))
        thread.start()
        statuses = [child(lambda: solve(robots[1]))]
        while thread.is_alive():
            statuses.append(child(lambda: solve(robots[1])))
        thread.join()
        assert not any(statuses), statuses
        """
    )


def test_a_child_uses_what_the_viewer_had():
    pytest.importorskip("viser")
    run_script(
        """
        from ulna.viewer.viewer import Viewer
        robot = ulna.load("ur5")
        viewer = Viewer(port=0)
        handle = viewer.add(robot, np.zeros(6))
        slider = viewer.panel.slider("speed", 0.0, 1.0)
        busy = threading.Event()
        def move():
            while not busy.is_set():
                handle.q = np.random.uniform(-1, 1, 6)
        thread = threading.Thread(target=move, daemon=True)
        thread.start()
        import urllib.request
        def work():
            assert viewer.closed and viewer.clients == 0
            handle.q = np.ones(6)
            assert (handle.q == 1.0).all()
            viewer.sphere(0.1, name="ball")
            viewer.panel.button("press", lambda: None)
            slider.value = 0.5
            viewer.flush()
            viewer.close()
        for k in range(20):
            status = child(work)
            assert status == 0, status
        assert not viewer.closed
        busy.set()
        thread.join()
        handle.q = np.zeros(6)
        assert urllib.request.urlopen(viewer.url, timeout=20).status == 200
        viewer.close()
        """
    )


def test_a_lock_that_is_held_for_long_is_new_in_the_child():
    run_script(
        """
        forks.LONGEST_WAIT = 0.5
        lock = forks.lock()
        ready, leave = threading.Event(), threading.Event()
        def hold():
            with lock:
                ready.set()
                leave.wait()
        thread = threading.Thread(target=hold)
        thread.start()
        ready.wait()
        def work():
            assert lock.acquire(timeout=1.0)
        assert child(work) == 0
        assert not lock.acquire(blocking=False)  # in the parent the thread has it
        leave.set()
        thread.join()
        assert lock.acquire(timeout=1.0)
        """
    )


def test_locks_taken_in_any_order_do_not_stop_a_fork():
    run_script(
        """
        a, b = forks.lock(), forks.lock()
        end, over = time.monotonic() + 1.5, threading.Event()
        def use(first, second):
            while not over.is_set():
                with first:
                    with second:
                        pass
        # each thread takes a and b, and forks take them, too, in the order of their making
        threads = [threading.Thread(target=use, args=(b, a)) for _ in range(3)]
        for thread in threads:
            thread.start()
        def work():
            with a, b:
                pass
        count = 0
        while time.monotonic() < end or count < 5:
            assert child(work) == 0
            count += 1
        over.set()
        """
    )


def test_ctrl_c_while_a_fork_waits_comes_after_it():
    run_script(
        """
        import signal
        lock = forks.lock(forks.COMPILER)
        ready = threading.Event()
        def hold():
            with lock:
                ready.set()
                time.sleep(0.5)
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.5)
        try:
            threading.Thread(target=hold).start()
            ready.wait()
            status = child(lambda: lock.acquire(timeout=1.0) or os._exit(3))
            assert status == 0, status
            time.sleep(300.0)
        except KeyboardInterrupt:
            pass
        else:
            raise SystemExit("Ctrl-C was lost")
        with lock:
            pass
        """
    )


def test_locks_are_forgotten_with_their_owners():
    before = len(forks._locks)
    made = [forks.lock() for _ in range(100)]
    assert len(forks._locks) == before + 100
    del made
    assert len(forks._locks) == before


def test_a_lock_is_reentrant_and_free_after_a_fork_in_the_parent():
    lock = forks.lock()
    with lock:
        number = os.fork()
        if number == 0:
            os._exit(0 if lock._is_owned() else 1)  # type: ignore[attr-defined]
        assert os.waitstatus_to_exitcode(os.waitpid(number, 0)[1]) == 0
    taken: list[bool] = []
    thread = threading.Thread(target=lambda: taken.append(lock.acquire(timeout=5.0)))
    thread.start()
    thread.join()
    assert taken == [True]


@pytest.mark.slow
def test_children_read_mjcf_while_another_thread_does():
    pytest.importorskip("mujoco")
    run_script(
        """
        text = '<mujoco><worldbody><body><joint name="j" type="hinge"/><geom size="1"/></body></worldbody></mujoco>'
        def read():
            assert ulna.load(text).nq == 1
        read()
        going = threading.Event()
        def forever():
            while not going.is_set():
                read()
        thread = threading.Thread(target=forever)
        thread.start()
        statuses = [child(read) for _ in range(5)]
        going.set()
        thread.join()
        read()
        assert not any(statuses), statuses
        """
    )
