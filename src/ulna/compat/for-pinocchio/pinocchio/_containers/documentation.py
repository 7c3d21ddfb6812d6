"""What arguments of the same name mean in all functions of the package; docstrings name the others only."""

from __future__ import annotations

import inspect
from collections.abc import Collection
from typing import Any

from ulna.compat.documentation import documented

ARGUMENTS = {
    "model": "The model.",
    "data": "Its data.",
    "q": "Configuration (nq,) [rad or m].",
    "q1": "Configuration (nq,) [rad or m].",
    "q2": "Configuration (nq,) [rad or m].",
    "v": "Velocity (nv,) [rad/s or m/s].",
    "a": "Acceleration (nv,) [rad/s^2 or m/s^2].",
    "tau": "Torques (nv,) [N m or N].",
    "fext": "For each joint, the universe included, the force (6,) [N, N m] on its body in its frame; None for none.",
    "joint_id": "Index of the joint.",
    "frame_id": "Index of the frame.",
    "reference_frame": "LOCAL, WORLD or LOCAL_WORLD_ALIGNED: where the result is expressed.",
    "geometry_model": "The geometries.",
    "contact_models": "The constraints.",
    "contact_datas": "Their data.",
    "constraint_models": "The constraints.",
    "constraint_data": "The data of the constraint.",
    "models": "The constraints.",
    "datas": "Their data.",
    "compiled": "Ulna's model and its kernels.",
    "J": "Jacobian (m, nv).",
    "damping": "Number that is added to the diagonal of the Delassus matrix [1/kg].",
    "filename": "The file.",
    "mjcf_filename": "The file.",
    "srdf_filename": "The file.",
    "root_joint_name": "Its name.",
    "mesh_loader": "A coal.MeshLoader for the files of meshes.",
    "meshLoader": "A coal.MeshLoader for the files of meshes.",
    "loadModel": "Whether to load the geometries, too.",
    "geometry_object": "The geometry.",
    "geometry_type": "GeometryType.VISUAL or COLLISION.",
    "geom_type": "GeometryType.VISUAL or COLLISION.",
    "pair_index": "Number of the pair.",
    "frame_ids": "Indices of the frames; all by default.",
    "constraint_datas": "Their data.",
    "delassus": "Delassus operator, or matrix (m, m).",
    "bp": "The gains.",
    "rpy": "Roll, pitch and yaw, (3,) [rad].",
    "mass": "Mass [kg].",
    "radius": "Radius [m].",
    "shapes": "For each constraint its rows, whether they are local, and its two joints.",
    "evaluator": "The evaluator, whose parameters are loaded.",
}
"""For each name what is written in `Args:` where a docstring has no entry of that name."""
describe_arguments = documented(ARGUMENTS)


def describe_all(objects: Collection[Any]) -> None:
    """Completes the docstrings of functions, and of the methods of classes of the package."""
    classes = {base for item in objects if inspect.isclass(item) for base in item.__mro__}
    functions = {item for item in objects if inspect.isfunction(item)}
    for described in classes | functions:
        if described.__module__.startswith("pinocchio._"):
            describe_arguments(described)
