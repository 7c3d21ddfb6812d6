"""The one way to make a model: add its links and joints to a builder, in any order, then `build()`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Self

from ulna.model.assemble import assemble
from ulna.model.copying import add_model
from ulna.model.model import Model
from ulna.model.parts_builder import PartsBuilder
from ulna.spatial import SE3
from ulna.typing import Floats


class ModelBuilder(PartsBuilder):
    """Collects what a model consists of.

    Each method checks what it is given on its own and returns the builder; `build` checks how it all fits
    together. Where a model comes from a file, `where` (such as ``"arm.urdf:12"``) leads the messages about
    that element.

        builder = ModelBuilder("pendulum")
        builder.add_link("base")
        builder.add_link("rod", Inertia.from_point(1.0, (0.0, 0.0, -0.5)))
        builder.add_joint("hinge", Revolute((0, 1, 0)), "base", "rod", SE3.trans(0.0, 0.0, 1.0))
        model = builder.build()

    Args:
        name: The model's name.
        source: The file it is read from.

    Example:
        >>> from ulna.model import Revolute
        >>> builder = ulna.ModelBuilder("pendulum")
        >>> rod = ulna.Inertia.from_point(1.0, (0.0, 0.0, -0.5))  # 1 kg, half a metre below the hinge
        >>> builder = builder.add_link("base").add_link("rod", rod)
        >>> builder = builder.add_joint("hinge", Revolute((0, 1, 0)), "base", "rod")
        >>> pendulum = ulna.Robot(builder.build())
        >>> pendulum.gravity_forces([np.pi / 2]).round(3)
        array([4.905])
    """

    def add_model(
        self,
        model: Model,
        link: str | None = None,
        placement: SE3 | None = None,
        *,
        prefix: str = "",
        joint: str | None = None,
        locked: Mapping[str, Floats] | None = None,
    ) -> Self:
        """Adds all of a finished model: links, joints, frames, disabled pairs and groups.

        Its configurations, gravity and tool are not copied, because they concern the whole model.

        Args:
            model: The model.
            link: Name of the link its root is fixed to; None makes its root the root of this one.
            placement: T_link_root, where its world frame lies on that link [m]; None for the link's frame.
            prefix: Put before every name.
            joint: Name of the new fixed joint; None makes one from the root's name. Where the model has a movable
                root joint, that one connects it instead.
            locked: For joints that become fixed, their position, shape (kind.nq,) [rad, m].

        Returns:
            The builder.

        Raises:
            ModelError: a name is taken; another `prefix` fixes that.
        """
        add_model(self, model, link, placement, prefix=prefix, mount=joint, locked=locked)
        self._state.from_models.update(prefix + name for name in model.link_names)
        return self

    def build(self) -> Model:
        """The model.

        Fixed joints are merged: their links keep their own inertia and place, and move with the last movable
        joint before them. Rounding noise below 1e-15 in rotations and translations is cleaned off.

        Raises:
            ModelError: the parts contradict one another; the message says how to fix it.
            UnknownName: a name is used that nothing bears; offers the nearest one.

        Example:
            >>> from ulna.model import Revolute
            >>> builder = ulna.ModelBuilder("door").add_link("frame").add_link("leaf")
            >>> door = builder.add_joint("hinge", Revolute((0, 0, 1)), "frame", "leaf").build()
            >>> ulna.Robot(door).joint_names
            ('hinge',)
        """
        return assemble(self._state)
