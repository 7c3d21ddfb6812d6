"""What is said of fields that a Data does not have."""

from __future__ import annotations

from collections.abc import Iterable

from ulna.errors import nearest


def missing_field_message(name: str, fields: Iterable[str]) -> str:
    """The message for a field that a Data does not have, with the nearest one.

    Args:
        name: The name.
        fields: Those that it has.

    Returns:
        The message.
    """
    text = f"Data has no field {name!r}"
    near = nearest(name, fields, 1, 0.6)
    return f"{text}. Did you mean {near[0]!r}?" if near else f"{text}; dir(data) lists its fields."
