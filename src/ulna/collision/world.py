"""A world of named shapes that a robot must not touch or that it carries; frozen, edited by making new ones."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field, replace
from typing import Any, final

from ulna.checks.values import flag, number, short_repr
from ulna.collision.objects import Attachment, Obstacle, checked_object, checked_pose
from ulna.collision.robot_poses import robot_poses
from ulna.collision.shared_list import SharedList
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.geometry import Mesh, Shape
from ulna.idioms import unknown_attribute
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.system.discarded import returns_copy
from ulna.typing import ArrayLike


@final
@dataclass(frozen=True, eq=False)
class World:
    """Obstacles, and objects that links carry, by name. Start from `World()` and add.

    A link that cannot move is not checked against an obstacle that cannot move: no motion changes what they do.

    Attributes:
        obstacles: The obstacles.
        attachments: The objects that links carry.
        margins: How far two must stay apart, by the set of their names [m].

    Example:
        >>> from ulna.collision import World
        >>> from ulna.geometry import Box, Sphere
        >>> world = World().add("table", Box((1.0, 1.0, 0.1)), (0.6, 0.0, -0.05))
        >>> world = world.add("ball", Sphere(0.1), (0.5, 0.2, 0.4))  # a new world: the old one is as it was
        >>> world.names
        ('table', 'ball')
    """

    obstacles: tuple[Obstacle, ...] = field(default_factory=tuple)  # no value of the class: see __getattr__
    attachments: tuple[Attachment, ...] = ()
    margins: Mapping[frozenset[str], float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "obstacles", tuple(self.obstacles))
        object.__setattr__(self, "attachments", tuple(self.attachments))
        taken: set[str] = set()
        for item in (*self.obstacles, *self.attachments):
            if item.name in taken:
                is_held = any(item.name == a.name for a in self.attachments)
                kind = "an attached object" if is_held else "an obstacle"
                raise InputError(
                    f"The world has {kind} named {item.name!r} already; expected a new name. "
                    "Take the old one out with `world.remove(name)`, or move it with `world.move(name, pose)`."
                )
            taken.add(item.name)

    @returns_copy("world")
    def add(
        self,
        name: str,
        shape: Shape,
        pose: SE3 | ArrayLike | None = None,
        *,
        moving: bool = False,
        touches: Iterable[str] = (),
    ) -> World:
        """The world with one more obstacle.

        Args:
            name: A new name.
            shape: A shape of `ulna.geometry`: Box, Sphere, Cylinder, Capsule, Cone, Ellipsoid, Plane, Mesh, PointCloud,
                HeightField.
            pose: T_world_shape [m]: an SE3, an array of shape (4, 4), or a position of shape (3,); None for the
                world's origin.
            moving: Whether calls may give it another pose.
            touches: Names of links and attached objects that may touch it.

        Returns:
            A new world.

        Raises:
            InputError: If the name is taken, or shape or pose cannot be one.

        Example:
            >>> from ulna.collision import World
            >>> from ulna.geometry import Cylinder
            >>> world = World().add("post", Cylinder(0.05, 1.0), (0.5, 0.0, 0.5))
            >>> lying = world.add("beam", Cylinder(0.05, 1.0), ulna.SE3.rx(np.pi / 2))
            >>> lying.names
            ('post', 'beam')
        """
        allowed = checked_object(name, shape, touches, "Obstacle")
        moving = flag("moving", moving)
        new = Obstacle(name, shape, checked_pose(f"obstacle {name!r}", pose), moving, allowed)
        if self._has(name):
            return replace(self, obstacles=(*self.obstacles, new))  # which refuses the name
        world = object.__new__(World)  # without looking at all names again: thousands are added one by one
        world.__dict__.update(
            attachments=self.attachments, margins=self.margins, _list=self._list.with_item(len(self), new),
            _count=len(self) + 1,
        )  # fmt: skip
        return world

    @returns_copy("world")
    def remove(self, name: str) -> World:
        """The world without that obstacle or attached object. Raises UnknownName with the nearest one."""
        if not self._has(name):
            raise UnknownName("obstacle", name, sorted((*self.names, *(a.name for a in self.attachments))))
        obstacles = tuple(o for o in self.obstacles if o.name != name)
        attachments = tuple(a for a in self.attachments if a.name != name)
        margins = {pair: distance for pair, distance in self.margins.items() if name not in pair}
        return World(obstacles, attachments, margins)

    @returns_copy("world")
    def move(self, name: str, pose: SE3 | ArrayLike) -> World:
        """The world with an obstacle at another pose.

        Args:
            name: Its name.
            pose: T_world_shape [m]: an SE3, an array of shape (4, 4), or a position of shape (3,).

        Returns:
            A new world.

        Raises:
            UnknownName: no obstacle of that name; offers the nearest one.

        Example:
            >>> from ulna.collision import World
            >>> from ulna.geometry import Sphere
            >>> world = World().add("ball", Sphere(0.1), (0.5, 0.2, 0.4))
            >>> world.move("ball", (0.5, 0.3, 0.4))["ball"].pose.translation
            array([0.5, 0.3, 0.4])
        """
        old = self[name]
        new = replace(old, pose=checked_pose(f"obstacle {name!r}", pose))
        return replace(self, obstacles=tuple(new if o is old else o for o in self.obstacles))

    @returns_copy("world")
    def attach(
        self,
        name: str,
        link: str,
        pose: SE3 | ArrayLike | None = None,
        *,
        shape: Shape | None = None,
        touches: Iterable[str] = (),
    ) -> World:
        """The world with an object that a link carries; an obstacle of that name is one no longer.

        The object counts like a part of the link: in collision checks against obstacles, other links and other
        attached objects, in distances, and in planning. What may touch the obstacle may touch the object, too.

        Args:
            name: Its name: that of an obstacle, which the link takes up, or a new one.
            link: Name of the link.
            pose: T_link_shape [m]: an SE3, an array of shape (4, 4), or a position of shape (3,); None for the link's
                frame.
            shape: The shape; None for that of the obstacle.
            touches: Names of links, obstacles and attached objects that it may touch: fingers around it, what it
                stands on.

        Returns:
            A new world.

        Raises:
            InputError: If the name is taken, there is no shape, or shape or pose cannot be one.

        Example:
            >>> from ulna.collision import World
            >>> from ulna.geometry import Box
            >>> world = World().add("parcel", Box((0.1, 0.1, 0.1)), (0.5, 0.0, 0.05))
            >>> carried = world.attach("parcel", "panda_hand", (0.0, 0.0, 0.15), touches=["panda_leftfinger"])
            >>> carried.attached("parcel").link
            'panda_hand'
        """
        taken = self[name] if name in self.names else None
        if shape is None and taken is None:
            raise InputError(
                f"Attached object {name!r}: no shape is given, and no obstacle has that name; expected `shape=`, "
                f"or the name of an obstacle: {', '.join(map(repr, self.names[:8])) or 'there are none'}."
            )
        allowed = checked_object(name, shape or (taken and taken.shape), touches, "Attached object")
        if taken is not None:
            allowed = tuple(dict.fromkeys((*allowed, *taken.touches)))
        place = checked_pose(f"attached object {name!r}", pose)
        if not isinstance(link, str):
            raise InputError(f"`link` is {short_repr(link)}; expected the name of a link.")
        new = Attachment(name, link, shape or taken.shape, place, allowed)  # type: ignore[union-attr]
        rest = tuple(o for o in self.obstacles if o is not taken)
        return replace(self, obstacles=rest, attachments=(*self.attachments, new))

    @returns_copy("world")
    def detach(self, name: str, pose: SE3 | ArrayLike, *, touches: Iterable[str] = ()) -> World:
        """The world with an attached object put down: it is an obstacle from now on. `remove` takes it away.

        Args:
            name: Its name.
            pose: Where it stands: T_world_shape [m], as for `add`; where the link holds it,
                `robot.fk(q, link) @ world.attached(name).pose.matrix()`.
            touches: Names of links and attached objects that may touch it now.

        Returns:
            A new world.

        Raises:
            UnknownName: If nothing of that name is attached; offers the nearest one.
        """
        old = self.attached(name)
        rest = replace(self, attachments=tuple(a for a in self.attachments if a is not old))
        return rest.add(name, old.shape, pose, touches=touches)

    def attached(self, name: str) -> Attachment:
        """The attached object of that name. Raises UnknownName with the nearest one."""
        for item in self.attachments:
            if isinstance(name, str) and item.name == name:
                return item
        raise UnknownName("attached object", name, [a.name for a in self.attachments])

    @returns_copy("world")
    def set_margin(self, first: str, second: str, distance: float) -> World:
        """The world with a distance that two must keep: they count as nearer than they are by that much, everywhere.

        Args:
            first: Name of a link, an obstacle or an attached object.
            second: Name of another.
            distance: How far apart [m]; 0 for no margin.

        Returns:
            A new world.

        Raises:
            InputError: If the two are one, or the distance is negative or not finite.
        """
        if first == second:
            raise InputError(
                f"The margin of {first!r} and itself has no meaning; expected two different names."
            )
        value = number("distance", distance, "a finite length, not below 0 [m]", least=0.0)
        margins = {**self.margins, frozenset((first, second)): value}
        return replace(self, margins={pair: d for pair, d in margins.items() if d > 0.0})

    def margin(self, first: str, second: str) -> float:
        """How far apart two must stay [m].

        Args:
            first: Name of a link, an obstacle or an attached object.
            second: Name of another.

        Returns:
            What `set_margin` said, 0 where it said nothing [m].
        """
        return self.margins.get(frozenset((first, second)), 0.0) if self.margins else 0.0

    @returns_copy("world")
    def add_robot(
        self,
        name: str,
        model: Model,
        q: ArrayLike | None = None,
        placement: SE3 | None = None,
        *,
        moving: bool = False,
    ) -> World:
        """The world with another robot in it, as obstacles named `name/link/number`.

        Args:
            name: What its obstacles' names begin with.
            model: The other robot's model (`robot.model`).
            q: Its configuration, shape (nq,) [rad, m]; None for neutral.
            placement: T_world_base, where its world stands in this one [m]; None for the origin.
            moving: Whether calls may move it, with `robot_poses` of its new configurations.

        Returns:
            A new world.

        Raises:
            InputError: If the name is taken, or `model` is no model.
        """
        if not isinstance(model, Model):
            raise InputError(
                f"`model` is of type {type(model).__name__}; expected a Model, such as the `model` of a robot."
            )
        world, poses = self, robot_poses(name, model, model.neutral if q is None else q, placement)
        for link in model.links:
            for k, geometry in enumerate(link.collisions):
                key = f"{name}/{link.name}/{k}"
                world = world.add(key, geometry.shape, poses[key], moving=moving)
        return world

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of the obstacles, in order."""
        return tuple(o.name for o in self.obstacles)

    @cached_property
    def _list(self) -> SharedList:
        """A list that begins with the obstacles, shared with worlds that have more."""
        return SharedList(self.obstacles)

    @cached_property
    def _count(self) -> int:
        return len(self.obstacles)

    def _has(self, name: str) -> bool:
        """Whether an obstacle or an attached object has that name."""
        if not isinstance(name, str):
            return False
        return self._list.has(name, self._count) or any(name == a.name for a in self.attachments)

    @cached_property
    def _by_name(self) -> Mapping[str, Obstacle]:
        return {o.name: o for o in self.obstacles}

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the content; meshes count by their whole path here."""
        shapes = [item.shape for item in (*self.obstacles, *self.attachments)]
        paths = [shape.path for shape in shapes if isinstance(shape, Mesh)]
        parts = [[o.name, o.shape, o.pose, o.moving, list(o.touches)] for o in self.obstacles]
        attachments = [[a.name, a.link, a.shape, a.pose, list(a.touches)] for a in self.attachments]
        margins = sorted([*sorted(pair), distance] for pair, distance in self.margins.items())
        return fingerprint([parts, paths, attachments, margins])

    def __reduce__(self) -> tuple[Any, ...]:
        return World, (self.obstacles, self.attachments, self.margins)

    def __getattr__(self, name: str) -> Any:
        if name == "obstacles" and "_list" in self.__dict__:  # `add` leaves this to who asks
            return self.__dict__.setdefault("obstacles", self._list.first(self._count))
        raise unknown_attribute("world", name, dir(type(self)))

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[Obstacle]:
        return iter(self.obstacles)

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    def __getitem__(self, name: str) -> Obstacle:
        if not isinstance(name, str) or name not in self._by_name:
            raise UnknownName("obstacle", name, self.names)
        return self._by_name[name]

    def moving(self, name: str) -> Obstacle:
        """The obstacle of that name, which calls may move.

        Raises:
            UnknownName: There is no such obstacle.
            InputError: It does not move.
        """
        obstacle = self[name]
        if not obstacle.moving:
            raise InputError(
                f"Obstacle {name!r} does not move, and a pose was given for it. "
                "Add it with moving=True, or make another world with `world.move(name, pose)`."
            )
        return obstacle

    def __repr__(self) -> str:
        attachments = "".join(f"; {a.name} on {a.link}" for a in self.attachments)
        more = " ..." if len(self) > 8 else ""
        return f"<world of {len(self)} obstacles: {', '.join(self.names[:8])}{more}{attachments}>"
