"""Robots made of a robot: locked, attached, with another tool, other numbers, a payload."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

from ulna import model as models
from ulna.errors import InputError
from ulna.quantities.part import Part
from ulna.spatial import SE3, Inertia
from ulna.system.discarded import returns_copy
from ulna.typing import ArrayLike


class Variants(Part):
    """New robots; the one at hand never changes."""

    __slots__ = ()

    def _of_model(self, model: models.Model) -> Self:
        """A robot like this one, of another model."""
        robot: Any = type(self)
        return robot(model)

    @returns_copy("robot")
    def lock(self, joints: Mapping[str, Any] | Sequence[str], q: Any = None) -> Self:
        """The robot with some joints held still; see `ulna.model.lock_joints`.

        Args:
            joints: Names of the joints, or a mapping from names to the positions they are held at [rad or m].
            q: Configuration they are held at, (nq,) [rad or m]; None for neutral.

        Returns:
            The other robot.

        Raises:
            UnknownName: If there is no such joint; names the nearest.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot.lock(["panda_joint3"]).nq
            6
        """
        return self._of_model(models.lock_joints(self.model, joints, q))

    @returns_copy("robot")
    def attach(
        self,
        other: Self,
        frame: str | None = None,
        placement: SE3 | None = None,
        prefix: str = "",
        **options: Any,
    ) -> Self:
        """This robot carrying another: a gripper on an arm, an arm on a base; see `ulna.model.attach`.

        Args:
            other: The robot that is carried.
            frame: Frame of this robot that carries it; None for the tool.
            placement: T_frame_other, the pose of its base there; None for the frame's own.
            prefix: Put before the names of its links, joints and frames.
            **options: Of `ulna.model.attach`.

        Returns:
            Both as one robot.

        Raises:
            InputError: If `other` is no Robot.
            UnknownName: If there is no such frame; names the nearest.

        Example:
            >>> robot = ulna.load("panda")
            >>> pair = robot.attach(ulna.load("ur5"), "panda_link0", ulna.SE3(0, 1, 0), prefix="second_")
            >>> pair.nq
            13
        """
        if not isinstance(other, type(self)):
            raise InputError(f"`other` is {other!r}; expected a Robot, such as ulna.load(...) returns.")
        return self._of_model(models.attach(self.model, other.model, frame, placement, prefix, **options))

    @returns_copy("robot")
    def with_tool(self, frame: str, placement: SE3 | None = None, name: str = "tool") -> Self:
        """The robot with another tool, its default frame.

        Args:
            frame: Name of a frame.
            placement: T_frame_tool, for a new frame; None for the frame itself.
            name: Name of the new frame.

        Returns:
            The other robot.

        Raises:
            UnknownName: If there is no such frame; names the nearest.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot.with_tool("panda_hand", ulna.SE3(0, 0, 0.2), name="probe").tool
            'probe'
        """
        return self._of_model(models.with_tool(self.model, frame, placement, name))

    @returns_copy("robot")
    def with_dynamic_parameters(self, parameters: ArrayLike, *, check: bool = True) -> Self:
        """The robot with other masses and inertias; see `ulna.model.with_dynamic_parameters`.

        Args:
            parameters: As `robot.parameters.dynamic`, (10 nbodies,) or (nbodies, 10) [kg, kg m, kg m^2].
            check: Whether to refuse bodies that cannot exist.

        Returns:
            The other robot.

        Raises:
            ShapeError, NonFiniteError, ModelError: If they are no parameters of bodies.
        """
        return self._of_model(models.with_dynamic_parameters(self.model, parameters, check=check))

    @returns_copy("robot")
    def with_link_inertias(self, inertias: Mapping[str, Inertia]) -> Self:
        """The robot with other inertias of some links; see `ulna.model.with_link_inertias`.

        Args:
            inertias: For names of links, their inertia in the link's frame [kg, kg m, kg m^2].

        Returns:
            The other robot.

        Raises:
            UnknownName: If there is no such link; names the nearest.
            ModelError: If an inertia cannot be one.

        Example:
            >>> robot = ulna.load("panda")
            >>> heavy = robot.with_link_inertias({"panda_hand": ulna.Inertia.from_box(1.5, (0.2, 0.06, 0.1))})
            >>> round(heavy.model.links[heavy.model.link_index("panda_hand")].inertia.mass, 3)
            1.5
        """
        return self._of_model(models.with_link_inertias(self.model, inertias))

    @returns_copy("robot")
    def with_parameters(self, values: Mapping[str, Any], *, check: bool = True) -> Self:
        """The robot with other inertias, placements, offsets, gravity ...; see `ulna.model.with_parameters`.

        Args:
            values: Parameters by name, of the shapes of `robot.parameters[name]`.
            check: Whether to refuse bodies that cannot exist.

        Returns:
            The other robot.

        Raises:
            UnknownName: If there is no such parameter; names the nearest.
            ShapeError, NonFiniteError, InputError, ModelError: If a value cannot be what it stands for.
        """
        return self._of_model(models.with_parameters(self.model, values, check=check))

    @returns_copy("robot")
    def with_payload(
        self,
        frame: str | None = None,
        mass: float = 1.0,
        com: ArrayLike = (0.0, 0.0, 0.0),
        inertia: ArrayLike | None = None,
        *,
        name: str = "payload",
    ) -> Self:
        """The robot carrying a body; see `ulna.model.with_payload`.

        Args:
            frame: Where it carries it; None for the tool.
            mass: Mass of the body [kg].
            com: Its centre of mass in the frame, (3,) [m].
            inertia: Its rotational inertia about the centre of mass, (3, 3) [kg m^2]; None for a point.
            name: Name of the new link.

        Returns:
            The other robot.

        Raises:
            UnknownName: If there is no such frame; names the nearest.
            ShapeError, InputError, ModelError: If the body cannot exist.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot.with_payload(mass=2.0).model.mass - robot.model.mass
            2.0
        """
        return self._of_model(models.with_payload(self.model, frame, mass, com, inertia, name=name))

    @returns_copy("robot")
    def perturbed(self, fraction: float = 0.1, seed: Any = None, com: float = 0.0) -> Self:
        """A robot like this one, with masses and inertias off at random; see `ulna.model.perturbed`.

        Args:
            fraction: By how much at most, relative to each [-].
            seed: A number or a `numpy.random.Generator`.
            com: How far centres of mass move at most [m].

        Returns:
            The other robot.

        Example:
            >>> robot = ulna.load("panda")
            >>> other = robot.perturbed(0.2, seed=0)  # masses off by up to 20 %
            >>> abs(other.model.mass - robot.model.mass) < 0.2 * robot.model.mass
            True
        """
        return self._of_model(models.perturbed(self.model, fraction, seed, com))

    @returns_copy("robot")
    def with_configuration(self, name: str, q: Any) -> Self:
        """The robot with a named configuration.

        Args:
            name: Its key in `robot.configurations`.
            q: Numbers (nq,) [rad or m], or a mapping from joint names to positions.

        Returns:
            The other robot.

        Example:
            >>> robot = ulna.load("panda")
            >>> robot = robot.with_configuration("rest", {"panda_joint4": -1.5})
            >>> robot.configurations["rest"]
            array([ 0. ,  0. ,  0. , -1.5,  0. ,  0. ,  0. ])
        """
        return self._of_model(models.with_configuration(self.model, name, q))
