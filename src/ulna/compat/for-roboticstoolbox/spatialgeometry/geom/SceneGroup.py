"""The names of `spatialgeometry` that scripts import from spatialgeometry.geom.SceneGroup."""

from spatialgeometry._node import *  # noqa: F403
