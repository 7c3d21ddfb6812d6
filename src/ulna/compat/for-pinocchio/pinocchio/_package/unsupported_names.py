"""What this package does not offer, what to use instead, and the nearest name of what was misspelt."""

from __future__ import annotations

import re
from collections.abc import Iterable

from pinocchio._containers.former_names import replacement_message
from ulna.errors import nearest

_MESSAGES = (
    (r"casadi|cppad|.*[Cc]asadi.*",
     "Ulna differentiates and compiles functions itself: ulna.compile(f, robot).jacobian()."),
    (r".*Sdf.*|WITH_SDF.*", "SDF files are not read; convert them to URDF."),
    (r".*MJCF.*", "buildModelFromMJCF(file, root_joint, name) returns the model and the closed loops of the file."),
    (r"AUTOMATIC|MANUAL|CONSTANT|LINEAR|OSQP|SPECTRAL", "They are members of ADMMUpdateRule and ADMMProximalRule."),
    (r"(Panda3d|RViz)Visualizer", "Use MeshcatVisualizer or GepettoVisualizer: both draw into Ulna's viewer."),
    (r"numpy|inspect|sys", "It is no part of Pinocchio; import it itself."),
    (r"pin|pinocchio_pywrap.*|module_info|submodules|.*type_index|map_indexing.*|Deprecated.*|deprecat.*",
     "It belongs to the binding of Pinocchio to Python, which this package does not have."),
)  # fmt: skip


def unsupported_name_message(name: str, offered: Iterable[str]) -> str:
    """A message for a name that is not offered: what to use, or the nearest of the offered ones.

    Args:
        name: The name.
        offered: The names that are offered.

    Returns:
        The message.
    """
    if replaced := replacement_message("pinocchio", name):
        return replaced
    message = next((message for pattern, message in _MESSAGES if re.fullmatch(pattern, name)), "")
    near = nearest(name, offered, 1, 0.9 if message else 0.7)
    hint = f"Did you mean {near[0]!r}?" if near else ""
    both = f"{message} {hint}".strip()
    return both or "Real Pinocchio is `pip install pin`; run the script with plain python to use it."
