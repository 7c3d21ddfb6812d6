"""Frame: a named placement on a joint."""

from __future__ import annotations

from typing import Any, final

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import NO_INDEX, index
from pinocchio._containers.attributes import one_of, text
from pinocchio._containers.enums import FrameType
from pinocchio._containers.files import register
from pinocchio._containers.keywords import by_name, reads_names
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3, HasPlacement, as_placement
from ulna.errors import excerpt
from ulna.typing import Array

Facts = tuple[str, FrameType, int, int, Inertia]
"""Name, type, indices of the joint and of the frame before it, and the inertia that a frame was made with."""
_new = object.__new__
JOINT_FRAMES = (FrameType.JOINT, FrameType.FIXED_JOINT)
"""The types of frames that joints have."""


_frame_type = one_of(FrameType, "a FrameType, such as OP_FRAME")
_inertia_of_frame = one_of(Inertia)


def _index_of(value: Any, what: str) -> int:
    """An index that a frame refers to; the model need not have it yet."""
    return index(value, NO_INDEX + 1, what, f"model.get{what.capitalize()}Id(name) returns one.")


_ORDERS = (
    "name parent_joint placement type inertia",
    "name parent_joint parent_frame placement type inertia",
    "other",
    "clone",
)
_NOTHING = Inertia()
"""The inertia of frames that were made without one: it never changes."""


@final
class Frame(HasPlacement):
    """`Frame(name, parentJoint, parentFrame, placement, type, inertia)`; parent frame and inertia may be left out."""

    __slots__ = ("_counters", "_facts", "_inertia", "_placement")

    @reads_names(*_ORDERS)
    def __init__(self, *parts: Any, **named: Any) -> None:
        count = 0 if named else len(parts)
        if count == 5:
            name, joint, frame, placement, type_ = parts
        elif count == 4:
            (name, joint, placement, type_), frame = parts, 0
        elif count == 1 and type(parts[0]) is Frame:
            facts, placement = parts[0]._facts_now(), parts[0]._placement
            self._facts, self._placement, self._inertia, self._counters = facts, placement.copy(), None, ()
            return
        else:
            self._set(*parts, **named)
            return
        is_usual = type(name) is str and type(placement) is SE3 and type(type_) is FrameType
        if is_usual and type(joint) is type(frame) is int and 0 <= joint <= NO_INDEX >= frame >= 0:
            self._facts, self._placement = (name, type_, joint, frame, _NOTHING), placement.copy()
            self._inertia, self._counters = None, ()
        else:
            self._set(*parts)

    @by_name(*_ORDERS)
    def _set(self, *parts: Any) -> None:
        """Sets a new instance to what it is made of."""
        if len(parts) == 1 and isinstance(parts[0], Frame):
            parts = parts[0]._parts()
        values = [as_placement(part) for part in parts]
        if len(values) > 2 and isinstance(values[2], SE3):
            values.insert(2, 0)
        if len(values) > 6:
            raise ArgumentError(
                f"Frame was given {parts}; expected name, parent_joint, parent_frame (or none), placement, type, "
                "inertia."
            )
        default: Any = ("", 0, 0, None, FrameType.OP_FRAME, None)
        name, joint, frame, placement, type_, inertia = (*values, *default[len(values) :])
        placement = SE3() if placement is None and len(values) < 4 else placement
        name, type_ = text(self, "name", name), _frame_type(self, "type", type_)
        if not isinstance(placement, SE3):
            raise ArgumentError(f"The placement of a frame is {placement!r}; expected an SE3.")
        joint, frame = _index_of(joint, "joint"), _index_of(frame, "frame")
        self._placement = SE3(placement)
        as_made = Inertia() if inertia is None and len(values) < 6 else Inertia(inertia)
        self._facts: Facts = name, type_, joint, frame, as_made
        self._inertia: Inertia | None = None
        self._counters: tuple[Array, ...] = ()

    def _add_counter(self, counter: Array) -> None:
        """Counts changes of its name, type and joint in an array (1,), as each model with this frame does."""
        if not any(known is counter for known in self._counters):
            self._counters = (*self._counters, counter)

    def _count_change(self) -> None:
        for counter in self._counters:
            counter[0] += 1

    def _parts(self) -> tuple[Any, ...]:
        name, type_, joint, frame, as_made = self._facts
        return name, joint, frame, self._placement, type_, as_made if self._inertia is None else self._inertia

    @property
    def name(self) -> str:
        """Its name."""
        return self._facts[0]

    @name.setter
    def name(self, name: str) -> None:
        self._facts = text(self, "name", name), *self._facts[1:]
        self._count_change()

    @property
    def type(self) -> FrameType:
        """What it belongs to."""
        return self._facts[1]

    @type.setter
    def type(self, type_: FrameType) -> None:
        name, _, joint, frame, inertia = self._facts
        self._facts = name, _frame_type(self, "type", type_), joint, frame, inertia
        self._count_change()

    @property
    def parentJoint(self) -> int:
        """The index of the joint it moves with."""
        return self._facts[2]

    @parentJoint.setter
    def parentJoint(self, joint: int) -> None:
        name, type_, _, frame, inertia = self._facts
        self._facts = name, type_, _index_of(joint, "joint"), frame, inertia
        self._count_change()

    @property
    def parentFrame(self) -> int:
        """The index of the frame before it."""
        return self._facts[3]

    @parentFrame.setter
    def parentFrame(self, frame: int) -> None:
        name, type_, joint, _, inertia = self._facts
        self._facts = name, type_, joint, _index_of(frame, "frame"), inertia
        self._count_change()

    parent, previousFrame = parentJoint, parentFrame

    @property
    def inertia(self) -> Inertia:
        """What it added to its joint's body, in its own frame, a live reference."""
        if self._inertia is None:  # copies of a frame share the other one, which nobody else sees
            self._inertia = self._facts[4].copy()
            self._count_change()  # from now on it may change without being counted
        return self._inertia

    @inertia.setter
    def inertia(self, inertia: Inertia) -> None:
        _inertia_of_frame(self, "inertia", inertia)

    def _assign(self, other: Frame) -> None:
        if not isinstance(other, Frame):
            raise ArgumentError(f"A frame was given {excerpt(repr(other))}; expected a pinocchio.Frame.")
        self._facts = (*other._facts[:4], self._facts[4])
        self._placement._assign(other.placement)
        self.inertia._assign(other.inertia)
        self._count_change()

    def copy(self) -> Frame:
        """A copy."""
        return Frame._from_facts(self._facts_now(), self._placement.copy())

    def _facts_now(self) -> Facts:
        """All of it but its placement, which copies share."""
        return self._facts if self._inertia is None else (*self._facts[:4], self._inertia.copy())

    @staticmethod
    def _from_facts(facts: Facts, placement: SE3, counters: tuple[Array, ...] = ()) -> Frame:
        """A frame that holds this placement, and counts its changes."""
        out = _new(Frame)
        out._facts, out._placement, out._counters, out._inertia = facts, placement, counters, None
        return out

    __copy__ = cast = copy

    def __deepcopy__(self, memo: Any) -> Frame:
        return self.copy()

    def __reduce__(self) -> Any:
        return Frame, self._parts()

    def __eq__(self, other: object) -> bool:
        return self._parts() == other._parts() if isinstance(other, Frame) else NotImplemented

    __hash__ = object.__hash__

    def __str__(self) -> str:
        return (
            f"Frame name: {self.name} paired to (parent joint/ parent frame)({self.parentJoint}/{self.parentFrame})\n"
            f"with relative placement wrt parent joint:\n{self.placement}containing inertia:\n{self._parts()[-1]}\n"
        )

    __repr__ = __str__


register(Frame, FrameType)
