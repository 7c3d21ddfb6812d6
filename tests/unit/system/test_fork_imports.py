"""Children forked while other threads import: they import the same modules, and never hang."""

from __future__ import annotations

import os
import textwrap

import pytest

from support.fork_scripts import run_script

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")

_MODULES = """
import pathlib, tempfile
folder = tempfile.TemporaryDirectory()
sys.path.insert(0, folder.name)

def module(name, text):
    pathlib.Path(folder.name, name + ".py").write_text(text)
"""


def _run(text: str) -> None:
    run_script(_MODULES + textwrap.dedent(text))


def test_a_child_imports_what_another_thread_was_importing():
    _run(
        """
        module("inner", "import time; time.sleep(0.4); value = 3")
        module("outer", "import time; time.sleep(0.1); import inner; value = inner.value + 1")
        def use():
            import outer
            assert outer.value == 4
        thread = threading.Thread(target=use)
        thread.start()
        time.sleep(0.05)
        statuses = [child(use), child(use)]
        thread.join()
        use()
        assert statuses == [0, 0], statuses
        """
    )


def test_a_child_of_a_module_that_is_being_imported():
    _run(
        """
        module("forking", "import __main__; status = __main__.child(__main__.work)")
        def work():
            import forking
            assert forking is sys.modules["forking"] and not hasattr(forking, "status")
            thread = threading.Thread(target=__import__, args=("colorsys",))
            thread.start()
            thread.join(300.0)
            assert "colorsys" in sys.modules
        import forking
        assert forking.status == 0, forking.status
        """
    )


def test_an_import_that_does_not_end_is_waited_for_once():
    _run(
        """
        forks.IMPORT_WAIT = 0.2
        module("endless", "value = 3; import __main__; __main__.entered.set(); __main__.leave.wait(); after = 4")
        entered, leave = threading.Event(), threading.Event()
        def use():
            import endless
            assert endless.value == 3 and not hasattr(endless, "after")
            import wave
        thread = threading.Thread(target=__import__, args=("endless",))
        thread.start()
        entered.wait()
        waits = []
        wait = forks._wait
        forks._wait = lambda *what: (waits.append(what[-1]), wait(*what))
        assert child(use) == 0
        assert waits == [forks._imports], waits
        assert child(use) == 0
        assert len(waits) == 1, waits
        leave.set()
        thread.join()
        import endless
        assert endless.after == 4
        """
    )


def test_threads_that_import_with_the_lock_of_logging_do_not_stop_a_fork():
    # as logging.config does; the hook of logging waits for its lock after ours has stopped all imports
    _run(
        """
        import logging
        for k in range(400):
            module(f"part{k}", "")
        done = threading.Event()
        def configure():
            for k in range(400):
                with logging._lock:
                    __import__(f"part{k}")
            done.set()
        thread = threading.Thread(target=configure)
        thread.start()
        statuses = [child(lambda: __import__("part399"))]
        while not done.is_set():
            statuses.append(child(lambda: __import__("part399")))
        thread.join()
        assert not any(statuses), statuses
        """
    )


@pytest.mark.slow
def test_first_uses_in_threads_while_the_program_forks():
    pytest.importorskip("viser")
    run_script(
        """
        import pathlib, tempfile
        folder = tempfile.TemporaryDirectory()
        file = pathlib.Path(folder.name, "corner.obj")
        file.write_text("v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv 0 0 1\\nf 1 3 2\\nf 1 2 4\\nf 2 3 4\\nf 3 1 4\\n")
        robot = ulna.load("ur5")
        def inverse():
            q = np.full(robot.nq, 0.3)
            assert robot.ik(robot.fk(q)).success
        def kernel():
            assert robot.kernel("mass_matrix")(np.zeros(6)).shape == (6, 6)
            fresh()
        def mesh():
            import ulna.geometry
            from ulna.viewer.mesh.mesh_files import load_mesh
            assert len(load_mesh(str(file))[0].triangles) == 4
        def viewer():
            from ulna.viewer.viewer import Viewer
            with Viewer(port=0) as made:
                made.add(robot, np.zeros(6))
        uses = (inverse, kernel, mesh, viewer)
        def all_of_them():
            for use in uses:
                use()
        threads = [threading.Thread(target=use) for use in uses]
        for thread in threads:
            thread.start()
        statuses = []
        while len(statuses) < 6:
            statuses.append(child(all_of_them))
        for thread in threads:
            thread.join()
        assert not any(statuses), statuses
        """
    )


@pytest.mark.slow
def test_pools_of_processes_beside_an_open_viewer():
    pytest.importorskip("viser")
    run_script(
        """
        import multiprocessing, urllib.request
        from concurrent.futures import ProcessPoolExecutor
        from ulna.viewer.viewer import Viewer
        robot = ulna.load("ur5")
        viewer = Viewer(port=0)
        handle = viewer.add(robot, np.zeros(6))
        busy = threading.Event()
        def move():
            while not busy.is_set():
                handle.q = np.random.uniform(-1, 1, 6)
        thread = threading.Thread(target=move, daemon=True)
        thread.start()
        def reached(k):
            handle.q = np.full(6, 0.1 * k)
            return robot.fk(handle.q)[0, 3]
        expected = [robot.fk(np.full(6, 0.1 * k))[0, 3] for k in range(4)]
        context = multiprocessing.get_context("fork")
        with context.Pool(2) as pool:
            assert pool.map_async(reached, range(4)).get(600) == expected
        with ProcessPoolExecutor(2, mp_context=context) as pool:
            assert list(pool.map(reached, range(4), timeout=600)) == expected
        one = context.Process(target=reached, args=(1,))  # ends as processes do, with exit functions
        one.start()
        one.join(600)
        assert one.exitcode == 0, one.exitcode
        busy.set()
        thread.join()
        assert urllib.request.urlopen(viewer.url, timeout=20).status == 200
        viewer.close()
        """
    )
