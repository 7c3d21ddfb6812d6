"""The optional dependencies of Ulna, from the metadata of its installation, and the command that installs them."""

from __future__ import annotations

import re

_MARKER = re.compile(r"""\s*;.*\bextra\s*==\s*['"](?P<extra>[\w.-]+)['"]""")


def requirements(extra: str) -> tuple[str, ...]:
    """The requirements of an extra as pip takes them, such as ("viser<1.2,>=1.1",); none where Ulna is not installed.

    Args:
        extra: Name of the extra, such as "viewer".
    """
    try:
        from importlib import metadata  # not needed before something is missing

        declared = metadata.requires("ulna") or []
    except ImportError:  # no metadata: it runs from a folder on the path
        return ()
    marked = ((line, _MARKER.search(line)) for line in declared)
    return tuple(line[: marker.start()] for line, marker in marked if marker and marker["extra"] == extra)


def install_command(extra: str, package: str) -> str:
    """The shell command that installs what an extra needs, wherever Ulna itself came from.

    It names the packages of the extra, since `ulna[extra]` would only work where Ulna is in a package index.

    Args:
        extra: Name of the extra.
        package: The package that is missing; it stands alone where the metadata do not name the extra.

    Returns:
        The command.
    """
    needed = requirements(extra) or (package,)
    return "pip install " + " ".join(f"'{one}'" if re.search(r"[^\w.-]", one) else one for one in needed)
