"""The names of `spatialgeometry` that scripts import from spatialgeometry.geom.CollisionShape."""

from spatialgeometry._collision import *  # noqa: F403
from spatialgeometry._mesh import *  # noqa: F403
from spatialgeometry._solids import *  # noqa: F403
