"""Closes in a forked child the sockets of a page, which would else stay open until the child ends."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Any


def close_inherited(servers: Iterable[Any]) -> None:
    """Closes the listening sockets and the connections of some servers of websockets, in this forked child only.

    Each descriptor is made one of the null device: the objects that hold it may still close it, but nothing is sent,
    and the parent's event loop, which the child shares, is not changed.
    """
    null = os.open(os.devnull, os.O_RDWR)
    try:
        for descriptor in itertools.chain.from_iterable(map(_descriptors, servers)):
            with suppress(OSError):
                os.dup2(null, descriptor, inheritable=False)
    finally:
        os.close(null)


def _descriptors(server: Any) -> Iterator[int]:
    sockets: list[Any] = list(
        getattr(server, "sockets", ()) if getattr(server, "server", None) is not None else ()
    )
    for connection in list(getattr(server, "handlers", ())):
        transport = getattr(connection, "transport", None)
        sockets.append(transport.get_extra_info("socket") if transport is not None else None)
    for one in sockets:
        number = one.fileno() if one is not None else -1
        if number >= 0:
            yield number
