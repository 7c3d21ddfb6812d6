"""What the viewer costs: a user's step, the page's thread, and how soon things are seen in a real browser.

    python benchmarks/viewer.py              # needs viser; without a browser the first table only
    python benchmarks/viewer.py --soak 1e6   # steps, and the memory they take: of this process, and of a tab

Peer: viser itself, a frame for each link whose position and rotation are set, in the same run. The browser is a headless
Chromium that draws by the processor, if playwright and a Chromium are there; frames a second are far below a graphics
card's.
"""

from __future__ import annotations

import argparse
import gc
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from _first_sight import first_sight, free_port
from _timing import medians, shown, table

import ulna
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.robot.target_following import TargetFollower
from ulna.viewer.viewer import Viewer

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def steps(robot: ulna.Robot) -> None:
    """The user's step: hand over configurations, while the thread of an open page publishes them."""
    q, rows = np.array(robot.configurations["qr"]), []
    for count in (1, 20):
        with Viewer(port=0, browser=False) as viewer:
            arms = [viewer.add(robot, q) for _ in range(count)]

            def forward(count: int = count) -> None:
                for _ in range(count):
                    robot.link_poses(q)

            def hand_over(arms: list[Any] = arms) -> None:
                for arm in arms:
                    arm.q = q

            fk, ours = medians([forward, hand_over])
            sim = viewer.simulate(realtime=False, record=False)
            (whole,) = medians([lambda sim=sim: sim.step(1e-6)])
            crowd, many = viewer.fleet(robot, np.tile(q, (count, 1))), np.tile(q, (count, 1))

            def hand_over_fleet(crowd: Any = crowd, many: Any = many) -> None:
                crowd.q = many

            (fleet,) = medians([hand_over_fleet])
        peer = plain_viser(robot, q, count)
        rows.append(
            [
                str(count),
                shown(fk),
                shown(ours),
                shown(fleet),
                shown(whole),
                shown(peer),
                f"{peer / ours:.0f}",
            ]
        )
    head = [
        "robots",
        "FK of all links",
        "hand over q",
        "as a fleet",
        "a step of a Simulation",
        "viser: set each link",
        "viser / ours",
    ]
    print(table("A user's step", head, rows))


def meshes() -> None:
    """A Panda's CAD meshes: read by parsing its files, read again, and how much of them is shown."""
    with tempfile.TemporaryDirectory() as folder:
        for what in ("the first time", "later"):
            program = (
                "import time, ulna; from ulna.viewer.robot.link_surfaces import surfaces_by_link; robot = ulna.load('panda')\n"
                "for detail in ('seen', 'full'):\n"
                "    began = time.perf_counter(); looks = surfaces_by_link(robot, 'visual', detail=detail)\n"
                "    spent = time.perf_counter() - began\n"
                "    print(detail, sum(len(s.triangles) for look in looks for s in look), f'{spent:.2f} s')"
            )
            told = subprocess.run(
                [sys.executable, "-c", program],
                env=os.environ | {"ULNA_CACHE": folder},
                capture_output=True,
                text=True,
                check=True,
            ).stdout
            print(f"a Panda's CAD meshes, {what}: " + "; ".join(told.splitlines()))


def dragging(robot: ulna.Robot, count: int = 500) -> None:
    """One step after a dragged target, within reach and at the edge of it."""
    for what, reach in (("within reach", 0.15), ("at its edge", 0.9)):
        q, follower, spent = np.array(robot.configurations["qr"]), TargetFollower(robot), []
        middle = robot.fk(q)
        for t in np.linspace(0.0, 4 * np.pi, count):
            goal = middle.copy()
            goal[:3, 3] += reach * np.array([np.sin(t), 1 - np.cos(t), 0.5 * np.sin(2 * t)])
            began = time.perf_counter()
            q = follower.step(q, goal).q
            spent.append(time.perf_counter() - began)
        print(
            f"a step after a dragged target {what}: {shown(float(np.median(spent)))}, "
            f"95 of 100 within {shown(float(np.quantile(spent, 0.95)))}"
        )


def plain_viser(robot: ulna.Robot, q: np.ndarray, count: int) -> float:
    """The same robots by viser's public interface: a handle for each link."""
    from ulna.viewer.page.poses import pose_rows
    from ulna.viewer.page.server import serve, stop

    server = serve("127.0.0.1", 0, "peer")
    try:
        links = len(robot.link_names)
        handles = [
            server.scene.add_frame(f"/{r}/{k}", show_axes=False) for r in range(count) for k in range(links)
        ]
        rng = np.random.default_rng(0)

        def step() -> None:
            rows = pose_rows(robot.link_poses(q + 0.1 * rng.random(7)))
            for k, handle in enumerate(handles):
                handle.position, handle.wxyz = rows[k % links, :3], rows[k % links, 3:]

        return medians([step], 5, 0.2)[0]
    finally:
        stop(server)


def publisher(robot: ulna.Robot, count: int = 20, seconds: float = 5.0) -> None:
    """The share of a core that the process takes while robots move at 60 Hz and nobody slows it down."""
    with Viewer(port=0, browser=False) as viewer:
        arms = [viewer.add(robot, "qr") for _ in range(count)]
        q, due = np.array(robot.configurations["qr"]), time.monotonic()
        time.sleep(1.0)
        began, used = time.monotonic(), time.process_time()
        while time.monotonic() - began < seconds:
            q[0] = np.sin(time.monotonic())
            for arm in arms:
                arm.q = q
            due = max(due + 1 / 60, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))
        share = (time.process_time() - used) / (time.monotonic() - began)
    print(f"{count} robots of {len(robot.link_names)} links moved 60 times a second: {share:.1%} of a core")


@contextmanager
def chromium() -> Iterator[Any]:
    """A headless Chromium that draws by the processor; None where there is none."""
    program = next((p for n in BROWSERS if (p := shutil.which(n))), None)
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        program = None
    if program is None:
        print("\nno playwright or no Chromium: nothing is measured in a browser")
        yield None
        return
    with sync_playwright() as driver:
        driven = driver.chromium.launch(executable_path=program, args=FLAGS)
        yield driven
        driven.close()


@contextmanager
def profile(driven: Any) -> Iterator[Any]:
    """Such a browser that keeps on disk what it fetched and compiled, as people's browsers do."""
    program = next(p for n in BROWSERS if (p := shutil.which(n)))
    with tempfile.TemporaryDirectory() as folder:
        context = driven.browser_type.launch_persistent_context(
            folder, executable_path=program, args=FLAGS, viewport={"width": 640, "height": 400}
        )
        yield context
        context.close()


def browser(driven: Any) -> None:
    """How soon things are seen, and how many of the frames sent are drawn."""
    million = (
        f"import sys; sys.path.insert(0, {os.path.dirname(__file__)!r})\n"
        "from viewer import grid_surface; viewer.add(grid_surface(708), name='{name}')"
    )
    cases = {
        "Panda, CAD meshes read before": (
            'viewer.add(ulna.load("panda"), "qr", name="{name}")',
            sum(bool(link.visuals) for link in ulna.load("panda").model.links),
        ),
        "10,000 boxes in one": (
            "viewer.copies(ulna.geometry.Box((0.02, 0.02, 0.02)), name='{name}', "
            "positions=np.random.default_rng(0).uniform(-1, 1, (10_000, 3)))",
            1,
        ),
        "a mesh of a million triangles": (million, 1),
    }
    rows, port = [], free_port()
    with profile(driven) as context:
        for k, (what, (body, count)) in enumerate(cases.items()):
            # a browser keeps what it compiled of a page at the second visit
            new = first_sight(context, port, body, count, False, before=1 if k else 3)
            back = first_sight(context, port, body, count, True)
            rows.append([what, shown(new[0]), shown(back[0])])
            if new[0] != new[1]:
                rows.append(["each of its triangles, once nothing moves", shown(new[1]), shown(back[1])])
    load = f"{os.getloadavg()[0]:.1f} programs ran on {os.cpu_count()} cores"
    print(
        table("From the start of a script to its first frame", [load, "a new tab", "a tab comes back"], rows)
    )
    applied(driven)


COUNT = """seconds => new Promise(done => {
    const node = window.__viserMutable.nodeRefFromName["/box"], seen = new Set(), end = performance.now() + 1e3 * seconds;
    const look = () => { seen.add(node.position.x);
        performance.now() < end ? requestAnimationFrame(look) : done(seen.size / seconds); };
    look(); })"""


def applied(driven: Any, count: int = 220) -> None:
    """Distinct poses that frames of the browser show, while boxes without lights or floor move at 60 Hz."""
    with Viewer(port=0, browser=False) as viewer:
        boxes = [viewer.box((0.05, 0.05, 0.05), name=f"boxes/{k}") for k in range(count)]
        box = viewer.box((0.1, 0.1, 0.1), name="box")
        places = np.tile(np.eye(4), (count, 1, 1))
        places[:, 1, 3], places[:, 2, 3] = np.linspace(-1, 1, count), 0.5
        rows = viewer.scene.rows([b.name for b in boxes])

        def tick() -> None:
            places[:, 0, 3] = np.sin(time.monotonic())
            viewer.scene.set_poses(places, rows)
            box.position = (time.monotonic() % 100.0, 0.0, 0.0)

        page = viewer._page
        assert page is not None
        page.set_theme(page._theme, 0.0, grid=False)  # a floor would be laid anew when all is framed
        for name in ("key", "rim", "fill", "sky"):
            page.server.scene.remove_by_name(f"/(page)/{name}")
        page.server.scene.configure_environment_map(None)
        page.each_tick(tick)
        tab = driven.new_context(viewport={"width": 480, "height": 360}).new_page()
        tab.goto(f"{viewer.url}/?fixedDpr=1")
        tab.wait_for_function("() => !!window.__viserMutable?.nodeRefFromName['/box']", timeout=120_000)
        tab.wait_for_timeout(4000)
        print(f"\n{count} moving boxes: {tab.evaluate(COUNT, 5):.0f} distinct poses a second are drawn")
        tab.context.close()


def grid_surface(size: int) -> Surface:
    """A wavy sheet of 2 size^2 triangles."""
    x, y = np.meshgrid(np.linspace(-1, 1, size + 1), np.linspace(-1, 1, size + 1))
    vertices = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(7 * y) + 0.3], -1).reshape(-1, 3)
    i = (np.arange(size)[:, None] * (size + 1) + np.arange(size)).reshape(-1)
    triangles = np.concatenate(
        [np.stack([i, i + 1, i + size + 2], 1), np.stack([i, i + size + 2, i + size + 1], 1)]
    )
    return Surface(vertices, triangles, np.broadcast_to((0.0, 0.0, 1.0), vertices.shape))


def soak(robot: ulna.Robot, count: int) -> None:
    """Steps with a page open and a tab that looks at it, a trace and a plot; the memory of both, tenth by tenth."""
    with chromium() as driven, Viewer(port=0, browser=False) as viewer:
        arm = viewer.add(robot, "qr")
        arm.trace()
        plot = viewer.panel.plot("speed", ("v",))
        sim = viewer.simulate(realtime=False, record=False)
        arm.qd = 0.1 * np.ones(robot.nv)
        heap = tab_heap(driven, viewer) if driven is not None else lambda: float("nan")
        for part in range(10):
            began = time.perf_counter()
            for k in range(count // 10):
                if k % 1000 == 0:
                    arm.qd = -arm.qd
                sim.step(1e-3)
                if k % 100 == 0:
                    plot.add(sim.t, float(arm.qd[0]))
            rate = count // 10 / (time.perf_counter() - began)
            gc.collect()
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            print(
                f"{(part + 1) * count // 10:>9} steps  Python: peak {peak:7.1f} MiB  the tab: {heap():6.1f} MiB of objects"
                f"  {rate:9.0f} steps/s",
                flush=True,
            )


def tab_heap(driven: Any, viewer: Viewer) -> Callable[[], float]:
    """Open a tab; gives what its JavaScript holds after a collection [MiB]."""
    page = driven.new_context(viewport={"width": 480, "height": 360}).new_page()
    page.set_default_timeout(120_000)
    page.goto(f"{viewer.url}/?fixedDpr=1")
    page.wait_for_function("() => !!window.__viserMutable?.nodeRefFromName['/panda/panda_hand']")
    devtools = page.context.new_cdp_session(page)

    def used() -> float:
        devtools.send("HeapProfiler.collectGarbage")
        return devtools.send("Runtime.getHeapUsage")["usedSize"] / 2**20

    return used


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--soak", type=float, metavar="STEPS", help="only count memory over so many steps")
    chosen = parser.parse_args()
    robot = ulna.load("panda", visuals="simple")
    if chosen.soak:
        soak(robot, int(chosen.soak))
        return
    steps(robot)
    dragging(robot)
    meshes()
    publisher(robot)
    with chromium() as driven:
        if driven is not None:
            browser(driven)


if __name__ == "__main__":
    sys.exit(main())
