"""A real Chromium for the tests of the page; tests that lack a program or package are skipped and say why. Ctrl-C reaches every test.

While tests are collected, no garbage is, and what is there then is never looked at: two million objects of modules and tests all stay.
"""

from __future__ import annotations

import contextlib
import gc
import os
import shutil
import signal
from collections import Counter
from collections.abc import Generator, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from support.missing_packages import missing_package

with contextlib.suppress(ImportError):
    from hypothesis import HealthCheck, settings

    # The same examples each time, however busy the machine is and whatever earlier runs have found.
    settings.register_profile(
        "ulna", deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck)
    )
    settings.load_profile("ulna")

# A shell starts background jobs with SIGINT ignored, and child processes inherit that: tests of interruption would fail.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_THRESHOLDS: pytest.StashKey[tuple[int, int, int]] = pytest.StashKey()
_BROWSER: pytest.StashKey[Chromium] = pytest.StashKey()
_FAILED_STARTS: pytest.StashKey[Counter[Path]] = pytest.StashKey()
_MOST_STARTS = 3
"""After so many pages of a file that did not start, its other tests fail at once: each would wait for `_LONGEST` again, three times."""
_LONGEST = 100_000
"""How long an operation of the browser may take [ms]."""
_OPTIMISE = os.environ.get("ULNA_OPTIMISE")
_QUICKLY_COMPILED = ("tests/compat/",)
_FEWER_FRAMES = """(() => {
  const draw = window.requestAnimationFrame.bind(window), waiting = new Map();
  let last = 0, number = 0, asked = false;
  const frame = time => {
    asked = false; last = performance.now();
    const now = [...waiting.keys()];
    for (const k of now) { const call = waiting.get(k); if (waiting.delete(k)) call(time); }
  };
  window.requestAnimationFrame = call => {
    waiting.set(++number, call);
    if (!asked) { asked = true; setTimeout(() => draw(frame), Math.max(0, 66 - (performance.now() - last))); }
    return number;
  };
  window.cancelAnimationFrame = k => { waiting.delete(k); };
})()"""
"""Pages draw 15 times a second and not 60: the processor draws, and each frame takes it some milliseconds."""


def pytest_collection(session: pytest.Session) -> None:
    # not `gc.disable`: `dask.array` remembers whether it was off when imported, and would leave it off later
    session.stash[_THRESHOLDS] = gc.get_threshold()
    gc.set_threshold(0)


def pytest_collection_finish(session: pytest.Session) -> None:
    gc.freeze()
    gc.set_threshold(*session.stash[_THRESHOLDS])


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Tests in a browser are tried twice more: Chromium, which draws with the processor here, fails now and then by itself.

    Raises:
        pytest.UsageError: A slow test is in a file that `.ci/run` would not find, or a test has an address in its name.
    """
    changing = [item.nodeid for item in items if " at 0x" in item.nodeid]
    if changing:
        raise pytest.UsageError(
            f"Several processes can share tests only if their names are the same in each; change `ids`: {changing}"
        )
    hidden = {item.path for item in items if item.get_closest_marker("slow") and not _says_slow(item.path)}
    if hidden:
        raise pytest.UsageError(
            f"`.ci/run` finds slow tests by the words `mark.slow`, which these files lack: {hidden}"
        )
    if config.pluginmanager.hasplugin("rerunfailures"):
        for item in items:
            if item.get_closest_marker("browser"):
                item.add_marker(pytest.mark.flaky(reruns=2))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    _choose_how_kernels_are_compiled(item)
    if item.session.stash.get(_FAILED_STARTS, Counter())[item.path] >= _MOST_STARTS:
        pytest.fail(
            f"{_MOST_STARTS} times a page of this file did not start; see the errors before", pytrace=False
        )


def _choose_how_kernels_are_compiled(item: pytest.Item) -> None:
    """Quickly where kernels are not what is tested, in this process and its children, unless the caller chose himself.

    Laws, oracles, golden files and the compiler's tests have the kernels that users have, and so has every slow sweep.
    """
    if _OPTIMISE is not None:
        return
    os.environ.pop("ULNA_OPTIMISE", None)
    if item.nodeid.startswith(_QUICKLY_COMPILED) and not item.get_closest_marker("slow"):
        os.environ["ULNA_OPTIMISE"] = "0"


@cache
def _says_slow(path: Path) -> bool:
    return "mark.slow" in path.read_text(encoding="utf-8")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, None, None]:
    """Tabs that a test opens are closed after it, also where it fails: pages left open connect to later scripts on their port."""
    browser = getattr(item, "funcargs", {}).get("chromium")
    if browser is None:
        return (yield)
    before = len(browser.contexts)
    try:
        return (yield)
    finally:
        browser.close_contexts(before)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """A test that needs an optional package which is not installed is skipped; with ULNA_ENVIRONMENT=complete it fails."""
    report = yield
    package = missing_package(call.excinfo.value) if call.excinfo is not None else ""
    if report.failed and package and os.environ.get("ULNA_ENVIRONMENT") != "complete":
        path, line, _ = item.location
        report.outcome = "skipped"
        report.longrepr = (path, (line or 0) + 1, f"Skipped: the package {package!r} is not installed")
    browser = item.session.stash.get(_BROWSER, None)
    if browser is not None and report.failed and report.when == "setup":
        browser.close()  # a page did not start; in the same browser the next ones would not either
        item.session.stash.setdefault(_FAILED_STARTS, Counter())[item.path] += 1
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Why tests were tried again: pytest shows the errors of last attempts only."""
    for report in terminalreporter.stats.get("rerun", ()):
        terminalreporter.section(f"tried again: {report.nodeid} ({report.when})")
        terminalreporter.line(report.longreprtext)


@pytest.fixture(scope="session")
def chromium(request: pytest.FixtureRequest) -> Iterator[Chromium]:
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="playwright, which drives the browser, is not installed"
    )
    pytest.importorskip("viser", reason="viser, which serves the page, is not installed")
    program = next((path for name in NAMES if (path := shutil.which(name))), None)
    if program is None:
        pytest.skip(f"no Chromium on PATH (looked for {', '.join(NAMES)})")
    with playwright.sync_playwright() as driver:
        browser = request.session.stash[_BROWSER] = Chromium(driver, program)
        yield browser
        browser.close()


class Chromium:
    """A browser that waits long on a busy machine, and is started again where it has crashed.

    Args:
        driver: Playwright's.
        program: Where Chromium is.
    """

    def __init__(self, driver: Any, program: str) -> None:
        self._driver, self._program, self._browser = driver, program, None
        self.contexts: list[Any] = []

    def new_context(self, *, every_frame: bool = False, **options: Any) -> Any:
        """A context whose operations may take minutes, with all frames or fewer; `options` are Playwright's."""
        if self._browser is None or not self._browser.is_connected():
            self._browser = self._driver.chromium.launch(
                executable_path=self._program, timeout=_LONGEST,
                args=["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"],
            )  # fmt: skip
        context = self._browser.new_context(**options)
        context.set_default_timeout(_LONGEST)
        if not every_frame:
            context.add_init_script(_FEWER_FRAMES)
        self.contexts.append(context)
        return context

    def new_page(self, **options: Any) -> Any:
        """A page in a separate context."""
        return self.new_context(**options).new_page()

    def close_contexts(self, first: int) -> None:
        """Close the contexts that were opened from the one of number `first` on."""
        for context in self.contexts[first:]:
            with contextlib.suppress(Exception):  # closed already, or its browser has crashed
                context.close()
        del self.contexts[first:]

    def close(self) -> None:
        """End the browser; the next context starts another one."""
        if self._browser is not None:
            with contextlib.suppress(Exception):  # it has crashed
                self._browser.close()
        self._browser = None
        self.contexts.clear()
