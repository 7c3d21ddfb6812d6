"""Several things at once: a model with its geometries, and their data."""

from __future__ import annotations

from typing import Any

from pinocchio._containers.enums import GeometryType
from pinocchio._containers.keywords import overloads
from pinocchio._model.model import Model
from pinocchio._parsers.geometry_urdf import geometries_of_links, geometry_model_of
from pinocchio._parsers.mjcf import (
    buildGeomFromMJCF,
    buildModelAndConstraintsFromMJCF,
    buildModelAndLegacyConstraintsFromMJCF,
)
from pinocchio._parsers.urdf import buildModelFromUrdf

__all__ = [
    "buildModelsAndConstraintsFromMJCF",
    "buildModelsFromMJCF",
    "buildModelsFromUrdf",
    "createDatas",
]

_COLLISION_AND_VISUAL = (GeometryType.COLLISION, GeometryType.VISUAL)
_OPTIONAL_ARGUMENTS = "verbose? meshLoader? geometry_types?"


@overloads(
    f"filename package_dirs? root_joint:JointModel? root_joint_name:str {_OPTIONAL_ARGUMENTS} mimic:bool?",
    f"filename package_dirs? root_joint:JointModel? {_OPTIONAL_ARGUMENTS} mimic:bool?",
)
def buildModelsFromUrdf(
    filename: Any,
    package_dirs: Any = None,
    root_joint: Any = None,
    root_joint_name: str | None = None,
    verbose: bool = False,
    meshLoader: Any = None,
    geometry_types: Any = None,
    mimic: bool = False,
) -> tuple[Any, ...]:
    """The model of a URDF file, its collision geometries and its visual geometries.

    Args:
        filename: The file.
        package_dirs: One or several folders to look for packages in; none are needed for the usual layouts.
        root_joint: The joint that the root link hangs from; fixed when not given.
        root_joint_name: Its name; where it is left out, the next arguments take its position.
        verbose: Not needed.
        meshLoader: A coal.MeshLoader for the files of meshes.
        geometry_types: One or several of GeometryType; both, collisions first, when not given.
        mimic: Whether mimic joints follow their leader.

    Returns:
        The model, and a GeometryModel for each of `geometry_types`.

    Raises:
        FormatError: The file is missing or broken. A missing mesh only warns.
    """
    root = () if root_joint is None else (root_joint,)
    named = {} if root_joint_name is None else {"root_joint_name": root_joint_name}
    model = buildModelFromUrdf(filename, *root, mimic=mimic, **named)
    links = geometries_of_links(filename, package_dirs)
    return (
        model,
        *(geometry_model_of(model, links, kind, None, meshLoader) for kind in _kinds(geometry_types)),
    )


def _kinds(geometry_types: Any) -> Any:
    kinds = _COLLISION_AND_VISUAL if geometry_types is None else geometry_types
    return kinds if hasattr(kinds, "__iter__") else (kinds,)


def createDatas(*models: Any) -> tuple[Any, ...]:
    """Data of a model and of each of its geometry models."""
    return tuple([None if model is None else model.createData() for model in models])


@overloads(
    f"filename root_joint:JointModel? root_joint_name:str {_OPTIONAL_ARGUMENTS} contacts:bool?",
    f"filename root_joint:JointModel? {_OPTIONAL_ARGUMENTS} contacts:bool?",
)
def buildModelsFromMJCF(
    filename: Any,
    root_joint: Any = None,
    root_joint_name: str | None = None,
    verbose: bool = False,
    meshLoader: Any = None,
    geometry_types: Any = None,
    contacts: bool = True,
) -> tuple[Any, ...]:
    """The model of an MJCF file, the constraints that close its loops, and its geometries.

    Args:
        filename: The file.
        root_joint: The joint that its root moves by; as the file says when not given.
        root_joint_name: Its name; where it is left out, the next arguments take its position.
        verbose: Not needed.
        meshLoader: A coal.MeshLoader for the files of meshes.
        geometry_types: One or several of GeometryType; both, collisions first, when not given.
        contacts: Whether the constraints are wanted.

    Returns:
        The model, a list of RigidConstraintModel unless `contacts` is False, and a GeometryModel for each of
        `geometry_types`.
    """
    name = root_joint_name or "root_joint"
    model, constraints = buildModelAndLegacyConstraintsFromMJCF(filename, root_joint, name)
    read = (model, constraints) if contacts else (model,)
    return (*read, *_geometries(model, filename, geometry_types, meshLoader))


@overloads(
    f"filename root_joint:JointModel? root_joint_name:str {_OPTIONAL_ARGUMENTS} constraints:bool?",
    f"filename root_joint:JointModel? {_OPTIONAL_ARGUMENTS} constraints:bool?",
)
def buildModelsAndConstraintsFromMJCF(
    filename: Any,
    root_joint: Any = None,
    root_joint_name: str | None = None,
    verbose: bool = False,
    meshLoader: Any = None,
    geometry_types: Any = None,
    constraints: bool = True,
) -> tuple[Any, ...]:
    """The same as `buildModelsFromMJCF`, with anchors of points and of frames in a dictionary, in place of the list.

    Args:
        filename: The file.
        root_joint: The joint of the root body; that of the file by default.
        root_joint_name: Its name.
        verbose: Not needed.
        meshLoader: A coal.MeshLoader for the files of meshes.
        geometry_types: One or several of GeometryType; both, collisions first, by default.
        constraints: Whether to return the constraints.

    Returns:
        The model, the dictionary with `constraints`, then a GeometryModel for each of `geometry_types`.
    """
    name = root_joint_name or "root_joint"
    model, points, frames = buildModelAndConstraintsFromMJCF(filename, root_joint, name)
    anchors = {"point_anchor_constraint_models": points, "frame_anchor_constraint_models": frames}
    read = (model, anchors) if constraints else (model,)
    return (*read, *_geometries(model, filename, geometry_types, meshLoader))


def _geometries(model: Model, filename: Any, geometry_types: Any, mesh_loader: Any) -> tuple[Any, ...]:
    return tuple([buildGeomFromMJCF(model, filename, kind, mesh_loader) for kind in _kinds(geometry_types)])
