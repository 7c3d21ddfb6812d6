"""Messages from the browser are checked before viser handles them: what a page cannot have sent is ignored.

viser trusts its clients: it converts values to the type of a control (text "nan" to a number), takes values
outside the limits of a slider or the options of a menu, and writes any attribute that a message names. Any client
that knows the address can send such messages. They are dropped here and logged as "ulna.page.messages" at level
INFO, so that functions of the user see valid values only. Everything here was read in viser 1.1.
"""

from __future__ import annotations

import logging
import math
from typing import Any

from ulna.checks.values import MAX_LENGTH
from ulna.viewer.page.pose_channel import LAST

_log = logging.getLogger("ulna.page.messages")
_MAX_TEXT = 100_000  # characters of a text that somebody types
_ROUNDING = 1e-9  # of the range of a slider: what JavaScript's arithmetic leaves beyond its limits


def filter_messages(server: Any, answered: set[int]) -> None:
    """Have a viser server ignore messages that no page of ours sends.

    Args:
        server: A `viser.ViserServer` of a known version.
        answered: Gets the numbers of clients that have answered the last message of the program.
    """
    connection = server._websock_server
    handle = connection._handle_incoming_message

    async def checked(client_id: Any, message: Any) -> None:
        if getattr(message, "name", None) == LAST:
            answered.add(int(client_id))
        elif is_valid(server, message):
            await handle(client_id, message)
        else:
            _log.info("ignored a %s of client %s", type(message).__name__, client_id)

    connection._handle_incoming_message = checked


def is_valid(server: Any, message: Any) -> bool:
    """Whether a page can have sent a message that is for the server.

    Args:
        server: A `viser.ViserServer`.
        message: A message of `viser._messages`, its fields of any type.

    Returns:
        False for what the controls of the page do not send.
    """
    kind = type(message).__name__
    if kind == "GuiUpdateMessage":
        if not isinstance(message.uuid, str) or not isinstance(message.updates, dict):
            return False
        control = server.gui._gui_input_handle_from_uuid.get(message.uuid)
        return control is not None and _is_valid_update(control._impl, message.updates)
    if kind == "TransformControlsUpdateMessage":
        length = math.hypot(*message.wxyz) if _is_vector(message.wxyz, 4, 2.0) else 0.0
        return _is_name(message) and _is_vector(message.position, 3, MAX_LENGTH) and 0.5 < length < 2.0
    if kind in ("TransformControlsDragStartMessage", "TransformControlsDragEndMessage"):
        return _is_name(message)
    if kind in ("SceneNodeClickMessage", "ScenePointerMessage"):
        return _is_valid_click(message)
    # the camera is handled by the connection; the panel has no uploads, forms or commands
    return False


def _is_valid_click(message: Any) -> bool:
    """Whether a click on a node, or a click or rectangle in the scene, has finite rays and places on the screen."""
    if type(message).__name__ == "SceneNodeClickMessage":
        places, known = (
            (message.screen_pos,),
            _is_name(message) and isinstance(message.instance_index, int | None),
        )
    else:
        places, known = message.screen_pos, message.event_type in ("click", "rect-select")
    rays = (message.ray_origin, message.ray_direction)
    has_ray = all(_is_vector(ray, 3, MAX_LENGTH) for ray in rays)
    rectangle = getattr(message, "event_type", "click") == "rect-select" and rays == (None, None)
    on_screen = isinstance(places, list | tuple) and all(_is_vector(place, 2, 100.0) for place in places)
    return known and on_screen and 0 < len(places) <= 2 and (has_ray or rectangle)


def _is_name(message: Any) -> bool:
    return isinstance(message.name, str) and isinstance(message.owner, str)


def _is_vector(value: Any, count: int, most: float) -> bool:
    return isinstance(value, list | tuple) and len(value) == count and all(_is_number(x, most) for x in value)


def _is_number(value: Any, most: float = math.inf) -> bool:
    """Whether a value is a finite number, at most that large: not text, nor True or False."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= most and math.isfinite(value if isinstance(value, float) else value % 2)


def _is_valid_update(state: Any, updates: dict[Any, Any]) -> bool:
    """Whether a control, by its state in viser, can have that update: another value, and nothing else."""
    if list(updates) != ["value"]:
        return False
    value, props = updates["value"], state.props
    if state.is_button or isinstance(state.value, bool):
        options = getattr(props, "options", None)
        return isinstance(value, bool) if options is None else value in tuple(options)
    if isinstance(state.value, int | float):
        return _is_number(value, 1e300) and _is_within(value, props)
    if isinstance(state.value, str):
        options = getattr(props, "options", None)
        return isinstance(value, str) and (
            len(value) <= _MAX_TEXT if options is None else value in tuple(options)
        )
    return False


def _is_within(value: float, props: Any) -> bool:
    """Whether a number is within the limits of a control, where it has limits."""
    low, high = getattr(props, "min", None), getattr(props, "max", None)
    slack = _ROUNDING * (high - low) if low is not None and high is not None else 0.0
    return (low is None or value >= low - slack) and (high is None or value <= high + slack)
