"""The names of `spatialgeometry` that scripts import from spatialgeometry.geom.SceneNode."""

from spatialgeometry._node import *  # noqa: F403
