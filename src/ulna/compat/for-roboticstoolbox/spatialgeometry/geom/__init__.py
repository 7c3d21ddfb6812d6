"""The shapes once more, for `from spatialgeometry.geom import ...`."""

from spatialgeometry._collision import *  # noqa: F403
from spatialgeometry._lines import *  # noqa: F403
from spatialgeometry._mesh import *  # noqa: F403
from spatialgeometry._node import *  # noqa: F403
from spatialgeometry._shape import *  # noqa: F403
from spatialgeometry._solids import *  # noqa: F403
