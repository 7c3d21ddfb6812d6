"""A port that stays free until a test uses it."""

from __future__ import annotations

import random
import socket


def free_port() -> int:
    """A port that nothing listens on, below those that systems give to programs that ask for any."""
    chance = random.Random()  # another one in each process
    while True:
        port = chance.randrange(20_000, 30_000)
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return port
