"""Frames of a model as procedures know them, those that external forces act on among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ulna.model import Frame, Model
from ulna.model.constraint import End
from ulna.recursions._procedures.frame_table import INT, REFERENCES, Frames
from ulna.recursions.tree_table import matrices_as_rows, step_rows

Options = Mapping[str, Any]


def frame_table(frames: Sequence[Frame | End], rows: Mapping[int, int], reference: str = "world") -> Frames:
    """Some frames.

    Args:
        frames: The frames.
        rows: The rows of the joints that carry them, by `step_rows`.
        reference: How what is asked for is written.

    Returns:
        Their table.
    """
    return Frames(
        np.array([rows[frame.joint] for frame in frames], INT),
        matrices_as_rows([frame.placement for frame in frames]),
        np.array([REFERENCES.index(reference)], INT),
    )


def loaded_frames(model: Model, options: Options) -> Frames | None:
    """The frames that external forces act on.

    Args:
        model: The robot.
        options: Those of a quantity; forces turn with their frames where no `reference` is among them.

    Returns:
        Their table; None where there are no forces.
    """
    names = options.get("forces")
    if not names:
        return None
    frames = [model.frame(name) for name in names]
    return frame_table(frames, step_rows(model), options.get("reference", "local"))
