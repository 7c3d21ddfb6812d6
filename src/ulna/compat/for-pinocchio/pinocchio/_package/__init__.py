"""Names of the package: loaded when first used, or explained where not offered."""

from __future__ import annotations

from typing import Any


def __getattr__(name: str) -> Any:
    from pinocchio._package.former_modules import former_class

    return former_class(__name__, name)
