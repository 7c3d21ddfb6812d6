"""A tree of frames: each has a pose in its parent's frame, and where it is in the world follows from that."""

from __future__ import annotations

from collections.abc import Callable, Iterable, MutableSequence
from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.errors import InputError, ShapeError
from ulna.spatial import matrix_to_quat_xyzw
from ulna.typing import Floats

__all__ = ["SceneGroup", "SceneNode"]

_ORIGIN = np.eye(4)
_ORIGIN.setflags(write=False)


def matrix_of(pose: Any, name: str = "pose") -> Floats:
    """A pose as a read-only matrix.

    Args:
        pose: An array (4, 4), or an SE3 of one pose.
        name: Name of the argument, for messages.

    Returns:
        The pose, (4, 4).

    Raises:
        ShapeError, NonFiniteError, InputError: It is none.
    """
    value = getattr(pose, "A", pose)
    if isinstance(value, list):
        raise InputError(f"`{name}` holds {len(value)} poses; expected one. Take one of them: pose[0].")
    out = finite_array(name, value)
    if out.shape != (4, 4):
        raise ShapeError(name, out.shape, "(4, 4), or an SE3")
    R = out[:3, :3]
    if np.abs(R @ R.T - np.eye(3)).max() > 1e-3 or np.linalg.det(R) < 0.0:
        raise InputError(
            f"`{name}` holds no rotation: {R.tolist()}. Shapes are stretched by their sizes, not by poses."
        )
    out.setflags(write=False)
    return out


class SceneNode:
    """A frame in a tree of frames.

    Args:
        pose: T_parent_node, an SE3 or an array (4, 4).
        scene_parent: The frame it is attached to; anything with a world pose `_wT` serves, such as a robot's link.
        scene_children: Frames that are attached to it.
    """

    def __init__(
        self,
        pose: Any = _ORIGIN,
        scene_parent: Any = None,
        scene_children: Iterable[SceneNode] | None = None,
    ) -> None:
        self._pose = matrix_of(pose)
        self._parent: Any = None
        self._children: list[Any] = []
        if scene_parent is not None:
            self.attach_to(scene_parent)
        for child in scene_children or ():
            self.attach(child)

    def __str__(self) -> str:
        from spatialmath import SE3  # pyright: ignore[reportMissingImports]

        return f"{type(self).__name__} at {SE3(self.T, check=False).strline()}"

    @property
    def T(self) -> Floats:
        """T_parent_node, a copy, shape (4, 4); an SE3 or an array can be assigned."""
        return self._pose.copy()

    @T.setter
    def T(self, pose: Any) -> None:
        self._pose = matrix_of(pose, "T")

    def put(self, pose: Floats) -> None:
        """As assigning to `T`, for an array that is known to be a pose and that nobody will change."""
        pose.setflags(write=False)
        self._pose = pose

    @property
    def _wT(self) -> Floats:
        """T_world_node, shape (4, 4)."""
        return self._pose if self._parent is None else np.asarray(self._parent._wT) @ self._pose

    @property
    def _wq(self) -> Floats:
        """Its orientation in the world as a quaternion x y z w, shape (4,)."""
        return np.asarray(matrix_to_quat_xyzw(self._wT[:3, :3]))

    @property
    def scene_parent(self) -> Any:
        """The frame it is attached to; None for the world. Assigning leaves its `T` as it is."""
        return self._parent

    @scene_parent.setter
    def scene_parent(self, parent: Any) -> None:
        self._detach()
        if parent is not None:
            self.attach_to(parent)

    @property
    def scene_children(self) -> list[Any]:
        """The frames that are attached to it, as a new list."""
        return list(self._children)

    @scene_children.setter
    def scene_children(self, children: Iterable[SceneNode]) -> None:
        for child in list(self._children):
            child.scene_parent = None
        for child in children:
            self.attach(child)

    @property
    def attached(self) -> bool:
        """Whether it is attached to another frame."""
        return self._parent is not None

    def attach(self, object: SceneNode) -> None:
        """Hang another frame on this one; its `T` is from now on in this frame."""
        object.attach_to(self)

    def attach_to(self, object: Any) -> None:
        """Hang this frame on another one; `T` is from now on in that frame.

        Raises:
            InputError: It is no frame, or is attached to this one already.
        """
        if not hasattr(object, "_wT"):
            raise InputError(f"Cannot attach to {object!r}; expected a shape, a SceneNode or a robot's link.")
        above = object
        while above is not None:
            if above is self:
                raise InputError(
                    f"{_called(object)} is attached to {_called(self)} already; a tree has no circles."
                )
            above = getattr(above, "scene_parent", None)
        self._detach()
        self._parent = object
        if hasattr(object, "_children"):
            object._children.append(self)

    def _detach(self) -> None:
        if hasattr(self._parent, "_children"):
            self._parent._children = [c for c in self._parent._children if c is not self]
        self._parent = None

    def update(self) -> None:
        """Nothing is to be done: where a frame is in the world is computed when it is asked for."""

    _propogate_scene_tree = _propagate_scene_children = update

    def tree(self) -> str:
        """The whole tree it is in, a line for each frame, this one marked."""
        top: Any = self
        while getattr(top, "scene_parent", None) is not None:
            top = top.scene_parent
        return "\n".join(_lines(top, 0, self))

    def tree_children(self) -> str:
        """This frame and what is attached to it, a line for each."""
        return "\n".join(_lines(self, 0, self))


def _called(node: Any) -> str:
    text = repr(node) if isinstance(node, SceneNode) else str(node)
    return text.splitlines()[0]


def _lines(node: Any, depth: int, marked: Any) -> list[str]:
    line = "    " * depth + _called(node) + ("  <==" if node is marked else "")
    return [line, *(text for child in node.scene_children for text in _lines(child, depth + 1, marked))]


class Members(MutableSequence):
    """The children of a frame as a list."""

    _children: list[Any]
    attach: Any

    def _fit(self, item: Any) -> Any:
        return item

    @property
    def data(self) -> list[Any]:
        """The members, as a new list."""
        return list(self._children)

    def __len__(self) -> int:
        return len(self._children)

    def __getitem__(self, i: Any) -> Any:
        return self._children[i]

    def __setitem__(self, i: Any, item: Any) -> None:
        if isinstance(i, slice):
            raise InputError("Assign members one by one, or use `extend`.")
        self._fit(item)
        place = range(len(self._children))[i]
        del self[place]
        self.insert(place, item)

    def __delitem__(self, i: Any) -> None:
        chosen = self._children[i]
        for child in chosen if isinstance(i, slice) else [chosen]:
            child.scene_parent = None

    def insert(self, index: int, value: Any) -> None:
        """Inserts a frame before the member of an index.

        Args:
            index: The index.
            value: The frame.
        """
        self.attach(self._fit(value))
        self._children.insert(index, self._children.pop())

    def sort(self, *, key: Callable[[Any], Any], reverse: bool = False) -> None:
        """Sorts the members by a function of each.

        Args:
            key: The function.
            reverse: Whether greater values come first.
        """
        self._children.sort(key=key, reverse=reverse)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._children!r})"


class SceneGroup(SceneNode, Members):
    """Frames that move together: a list of its children, with a common pose."""

    def __init__(self, initlist: Iterable[SceneNode] | None = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.extend(initlist or ())

    def __getattr__(self, name: str) -> Any:
        if name == "copy":
            raise AttributeError(
                "A member is in one group only; make SceneGroup([shape.copy() for shape in group])."
            )
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
