"""The kernels of a page: poses of the links, and inverse kinematics of each frame that can be dragged."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.errors import InputError, UlnaError
from ulna.exporting.record import Export
from ulna.exporting.selection import Entry, identifier, records
from ulna.exporting.wasm.code import LANES, module, places, traced
from ulna.ik.search import DESCENT
from ulna.ik.solve import search_settings
from ulna.model import Model
from ulna.viewer.live.draggable import DraggableFrame

_TOLERANCE = 1e-9  # m and rad
_LINK_POSES = "link_poses"


def webassembly(model: Model, frames: Sequence[DraggableFrame]) -> tuple[bytes, dict[str, Any]]:
    """The WebAssembly module of a page, and what its program must know to call it.

    Searches begin at the last configuration and make one attempt: what lies far away would be a jump. Where they do
    not reach the goal, a descent follows, which finds the nearest configuration there is.

    Args:
        model: The robot.
        frames: The frames to drag; frame k has the kernel `ik_k`.

    Returns:
        The module, and a description: where memory is free, where arguments and results of the kernels lie [byte],
        the settings of searches and of descents, and where the sequence of their starting points begins.

    Raises:
        InputError: The robot is too large for a WebAssembly module.
    """
    searches: list[Entry] = [(f"ik_{k}", "ik", _options(model, f)) for k, f in enumerate(frames)]
    functions, made = records(model, [(_LINK_POSES, _LINK_POSES, {}), *searches], {})
    export = Export(identifier(model.name), model, functions, made, np.dtype(float))
    graphs = traced(export)
    offsets, data_size = places(graphs, export.dtype.itemsize)
    try:
        linked = module(export, graphs, data_size)
    except UlnaError as error:
        raise InputError(
            f"The kinematics of {model.name!r} cannot run in a page: {error} Drag fewer frames, such as "
            f"frames=({model.tool!r},), or lock joints with robot.lock(...)."
        ) from error
    search = search_settings(_TOLERANCE, _TOLERANCE, 1, is_free=False, lanes=LANES).tolist()
    kernels = {
        "free": linked.free,
        "linkPoses": offsets[_LINK_POSES],
        "searches": [{"at": offsets[s.name], "shift": s.shift.tolist()} for s in made],
        "search": search,
        "descent": [*search[:3], float(-DESCENT)],
    }
    return linked.binary, kernels


def _options(model: Model, draggable: DraggableFrame) -> dict[str, Any]:
    joints = tuple(model.joints[j].name for j in draggable.joints)
    return {"frame": model.frame_name(draggable.frame), "mask": draggable.mask, "joints": joints}
