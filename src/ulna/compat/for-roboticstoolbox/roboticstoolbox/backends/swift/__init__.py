"""The viewer by the toolbox's name: what the package `swift` offers."""

from __future__ import annotations

from swift import *  # noqa: F403
from swift import __all__ as __all__
