"""Whether a display, a browser and an interactive terminal are available, and opening a browser window."""

from __future__ import annotations

import os
import sys
import webbrowser

_TEXT_ONLY = ("lynx", "w3m", "links", "elinks", "www-browser")


def has_screen() -> bool:
    """Whether a browser window can be opened here. False where the environment sets `ULNA_HEADLESS=1`."""
    if os.environ.get("ULNA_HEADLESS", "") not in ("", "0"):
        return False
    if sys.platform in ("darwin", "win32"):
        screen = "SSH_CONNECTION" not in os.environ
    else:
        screen = bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return screen and _browser() is not None


def somebody_can_look() -> bool:
    """Whether a browser can be opened here, or someone at the terminal could open one elsewhere."""
    if os.environ.get("ULNA_HEADLESS", "") not in ("", "0"):
        return False
    return has_screen() or bool(sys.stdin and sys.stdin.isatty() and sys.stdout.isatty())


def open_browser(url: str, name: str | None = None) -> bool:
    """Open a page in a browser; False where there is none.

    Args:
        url: The address of the page.
        name: The browser, as the module `webbrowser` names it; the user's when not given.

    Returns:
        Whether it was started.
    """
    browser = _browser(name) if has_screen() else None
    if browser is None:
        return False
    try:
        return bool(browser.open(url))
    except (webbrowser.Error, OSError):
        return False


def _browser(name: str | None = None) -> webbrowser.BaseBrowser | None:
    try:
        browser = webbrowser.get(name)
    except webbrowser.Error:
        return None
    # a browser in the terminal would take the terminal over and show nothing
    return None if os.path.basename(getattr(browser, "name", "")) in _TEXT_ONLY else browser
