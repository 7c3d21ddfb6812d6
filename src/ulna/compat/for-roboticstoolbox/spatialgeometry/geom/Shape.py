"""The names of `spatialgeometry` that scripts import from spatialgeometry.geom.Shape."""

from spatialgeometry._lines import *  # noqa: F403
from spatialgeometry._shape import *  # noqa: F403
