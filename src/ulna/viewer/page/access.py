"""Access control of the page: browser tabs of this machine, and on a network clients with the token."""

from __future__ import annotations

import hashlib
import hmac
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

from ulna.checks.values import short_repr
from ulna.errors import InputError

LOOPBACK = ("localhost", "127.0.0.1", "::1")


def checked_host(host: str) -> str:
    """An address to listen on, as words.

    Raises:
        InputError: It is none: what is nothing in particular would be every network.
    """
    if not isinstance(host, str):
        raise InputError(
            f"`host` is {short_repr(host)}; expected an address, such as '127.0.0.1' for this machine alone."
        )
    return host


def is_allowed(host: str | None, origin: str | None, any_host: bool = False) -> bool:
    """Whether a request may be answered.

    A browser states in `Origin` which page sent the request, and in `Host` which name it was sent to. A page of
    another site has another origin; a site that lets its own name point here (DNS rebinding) has another
    host. Ports may differ from ours (an SSH tunnel), so origin and host are compared with each other.
    Programs state no origin.

    Args:
        host: The request's Host.
        origin: Its Origin, or None.
        any_host: Whether names other than this machine's loopback names are served, too.

    Returns:
        Whether it may.
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


def has_token(token: str, path: str, cookies: str | None) -> bool:
    """Whether a request carries the token, in its address or in a cookie.

    Args:
        token: The token; "" allows every request.
        path: The request's path with its query.
        cookies: The request's Cookie header, or None.

    Returns:
        Whether it does.
    """
    if not token:
        return True
    try:
        tokens = parse_qs(urlsplit(path).query).get("token", [])
        jar = SimpleCookie(cookies or "")
    except (ValueError, CookieError):
        return False
    if _name(token) in jar:
        tokens.append(jar[_name(token)].value)
    return any(hmac.compare_digest(g.encode(), token.encode()) for g in tokens)


def token_cookie(token: str) -> str:
    """What makes a browser remember the token for this page alone, and keep it from scripts and other sites."""
    return f"{_name(token)}={token}; Path=/; HttpOnly; SameSite=Strict"


def frame_ancestors(host: str) -> str:
    """Which pages may hold this one in a frame: those of the same machine and of editors, as notebooks are.

    Another's could lay it, unseen, under something to click, and so have its buttons pressed.

    Args:
        host: The request's Host, an allowed one.
    """
    names = dict.fromkeys((*LOOPBACK[:2], urlsplit(f"//{host}").hostname or ""))
    sources = (f"{scheme}://{name}:*" for name in names if ":" not in name for scheme in ("http", "https"))
    return f"frame-ancestors 'self' {' '.join(sources)} vscode-webview: vscode-file:"


def _name(token: str) -> str:
    # pages on other ports of one machine share its cookies, so each token has a different name
    return "ulna-" + hashlib.sha256(token.encode()).hexdigest()[:12]
