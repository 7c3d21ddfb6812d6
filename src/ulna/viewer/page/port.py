"""The port of a page."""

from __future__ import annotations

import os

from ulna.checks.values import count
from ulna.errors import InputError

_PORT = 8080


def checked_port(port: int | None) -> int:
    """The port that a page listens on first.

    Args:
        port: 0 (any free one) to 65535; None for that of the environment variable `ULNA_PORT`, or 8080.

    Returns:
        The port.

    Raises:
        InputError: It is none.
    """
    if port is not None:
        return count("port", port, 0, 65535)
    text = os.environ.get("ULNA_PORT", "").strip() or str(_PORT)
    if not (text.isascii() and text.isdigit() and int(text) <= 65535):
        raise InputError(
            f"The environment sets ULNA_PORT={text!r}; expected a port, 0 (any free one) to 65535."
        )
    return int(text)
