"""What arguments of the same name mean in all calls; docstrings name the others only."""

from __future__ import annotations

from ulna.compat.documentation import documented

ARGUMENTS = {
    "nodeName": "Name of the node.",
    "curveName": "Name of the curve.",
    "lineName": "Name of the line.",
    "wid": "Name of the window.",
    "RGBAcolor": "Red, green, blue, opacity from 0 to 1.",
    "radius": "Radius [m].",
    "configuration": "x, y, z [m] and a quaternion, (7,).",
    "pos1": "The start, (3,) [m].",
    "pos2": "The end, (3,) [m].",
    "urdfFilePath": "The file.",
    "packagePath": "Folder to look for packages in, or None.",
    **dict.fromkeys(("sphereName", "boxName", "cylinderName", "capsuleName"), "Name of the node."),
    **dict.fromkeys(("meshName", "faceName"), "Name of the node."),
    "robotName": "Name of the group.",
    "groupName": "Name of the group.",
    "length": "Length [m].",
    "return": "True.",
}
"""For each name what is written in `Args:` where a docstring has no entry of that name."""
describe_arguments = documented(ARGUMENTS)
