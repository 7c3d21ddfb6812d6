"""MJCF -> binary model by MuJoCo's compiler; run as a program, it does so for another process and within limits.

The program imports nothing of Ulna, so that it starts quickly. From its standard input it reads requests, each a line
of JSON and the MJCF text; to its standard output it writes for each a line of JSON and MuJoCo's binary model (MJB).
Nothing that it writes is ever executed by the process that reads it.
"""

from __future__ import annotations

import json
import os
import re
import signal
import sys
from typing import Any

COUNTS = ("nbody", "njnt", "ngeom", "nsite", "neq", "nu", "nexclude", "nkey", "nmesh", "nmat")
"""The elements of a model that cost Ulna time, each."""


NO_MEMORY = ("Could not allocate", "unknown exception", "bad_alloc")
"""What MuJoCo says where memory runs out."""

IDLE = 30.0
"""After how long without a request the program ends [s]."""


def compile_mjcf(text: str, file: str | None) -> tuple[Any, dict[str, Any]]:
    """The compiled `mujoco.MjModel` of a text, or of a file, and what it does not hold but the file says.

    Args:
        text: The document, where there is no file.
        file: Its file; None for a text.

    Returns:
        The model, and "mesh_folder", the folder of the meshes as the file writes it, "lines", for each kind of
        element the lines on which its elements start, by their index in the model, and "mesh_references", the
        `refpos` and `refquat` of the meshes that have them, by their index.

    Raises:
        Exception: whatever MuJoCo raises.
    """
    import mujoco

    library: Any = mujoco  # its parts come from a compiled module without annotations
    spec = library.MjSpec.from_string(text) if file is None else library.MjSpec.from_file(file)
    model = spec.compile()
    return model, {
        "mesh_folder": spec.meshdir or "",
        "lines": _lines_of(spec),
        "mesh_references": _references_of(spec),
    }


def _lines_of(spec: Any) -> dict[str, dict[int, int]]:
    parts = {
        "body": spec.bodies,
        "joint": spec.joints,
        "tendon": spec.tendons,
        "equality": spec.equalities,
        "actuator": spec.actuators,
    }
    lines: dict[str, dict[int, int]] = {}
    for kind, elements in parts.items():
        matches = ((element.id, re.match(r"line (\d{1,9})", element.info)) for element in elements)
        lines[kind] = {index: int(line[1]) for index, line in matches if line and index >= 0}
    return lines


def _references_of(spec: Any) -> dict[int, tuple[list[float], list[float]]]:
    poses: dict[int, tuple[list[float], list[float]]] = {}
    for mesh in spec.meshes:
        position, turn = [float(x) for x in mesh.refpos], [float(x) for x in mesh.refquat]
        if mesh.id >= 0 and (any(position) or any(turn[1:])):
            poses[mesh.id] = position, turn
    return poses


def binary_of(model: Any) -> bytes:
    """The model in MuJoCo's binary format (MJB)."""
    import mujoco
    import numpy as np

    library: Any = mujoco
    content = np.empty(library.mj_sizeModel(model), np.uint8)
    library.mj_saveModel(model, None, content)
    return content.tobytes()


def model_of(binary: bytes) -> Any:
    """The `mujoco.MjModel` that `binary_of` wrote."""
    import mujoco

    library: Any = mujoco
    return library.MjModel.from_binary_path("model.mjb", {"model.mjb": binary})


def main() -> None:
    """Answer the requests on standard input, until it ends or nothing was asked for a while."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever asked decides, and ends this process
    os.environ["MUJOCO_GL"] = "disable"
    requests, replies = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what MuJoCo prints is no part of a reply
    while line := requests.readline():
        request = json.loads(line)
        _limit(request["memory"], request["seconds"] + 5)
        reply, content = _answer(request, requests.read(request["size"]).decode("utf-8"))
        replies.write(json.dumps({**reply, "size": len(content)}).encode() + b"\n" + content)
        replies.flush()
        if reply.get("memory"):
            os._exit(0)  # no destructors: the memory is used up
        _limit(request["memory"], IDLE)


def _answer(request: dict[str, Any], text: str) -> tuple[dict[str, Any], bytes]:
    reply: dict[str, Any] = {}
    content = b""
    sys.path[:] = request["path"]
    try:
        os.chdir(request["folder"])  # where the files lie that a text names
        model, reply["facts"] = compile_mjcf(text, request["file"])
        reply["elements"] = sum(int(getattr(model, name)) for name in COUNTS)
        if reply["elements"] <= request["elements"]:
            content = binary_of(model)
    except MemoryError:
        reply = {"memory": True}
    except Exception as error:
        reply = {"error": str(error), "memory": any(word in str(error) for word in NO_MEMORY)}
    return reply, content


def _limit(memory: int, seconds: float) -> None:
    """Limits that hold also when the process that asked is gone. Windows has neither."""
    if hasattr(signal, "alarm"):
        signal.alarm(int(seconds) + 1)
    try:
        import resource
    except ImportError:
        return
    for kind, wanted in ((resource.RLIMIT_AS, memory), (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(kind)[1]
        soft = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        try:
            resource.setrlimit(kind, (soft, hard))
        except (OSError, ValueError):  # macOS refuses some
            continue


if __name__ == "__main__":
    main()
