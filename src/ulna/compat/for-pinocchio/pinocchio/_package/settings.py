"""Small things of the package: settings, types, and how many threads there are."""

from __future__ import annotations

from pinocchio._containers.enums import _Named
from ulna.errors import InputError, UlnaError
from ulna.system.processors import processor_count

Exception = UlnaError
ScalarType = float


class LogLevel(_Named):
    """How much is logged while files are read; this package warns, whatever is set."""

    CONSOLE_BRIDGE_LOG_DEBUG = 0
    CONSOLE_BRIDGE_LOG_INFO = 1
    CONSOLE_BRIDGE_LOG_WARN = 2
    CONSOLE_BRIDGE_LOG_ERROR = 3
    CONSOLE_BRIDGE_LOG_NONE = 4


def sharedMemory(value: bool | None = None) -> bool | None:
    """Whether arrays of Data and of models are live references: always. InputError where they shall not be."""
    if value is None:
        return True
    if not value:
        raise InputError("Arrays of Data are live references here; take .copy() of what must not change.")
    return None


def omp_get_max_threads() -> int:
    """How many threads calls with many configurations may use."""
    return processor_count()
