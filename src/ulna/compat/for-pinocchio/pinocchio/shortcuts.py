"""Several things at once: a model with its geometries, and their data."""

from __future__ import annotations

from typing import Any

from pinocchio._containers.enums import GeometryType
from pinocchio._parsers.geometry_urdf import geometries_of_links, geometry_model_of
from pinocchio._parsers.mjcf import buildModelFromMJCF, buildModelsFromMJCF
from pinocchio._parsers.urdf import buildModelFromUrdf

__all__ = ["buildModelFromMJCFAndRootJoint", "buildModelsFromMJCF", "buildModelsFromUrdf", "createDatas"]


def buildModelsFromUrdf(
    filename: Any,
    package_dirs: Any = None,
    root_joint: Any = None,
    *more: Any,
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
        *more: `verbose` and `meshLoader` where older scripts put them; not needed.
        root_joint_name: Its name.
        verbose: Not needed.
        meshLoader: Not needed.
        geometry_types: One or several of GeometryType; both, collisions first, when not given.
        mimic: Whether mimic joints follow their leader.

    Returns:
        The model, then a GeometryModel for each of `geometry_types`.

    Raises:
        FormatError: The file is missing or broken. A missing mesh only warns.
    """
    named = {} if root_joint_name is None else {"root_joint_name": root_joint_name}
    model = buildModelFromUrdf(filename, *(() if root_joint is None else (root_joint,)), mimic=mimic, **named)
    kinds: Any = (GeometryType.COLLISION, GeometryType.VISUAL) if geometry_types is None else geometry_types
    kinds = kinds if hasattr(kinds, "__iter__") else (kinds,)
    links = geometries_of_links(filename, package_dirs)
    return (model, *(geometry_model_of(model, links, kind) for kind in kinds))


def createDatas(*models: Any) -> tuple[Any, ...]:
    """Data of a model and of each of its geometry models."""
    return tuple([None if model is None else model.createData() for model in models])


def buildModelFromMJCFAndRootJoint(
    mjcf_filename: Any, root_joint: Any, root_joint_name: str = "root_joint"
) -> Any:
    """The model of an MJCF file on a joint, without the closed loops; see `buildModelFromMJCF`.

    Args:
        mjcf_filename: The file.
        root_joint: The joint of the root body.
        root_joint_name: Its name.

    Returns:
        The model.
    """
    made = buildModelFromMJCF(mjcf_filename, root_joint, root_joint_name)
    return made[0] if isinstance(made, tuple) else made
