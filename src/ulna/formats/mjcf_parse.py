"""MJCF text or files -> what MuJoCo's own compiler makes of them, with our messages for what it refuses."""

from __future__ import annotations

import os
import re
from typing import Any

from ulna.errors import FormatError, MissingExtra
from ulna.formats.markup import read_file


def read_mjcf(source: str | os.PathLike[str]) -> Any:
    """The compiled `mujoco.MjModel` and its `MjSpec`, of a file or of text (from "<").

    MuJoCo reads the files that it includes, and its meshes, from disk.

    Raises:
        MissingExtra: the package mujoco is not installed.
        FormatError: the file is missing or broken; says where and what mends it.
    """
    text, file = text_or_file(source)
    if file is not None:
        read_file(file)  # our messages for what is missing, too large or a folder
    try:
        import mujoco
    except ImportError as error:
        raise MissingExtra("mujoco", "mjcf", "Reading MJCF") from error
    library: Any = mujoco  # its parts come from a compiled module without annotations
    try:
        spec = library.MjSpec.from_string(text) if file is None else library.MjSpec.from_file(file)
        return spec.compile(), spec
    except ValueError as error:
        raise _refusal(error, file) from error


def text_or_file(source: str | os.PathLike[str]) -> tuple[str, str | None]:
    """The text and no file, or no text and the file's name."""
    text = source.lstrip("\ufeff \t\r\n") if isinstance(source, str) else ""
    return (text, None) if text.startswith("<") else ("", os.fspath(source))


def _refusal(error: Exception, file: str | None) -> FormatError:
    """MuJoCo's message, in one line, with its line number where it has one."""
    words = " ".join(str(error).split())
    line = re.search(r"line (\d+)", words)
    words = re.sub(r"Element name '', |,? ?(id \d+, )?line \d+", " ", words).strip(" ,.")
    mend = ""
    if "mjMINVAL" in words:
        mend = "Give the body a geom with mass, or an <inertial>."
    elif "opening file" in words or "not found" in words:
        mend = "Meshes are looked for in the compiler's `meshdir`, seen from the file."
    number = int(line[1]) if line and int(line[1]) > 0 else None
    return FormatError(f"MuJoCo refuses it: {words}.", file=file, line=number, mend=mend)
