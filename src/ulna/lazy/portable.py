"""Functions that are sent to other processes as some kilobytes, and rebuilt once in each of them."""

from __future__ import annotations

import os
import pickle
import platform
import sys
import zlib
from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Any, final

import numpy as np

from ulna import version
from ulna.errors import InputError, VersionMismatch
from ulna.system import forks

_MAX_CACHED_FUNCTIONS = 32  # functions that a process keeps
_known: OrderedDict[str, Any] = OrderedDict()
_lock = forks.lock()


@final
class Portable:
    """A function as tasks of Dask carry it: small, named by its content, compiled once in each process that calls it.

    Args:
        function: A function that can be pickled: a kernel, a method of a robot, a function of a module.

    Raises:
        InputError: If it cannot be pickled.
    """

    __slots__ = ("_content", "_digest", "_versions")

    def __init__(self, function: Callable[..., Any]) -> None:
        content, is_by_value = _pickled(function)
        self._content = zlib.compress(content)
        import hashlib  # with OpenSSL, which takes as long as fifty files of ours

        self._digest = hashlib.sha256(content).hexdigest()[:32]
        self._versions = versions(is_by_value)
        _remember(self._digest, function)

    @property
    def function(self) -> Callable[..., Any]:
        """The function; rebuilt when this process sees it for the first time.

        Raises:
            VersionMismatch: If it comes from a process with another version of Ulna.
        """
        function = _known.get(self._digest)
        if function is None:
            check_versions(self._versions)
            function = _remember(self._digest, pickle.loads(zlib.decompress(self._content)))
        return function

    @property
    def digest(self) -> str:
        """A name for the content, the same for the same content."""
        return self._digest

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Calls the function.

        Args:
            *args, **options: Its arguments.

        Returns:
            What it returns.
        """
        return self.function(*args, **options)

    def __dask_tokenize__(self) -> tuple[str, str]:
        return "ulna", self._digest

    def __getstate__(self) -> tuple[Any, ...]:
        return self._content, self._digest, self._versions

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self._content, self._digest, self._versions = state


def versions(is_by_value: bool = False) -> dict[str, str]:
    """What must be the same in two processes for one to run the other's tasks.

    Args:
        is_by_value: Whether the task holds code of Python, which runs in the same version of Python only.

    Returns:
        Versions by name.
    """
    numpy = np.__version__.split(".", maxsplit=1)[0]
    python = ".".join(platform.python_version_tuple()[:2])
    return {"Ulna": version.__version__, "NumPy": numpy} | ({"Python": python} if is_by_value else {})


def check_versions(theirs: Mapping[str, str]) -> None:
    """Refuses tasks of a process with other versions.

    Args:
        theirs: What `versions` returned there.

    Raises:
        VersionMismatch: If one of them differs.
    """
    ours = versions("Python" in theirs)
    for name, other in theirs.items():
        if ours.get(name) != other:
            here = f"process {os.getpid()} on {platform.node() or 'an unnamed machine'}, {sys.executable}"
            raise VersionMismatch(
                f"This task was made with {name} {other}, but this worker ({here}) has {name} {ours.get(name)}. "
                "Install the same version on both, then restart the workers."
            )


def _pickled(function: Callable[..., Any]) -> tuple[bytes, bool]:
    """The function as bytes, and whether these hold code of Python."""
    try:
        content = pickle.dumps(function, protocol=5)
    except Exception as error:  # whatever a user's object raises
        reason = error
    else:
        if b"__main__" not in content:  # other processes have another main module
            return content, False
        reason = TypeError("it is defined in the main module")
    try:
        import cloudpickle  # pyright: ignore[reportMissingImports]

        return cloudpickle.dumps(function, protocol=5), True
    except Exception:
        raise InputError(
            f"{function!r} cannot be sent to other processes: {reason}. Use a function of a module that can be "
            "imported there."
        ) from reason


def _remember(digest: str, function: Any) -> Any:
    with _lock:
        function = _known.setdefault(digest, function)
        _known.move_to_end(digest)
        while len(_known) > _MAX_CACHED_FUNCTIONS:
            _known.popitem(last=False)
    return function
