"""Elementary transforms, sequences of them, and their kinematics."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.former_modules import former_class
from roboticstoolbox._ets import ets as ets  # products of transforms are sequences


def __getattr__(name: str) -> Any:
    return former_class(__name__, name)
