"""The trial of a mutant: a copy of the sources with it, a separate cache, and the tests that must notice it."""

from __future__ import annotations

import compileall
import contextlib
import hashlib
import os
import py_compile
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from mutation.mutant import Mutant

_OPTIONS = ("-q", "-x", "--tb=no", "-rfE", "-p", "no:cacheprovider")
_GONE = re.compile(r"^ERROR: (?:file or directory )?not found: (.+)$", re.MULTILINE)
# Their results are kept under keys that say nothing of this code: with these mutated, the kernel cache starts empty.
_CACHED = (
    "compiler/runtime/",
    "disk_cache.py",
    "system/",
    "collision/spheres.py",
    "viewer/mesh/",
    "client_files.py",
)


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant: `caught`, `survived`, `timed out` or `untested`, by which test, of how many, when.

    `caught` is confirmed once the test has passed without the mutant.
    """

    status: str
    test: str
    tests: int
    seconds: float
    confirmed: bool = True


class Sandbox:
    """A copy of the sources that mutants are put into, one after the other; the tests themselves stay where they are.

    A kernel cache is content-addressed, yet a mutant may damage it, so each gets a folder of hard links to the
    entries: an entry is never written to, only replaced, so the originals cannot change.

    Args:
        root: The repository.
        folder: Where the copy and the temporary folders are made.
        cache: The kernel cache that each run starts with; None for an empty one.
        secret: The file with the key of its seals, if there is one.
        unsound: Tests that fail without any mutant, which are left out.
        limit: How long a run of tests may take beyond the time expected [s].
    """

    def __init__(
        self,
        root: Path,
        folder: Path,
        cache: Path | None,
        secret: Path | None,
        unsound: set[str],
        limit: float,
    ) -> None:
        self._root, self._folder, self._cache, self._secret = root, folder, cache, secret
        self._sources, self._limit = folder / "src", limit
        self.unsound = unsound
        _copy_compiled(root / "src", self._sources, root / "out" / "mutation" / "compiled")
        self._environment = {
            **{
                name: text for name, text in os.environ.items() if not name.startswith(("COVERAGE", "PYTEST"))
            },
            "PYTHONPATH": str(self._sources),
            "PYTHONDONTWRITEBYTECODE": "1",
            "ULNA_CACHE": str(folder / "cache"),
            "XDG_STATE_HOME": str(folder / "state"),
            "TMPDIR": str(folder / "tmp"),
        }

    def run(self, mutant: Mutant | None, tests: list[str], expected: float) -> tuple[int | None, str]:
        """Runs tests up to the first failure, with a mutant or without.

        Returns:
            The exit status of pytest, None where the time ran out, and the test that failed, if one did. Tests that
            are gone since the map was built are left out.
        """
        status, output = self._pytest(mutant, tests, expected)
        gone = {name for test in _GONE.findall(output) for name in tests if test.endswith(name)}
        if gone:
            self.unsound.update(gone)
            left = [test for test in tests if test not in gone]
            return self.run(mutant, left, expected) if left else (0, "")
        failed = re.search(r"^(?:FAILED|ERROR) (\S+?\.py(?:::.*?)?)(?: - .*)?$", output, re.MULTILINE)
        return status, failed[1] if failed else ""

    def _pytest(self, mutant: Mutant | None, tests: list[str], expected: float) -> tuple[int | None, str]:
        """The exit status of pytest, None where the time ran out, and what it printed."""
        self._prepare(empty=mutant is not None and any(part in mutant.path for part in _CACHED))
        chosen = self._folder / "tests.txt"
        chosen.write_text("\n".join([*(f"--deselect={test}" for test in self.unsound), *tests]))
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-x",
            "--tb=no",
            "-rfE",
            "-p",
            "no:cacheprovider",
            f"@{chosen}",
        ]
        with self._mutated(mutant):
            process = subprocess.Popen(
                command, cwd=self._root, env=self._environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                text=True, errors="replace", start_new_session=True,
            )  # fmt: skip
            try:
                output, _ = process.communicate(timeout=self._limit + 3 * expected)
            except subprocess.TimeoutExpired:
                return None, ""
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        return process.returncode, output

    @contextlib.contextmanager
    def _mutated(self, mutant: Mutant | None) -> Iterator[None]:
        if mutant is None:
            yield
            return
        place = self._folder / mutant.path
        source = place.read_bytes()
        place.write_bytes(mutant.applied(source))
        try:
            yield
        finally:
            place.write_bytes(source)

    def _prepare(self, empty: bool) -> None:
        """Makes the cache, state and temporary folders anew."""
        for name in ("state", "tmp"):
            shutil.rmtree(self._folder / name, ignore_errors=True)
            (self._folder / name).mkdir(mode=0o700)
        if self._secret is not None and self._secret.exists():
            (self._folder / "state" / "ulna").mkdir(mode=0o700)
            shutil.copy2(self._secret, self._folder / "state" / "ulna")
        _link_entries(None if empty else self._cache, self._folder / "cache")


def _copy_compiled(sources: Path, copy: Path, compiled: Path) -> None:
    """Copies sources with their bytecode, which `compiled` keeps from one run of the script to the next."""
    known = compiled.with_suffix(".digest")
    digest = hashlib.sha256()
    for file in sorted(sources.rglob("*.py")):
        digest.update(f"{file.relative_to(sources)} {hashlib.sha256(file.read_bytes()).hexdigest()}".encode())
    if not known.exists() or known.read_text() != digest.hexdigest():
        known.unlink(missing_ok=True)
        shutil.rmtree(compiled, ignore_errors=True)
        shutil.copytree(sources, compiled, ignore=shutil.ignore_patterns("__pycache__"))
        checked = py_compile.PycInvalidationMode.CHECKED_HASH
        compileall.compile_dir(compiled, quiet=2, invalidation_mode=checked)
        known.write_text(digest.hexdigest())
    shutil.copytree(compiled, copy)


def _link_entries(cache: Path | None, folder: Path) -> None:
    """Makes `folder` hold links to the entries of `cache` and nothing else; what is right already stays."""
    wanted = {}
    if cache is not None and cache.is_dir():
        wanted = {entry.name: entry.inode() for entry in os.scandir(cache) if entry.is_file()}
    folder.mkdir(mode=0o700, exist_ok=True)
    folder.chmod(0o700)
    for entry in list(os.scandir(folder)):
        if wanted.get(entry.name) == entry.inode():
            del wanted[entry.name]
        elif entry.is_dir(follow_symlinks=False):
            shutil.rmtree(entry.path, ignore_errors=True)
        else:
            Path(entry.path).unlink(missing_ok=True)
    for name in wanted:
        with contextlib.suppress(OSError):  # removed meanwhile, or on another device
            os.link(cache / name, folder / name)  # type: ignore[operator]


def user_cache() -> tuple[Path | None, Path | None]:
    """This user's kernel cache and the key of its seals; None where there is none, or no Ulna."""
    try:
        from ulna import disk_cache
        from ulna.system.folders import expanded, state_folder
    except ImportError:
        return None, None
    return disk_cache.folder(), expanded(state_folder()) / "cache-key"


class Judge:
    """Tries mutants; a failure counts only where the same tests pass without the mutant.

    Tests that passed when the map was built are tried without mutants later, by `refuted`: many at once take less time.
    """

    def __init__(self) -> None:
        self._sound: dict[tuple[str, ...], bool] = {}
        self._lock = threading.Lock()

    def verdict(
        self, mutant: Mutant, rounds: list[list[str]], sandbox: Sandbox, seconds: Callable[[str], float]
    ) -> Verdict:
        """Runs the rounds of tests until one notices the mutant."""
        start, count = time.monotonic(), 0
        for tests in rounds:
            left = tests
            while left:
                expected = sum(map(seconds, left))
                status, failed = sandbox.run(mutant, left, expected)
                if status is None:
                    if self._passes(left, sandbox):
                        return Verdict("timed out", "", count + len(left), time.monotonic() - start)
                    break  # they take too long without the mutant, too: the machine is busy
                if status == 0:
                    break
                if failed and seconds(failed):
                    return Verdict("caught", failed, count + len(left), time.monotonic() - start, False)
                suspects = [failed] if failed else left
                if self._passes(suspects, sandbox):
                    return Verdict("caught", suspects[0], count + len(left), time.monotonic() - start)
                sandbox.unsound.update(suspects)
                left = [test for test in left if test not in suspects]
            count += len(left)
        return Verdict("survived" if count else "untested", "", count, time.monotonic() - start)

    def refuted(self, tests: list[str], sandbox: Sandbox, seconds: Callable[[str], float]) -> set[str]:
        """Those of `tests` that fail without any mutant; they are left out from now on."""
        failing: set[str] = set()
        left = tests
        while left:
            status, failed = sandbox.run(None, left, sum(map(seconds, left)))
            if status == 0:
                break
            failing.update([failed] if failed else left)
            sandbox.unsound.update(failing)
            left = [test for test in left if test not in failing]
        return failing

    def _passes(self, tests: list[str], sandbox: Sandbox) -> bool:
        """Whether tests pass without any mutant."""
        key = tuple(tests)
        with self._lock:
            known = self._sound.get(key)
        if known is None:
            known = sandbox.run(None, tests, 0.0)[0] == 0
            with self._lock:
                self._sound[key] = known
        return known
