"""Frames that can be dragged, and the joints that follow each: the ends of limbs, so that each limb moves alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import final

from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.model import Frame, Model

_MIN_COORDINATES = 3  # joint coordinates that carry a frame worth dragging
_POSE = 6  # joint coordinates from which on a frame is turned, too
_MAX_FRAMES = 6  # frames that are chosen where none are named


@final
@dataclass(frozen=True)
class DraggableFrame:
    """A frame that can be dragged.

    Args:
        frame: The frame.
        joints: Indices of the joints that follow it.
        turns: Whether its rotation follows, too, or its position only.
    """

    frame: Frame
    joints: tuple[int, ...]
    turns: bool

    @property
    def mask(self) -> str:
        """What counts of a goal, as for `robot.ik`."""
        return "pose" if self.turns else "position"


def draggable_frames(model: Model, names: Sequence[str] | None = None) -> tuple[DraggableFrame, ...]:
    """The frames to drag: those named, or the tool and the ends of the other limbs.

    Joints that carry one of the frames only follow it, as long as there are three of them or more; else all that
    carry it do. Floating bases and ball joints stay where they are.

    Args:
        model: The robot.
        names: Names of frames; None to choose.

    Returns:
        The frames; none for a robot that has fewer than three joints in a row.

    Raises:
        UnknownName: There is no frame of that name.
        InputError: `names` is no sequence of different names, or a frame is carried by no joint.
    """
    frames = _ends(model) if names is None else _named(model, names)
    carrying = [{j for j in model.support(f.joint) if _is_simple(model, j)} for f in frames]
    out = []
    for k, (frame, joints) in enumerate(zip(frames, carrying, strict=True)):
        others = set().union(*carrying[:k], *carrying[k + 1 :])
        alone = joints - others
        chosen = tuple(sorted(alone if len(alone) >= min(_MIN_COORDINATES, len(joints)) else joints))
        if not chosen:
            raise InputError(
                f"`frames` names {frame.name!r}, which no joint with one coordinate moves; "
                "expected a frame that moves."
            )
        out.append(DraggableFrame(frame, chosen, len(chosen) >= _POSE))
    return tuple(out)


def _named(model: Model, names: Sequence[str]) -> list[Frame]:
    if isinstance(names, str) or not all(isinstance(n, str) for n in names) or len(set(names)) < len(names):
        raise InputError(
            f"`frames` is {short_repr(names)}; expected different names of frames, such as ({model.tool!r},)."
        )
    return [model.frame(name) for name in names]


def _ends(model: Model) -> list[Frame]:
    """The last frame of each chain that can be turned, else of each that can be moved; the tool, where it is on it.

    They are in the order of how much their names are like the tool's: both hands come before both feet.
    """
    tool = model.frame(model.tool)
    rows = _unbranched_chains(model)
    rows = [row for row in rows if len(row) >= _POSE] or rows
    if not rows:
        carrying = [j for j in model.support(tool.joint) if _is_simple(model, j)]
        return [tool] if len(carrying) >= _MIN_COORDINATES else []
    ends = [tool if tool.joint in row else _last_frame(model, row[-1]) for row in rows]
    return sorted(ends, key=lambda frame: -SequenceMatcher(None, tool.name, frame.name).ratio())[:_MAX_FRAMES]


def _unbranched_chains(model: Model) -> list[list[int]]:
    """Rows of joints without branches that are long enough, and end where nothing or several joints follow."""
    rows = []
    for joint in range(len(model.joints)):
        if len(_followers(model, joint)) == 1 or not _is_simple(model, joint):
            continue
        row = [joint]
        while (parent := model.joints[row[0]].parent) >= 0 and _is_simple(model, parent):
            if len(_followers(model, parent)) > 1:
                break
            row.insert(0, parent)
        if len(row) >= _MIN_COORDINATES:
            rows.append(row)
    return rows


def _followers(model: Model, joint: int) -> list[int]:
    return [k for k in model.children(joint) if model.joints[k].mimic is None]


def _is_simple(model: Model, joint: int) -> bool:
    j = model.joints[joint]
    return j.mimic is None and j.kind.nq == j.kind.nv == 1


def _last_frame(model: Model, joint: int) -> Frame:
    """The last link with a shape that a joint carries, as a frame; without one, the joint's own link."""
    links = [link for link in model.links if link.joint == joint]
    shaped = [link for link in links if link.visuals or link.collisions]
    return model.frame((shaped or links)[-1].name, "link")
