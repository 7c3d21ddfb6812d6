"""MuJoCo's compiler in a separate process, which a file can neither keep busy for ever nor make fill the memory."""

from __future__ import annotations

import atexit
import importlib.util
import json
import os
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any, final

from ulna.errors import FormatError, InputError, MissingExtra
from ulna.formats.mjcf_compiler import compile_mjcf, model_of
from ulna.system import forks

SECONDS = 60.0
"""How long MuJoCo may compile a file that is not trusted [s]."""

MEMORY = 4 * 2**30
"""How much address space it may use [bytes], where the system can limit it."""

ELEMENTS = 30_000
"""How many bodies, joints, geoms, sites and the like a model may have."""

_TRUST = "If you trust the file, trusted=True compiles it in this process, without limits."


def compiled(text: str, file: str | None, trusted: bool) -> tuple[Any, Any]:
    """The compiled `mujoco.MjModel` of a text or a file, and the facts that `compile_mjcf` returns beside it.

    Args:
        text: the document, where there is no file.
        file: Its file; None for a text.
        trusted: whether to compile in this process, without limits of time, memory and size.

    Returns:
        The compiled model, and what the file says that it does not hold, as attributes.

    Raises:
        MissingExtra: the package mujoco is not installed.
        FormatError: the document passes a limit.
        InputError: there is no process to compile in.
        ValueError: MuJoCo refuses the document; the text is MuJoCo's.
    """
    if importlib.util.find_spec("mujoco") is None:
        raise MissingExtra("mujoco", "mjcf", "Reading MJCF")
    if trusted:
        try:
            model, facts = compile_mjcf(text, file)
        except Exception as error:  # MuJoCo's own kinds, and those of its binding
            raise ValueError(str(error)) from error
        return model, SimpleNamespace(**facts)
    answer, content = _answered(text, file)
    if answer.get("memory"):
        raise FormatError(f"MuJoCo needs more than {MEMORY / 2**30:.3g} GiB for it.", file=file, fix=_TRUST)
    if "error" in answer:
        raise ValueError(answer["error"])
    if answer["elements"] > ELEMENTS:
        count = f"{answer['elements']} bodies, joints, geoms and the like"
        raise FormatError(f"its model has {count}; expected at most {ELEMENTS}.", file=file, fix=_TRUST)
    facts = answer["facts"]
    lines = {kind: {int(k): line for k, line in of_kind.items()} for kind, of_kind in facts["lines"].items()}
    references = {int(k): reference for k, reference in facts["mesh_references"].items()}
    facts |= {"lines": lines, "mesh_references": references}
    return model_of(content), SimpleNamespace(**facts)


def _answered(text: str, file: str | None) -> tuple[dict[str, Any], bytes]:
    """The reply of a compiler process, and the binary model."""
    data = text.encode()
    request = {
        "memory": MEMORY,
        "seconds": SECONDS,
        "elements": ELEMENTS,
        "path": [os.path.abspath(p) for p in sys.path],
        "folder": os.getcwd(),
        "file": None if file is None else os.path.abspath(file),
        "size": len(data),
    }
    content = json.dumps(request).encode() + b"\n" + data
    used = _CompilerProcess.waiting()
    if used is not None:
        # It may have ended meanwhile, and earlier files may have left it with less memory.
        with suppress(_Ended):
            answer, binary = used.ask(content, file)
            if not answer.get("memory"):
                used.keep()
                return answer, binary
            used.end()
    process = _CompilerProcess()
    try:
        answer, binary = process.ask(content, file)
    except _Ended as ended:
        raise FormatError(f"MuJoCo's compiler {ended} on it.", file=file) from None
    process.end() if answer.get("memory") else process.keep()
    return answer, binary


class _Ended(Exception):
    """A compiler process ended before it answered; says how."""


@final
class _CompilerProcess:
    """A process that runs `mjcf_compiler`, for one file after another."""

    _lock = forks.lock(forks.LIBRARY)
    _waiting: _CompilerProcess | None = None

    def __init__(self) -> None:
        if not sys.executable or getattr(sys, "frozen", False):
            raise InputError(f"There is no Python interpreter to run MuJoCo's compiler in. {_TRUST}")
        program = Path(__file__).with_name("mjcf_compiler.py")
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-I", "-S", str(program)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            )
        except OSError as error:
            reason = error.strerror or error
            raise InputError(f"MuJoCo's compiler cannot be run: {reason}. {_TRUST}") from error

    @classmethod
    def waiting(cls) -> _CompilerProcess | None:
        """The process that waits for another file, which is the caller's from now on; None where there is none."""
        with cls._lock:
            child, cls._waiting = cls._waiting, None
        if child is not None and child._process.poll() is not None:
            child.end()
            return None
        return child

    def ask(self, content: bytes, file: str | None) -> tuple[dict[str, Any], bytes]:
        """The reply to a request, and the binary model; the process is ended when it takes too long.

        Raises:
            FormatError: it took too long.
            _Ended: the process ended without an answer.
        """
        requests, replies = self._process.stdin, self._process.stdout
        assert requests is not None and replies is not None
        late = threading.Event()
        clock = threading.Timer(SECONDS, lambda: (late.set(), self._process.kill()))
        clock.daemon = True
        clock.start()
        try:
            requests.write(content)
            requests.flush()
            answer = json.loads(replies.readline())
            binary = replies.read(answer["size"])
            if len(binary) == answer["size"]:
                return answer, binary
        except (OSError, ValueError):  # a pipe to a process that is gone; half a reply
            pass
        except BaseException:  # such as KeyboardInterrupt
            self.end()
            raise
        finally:
            clock.cancel()
        self.end()
        if late.is_set():
            raise FormatError(
                f"MuJoCo was still compiling it after {SECONDS:g} s, and was stopped.", file=file, fix=_TRUST
            )
        code = self._process.returncode
        raise _Ended(f"was ended by signal {-code}" if code < 0 else f"failed (exit code {code})")

    def keep(self) -> None:
        """Let the process wait for another file; it ends by itself where none comes."""
        with self._lock:
            if _CompilerProcess._waiting is None:
                _CompilerProcess._waiting = self
                return
        self.end()

    def end(self) -> None:
        """End the process, whatever it does."""
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with suppress(OSError):  # what was not written yet
                    pipe.close()
        self._process.wait()

    @classmethod
    def forget(cls) -> None:
        """In a forked child: the process belongs to the parent."""
        waiting, cls._waiting = cls._waiting, None
        if waiting is not None:
            waiting._process.returncode = 0  # not ours to wait for


def _end_waiting() -> None:
    process = _CompilerProcess.waiting()
    if process is not None:
        process.end()


atexit.register(_end_waiting)
forks.in_child(_CompilerProcess.forget)
