"""The viewer by the toolbox's name: what the package `swift` offers."""

from __future__ import annotations

import swift
from swift import *  # noqa: F403
from swift import __all__ as __all__

from ulna.compat.missing_names import missing_name as _missing_name


def __getattr__(name: str) -> object:
    try:
        return getattr(swift, name)
    except AttributeError as error:
        raise _missing_name(__name__, name, str(error)) from None
