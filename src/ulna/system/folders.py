"""Where a user's own files belong on each platform."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def cache_folder() -> str:
    """The folder of this user's caches of Ulna, as a path that may begin with `~`."""
    return _folder("ulna", "~/Library/Caches/ulna", "XDG_CACHE_HOME", "~/.cache")


def state_folder() -> str:
    """The folder of what Ulna keeps for this user that is no cache, as a path that may begin with `~`."""
    return _folder("ulna-state", "~/Library/Application Support/ulna", "XDG_STATE_HOME", "~/.local/state")


def _folder(windows: str, mac: str, variable: str, fallback: str) -> str:
    if sys.platform == "win32":
        return os.path.join(os.environ.get("LOCALAPPDATA") or "~/AppData/Local", windows)
    if sys.platform == "darwin":
        return mac
    return os.path.join(os.environ.get(variable) or fallback, "ulna")


def expanded(path: str) -> Path:
    """The path with `~` as the user's home folder; an empty HOME counts as not set.

    Raises:
        RuntimeError: This user has no home folder.
    """
    of_this_user = path == "~" or path.startswith("~/")
    if of_this_user and os.environ.get("HOME") == "" and hasattr(os, "getuid"):
        import pwd

        try:
            home = pwd.getpwuid(os.getuid()).pw_dir
        except KeyError:
            home = ""
        if not home:
            raise RuntimeError("no home folder")
        path = home + path[1:]
    return Path(path).expanduser()
