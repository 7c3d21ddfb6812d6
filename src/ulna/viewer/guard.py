"""Who may talk to the page: this machine's own browser tabs, and nobody else."""

from __future__ import annotations

from urllib.parse import urlsplit

LOOPBACK = ("localhost", "127.0.0.1", "::1")


def allowed(host: str | None, origin: str | None, any_host: bool = False) -> bool:
    """Whether a request may be answered.

    A browser states in `Origin` which page speaks, and in `Host` which name it was sent to. A page of
    another site has another origin; a site that lets its own name point here (DNS rebinding) has another
    host. Ports may differ from ours (an SSH tunnel), so origin and host are compared with each other.
    Programs state no origin.

    Args:
        host: The request's Host.
        origin: Its Origin, or None.
        any_host: Whether names other than this machine's loopback names are served, too.
    """
    if not host:
        return False
    try:
        name = urlsplit(f"//{host}").hostname
        if name is None or not (any_host or name in LOOPBACK):
            return False
        if origin is None:
            return True
        speaker = urlsplit(origin)
        return speaker.scheme in ("http", "https") and speaker.netloc.lower() == host.lower()
    except ValueError:  # not an address at all
        return False
