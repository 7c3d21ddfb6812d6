"""A model with another one on a frame of it: first which joint and frame is which, then its numbers."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import alike
from pinocchio._containers.named_configurations import StdMap_String_VectorXd
from pinocchio._model.frame import Facts, Frame
from pinocchio._model.model import Model
from pinocchio._model.skeleton import Skeleton, gathered, remembered, renumbered
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from ulna import algorithms
from ulna.errors import ModelError, ModelWarning
from ulna.typing import Floats


@final
class Part:
    """A model whose joints and frames another one takes up.

    Attributes:
        source: Its joints and frames.
        joints: The new index of each joint; of its universe, that of the joint which carries it.
        frames: The same of frames.
    """

    def __init__(self, source: Skeleton) -> None:
        self.source = source
        self.joints, self.frames = {0: 0}, {0: 0}


def appended_model(first: Model, second: Model, at: int, aMb: SE3) -> tuple[Model, Appended, SE3]:
    """A model with a second one on a frame of it.

    Args:
        first: The first model; its gravity is kept.
        second: The second one.
        at: Index of a frame of the first.
        aMb: Placement of the second one's world in that frame.

    Returns:
        The model, what became of the joints and frames of both, and the second one's world in the frame of its joint.
    """
    (skeleton, numbers), (other, its_numbers) = first._state_now(), second._state_now()
    made = _appended(skeleton, other, at)
    base = SE3._of(skeleton.row_blocks(numbers)[2][at]) * aMb
    made.place(its_numbers, base)
    whole = np.concatenate([numbers, its_numbers])
    if made.dropped:
        made.warn(whole)
    out = Model._made_of(made.skeleton, whole.take(made.index), made.layout)
    made.carry(out, its_numbers, base)
    out._keep(name="", nbodies=len(made.layout) + 2, nvExtended=made.nvExtended)
    _name_configurations(out, made, first, second)
    return out, made, base


_KNOWN: dict[Any, Appended] = {}


def _appended(first: Skeleton, second: Skeleton, at: int) -> Appended:
    key = at, first.names, second.names
    known = _KNOWN.get(key)
    if known is not None and known.is_of(first, second):
        return known
    return remembered(_KNOWN, key, Appended(first, second, at))


@final
class Appended:
    """What becomes of the joints and frames of two models, whatever their numbers.

    Attributes:
        parts: Both models.
        order: All joints in their new order, the universe of the second model included: the part and the index there.
        skeleton: The joints and frames of the new model.
        index: Which numbers of both models, one after the other, are those of the new one (n,).
        layout: See `KernelCache._layout`.
        nvExtended: How many velocities there are, those of mimic joints counted.
        dropped: Frames whose name and type another one has: the new index of that one, their facts, and where their
            placements begin among the numbers.
    """

    def __init__(self, first: Skeleton, second: Skeleton, at: int) -> None:
        carrier = first.frames[at][2]
        self.parts = part, other = Part(first), Part(second)
        moved = {carrier}  # the joints that the carrier moves; none are beside it before
        for i, parent in enumerate(first.parents):
            if i and parent in moved:
                moved.add(i)
        before = [i for i in range(1, len(first.names)) if i <= carrier or i in moved]
        after = [i for i in range(1, len(first.names)) if i not in set(before)]
        self.order = [
            *((part, i) for i in (0, *before)),
            *((other, i) for i in range(len(second.names))),
            *((part, i) for i in after),
        ]
        self.dropped: list[tuple[int, Facts, int]] = []
        self._rows = [(one, i) for one, i in self.order if one is part or i]
        for new, (one, i) in enumerate(self._rows):
            one.joints[i] = new
        other.joints[0], self._carrier = part.joints[carrier], part.joints[carrier]
        frames = self._frames()
        other.frames[0] = part.frames[at]
        self._facts = [self._tied(one, k) for one, k in frames]
        names = tuple(one.source.names[i] for one, i in self._rows)
        self._check_names(names)
        attributes = [(one.source.joints[i], one.joints) for one, i in self._rows]
        joints, self.layout, self.nvExtended = renumbered(attributes)
        of_q, of_v = self._entries("q"), self._entries("v")
        parents = tuple(one.joints[one.source.parents[i]] if i else 0 for one, i in self._rows)
        self.skeleton = Skeleton(names, parents, joints, tuple(self._facts), len(of_q), len(of_v))
        self.of_q, self.index = of_q, self._index(frames, of_q, of_v)
        self._on_base = [i for i, parent in enumerate(second.parents) if i and parent == 0]
        self._frames_on_base = [k for k, facts in enumerate(second.frames) if k and facts[2] == 0]

    def is_of(self, first: Skeleton, second: Skeleton) -> bool:
        """Whether it was made of the same joints and frames.

        Args:
            first: The joints and frames of a first model.
            second: Those of a second one.

        Returns:
            Whether it was.
        """
        return all(
            part.source.joints is one.joints
            and part.source.frames is one.frames
            and part.source.parents == one.parents
            for part, one in zip(self.parts, (first, second), strict=True)
        )

    def _frames(self) -> list[tuple[Part, int]]:
        """All frames in their new order; those of a joint follow each other."""
        of_joint: dict[tuple[Part, int], list[int]] = {}
        for part in self.parts:
            for k, facts in enumerate(part.source.frames):
                if k:
                    of_joint.setdefault((part, facts[2]), []).append(k)
        out = [(self.parts[0], 0)]
        places: dict[Any, int] = {self.parts[0].source.frames[0][:2]: 0}
        for part, i in self.order:
            for k in of_joint.get((part, i), ()):
                facts = part.source.frames[k]
                new = places.setdefault(facts[:2], len(out))
                part.frames[k] = new
                if new == len(out):
                    out.append((part, k))
                else:
                    self.dropped.append((new, facts, self._place_of(part, k)))
        return out

    def _tied(self, part: Part, k: int) -> Facts:
        """What is known of a frame in the new model; frames of joints have the universe before them."""
        name, type_, joint, before, inertia = part.source.frames[k]
        tied = part.frames[before] if k and (before or joint == 0) else 0
        return name, type_, part.joints[joint], tied, inertia

    @staticmethod
    def _check_names(names: tuple[str, ...]) -> None:
        seen = set[str]()
        for name in names:
            if name in seen:
                raise ModelError(f"There is a joint named {name!r} already. Give another name.")
            seen.add(name)

    def _entries(self, which: str) -> list[tuple[int, int]]:
        """For each entry of q or v of the new model, which model it is of, and its index there."""
        out: list[tuple[int, int]] = []
        for part, i in self._rows:
            joint = part.source.joints[i][1]
            if joint["kind"] is not None and joint["mimic"] is None:
                start = joint[f"idx_{which}"]
                number = 0 if part is self.parts[0] else 1
                out += [(number, k) for k in range(start, start + joint[f"n{which}"])]
        return out

    def _index(
        self, frames: list[tuple[Part, int]], of_q: list[tuple[int, int]], of_v: list[tuple[int, int]]
    ) -> Any:
        blocks, start = {}, 0
        for part in self.parts:
            places: Any = np.arange(start, start + _size_of(part.source))
            start += len(places)
            rows, arrays = part.source.row_blocks(places), part.source.array_blocks(places)
            blocks[part] = (*rows, *arrays, places[-6:])
        rows = [np.stack([blocks[part][k][i] for part, i in self._rows]) for k in (0, 1)]
        rows.append(np.stack([blocks[part][2][k] for part, k in frames]))
        per = [
            np.concatenate([blocks[self.parts[n]][k][:, i : i + 1] for n, i in entries], axis=1)
            if entries
            else np.zeros((blocks[self.parts[0]][k].shape[0], 0), int)
            for k, entries in ((3, of_q), (4, of_v))
        ]
        return gathered(rows, per, blocks[self.parts[0]][5])

    def _place_of(self, part: Part, k: int) -> int:
        """Where the placement of a frame begins among the numbers of both models."""
        start = 0 if part is self.parts[0] else _size_of(self.parts[0].source)
        return start + 29 * len(part.source.joints) + 16 * k

    def place(self, numbers: Floats, base: SE3) -> None:
        """Places what is on the second model's universe on the joint that carries it.

        Args:
            numbers: The numbers of the second model (n,), which are changed.
            base: Its world in the frame of that joint.
        """
        placements, _, frames = self.parts[1].source.row_blocks(numbers)
        for rows, of_base in ((placements, self._on_base), (frames, self._frames_on_base)):
            rows[of_base] = base._m @ rows[of_base]

    def carry(self, out: Model, numbers: Floats, base: SE3) -> None:
        """Adds the inertia of the second model's universe to the joint that carries it.

        Args:
            out: The new model.
            numbers: The numbers of the second one (n,).
            base: Its world in the frame of that joint.
        """
        added = Inertia._of(self.parts[1].source.row_blocks(numbers)[1][0])
        carrying = self.skeleton.row_blocks(out._numbers)[1][self._carrier]
        carrying[...] = (Inertia._of(carrying) + added.se3Action(base))._p

    def warn(self, numbers: Floats) -> None:
        """Says which frames are left out, unless they are the same as others; of both models' numbers (n,)."""
        for new, facts, start in self.dropped:
            kept = self._facts[new]
            place = numbers[start : start + 16].reshape(4, 4)
            if not alike(Frame._from_facts(facts, SE3._of(place)), Frame._from_facts(kept, SE3._of(place))):
                warnings.warn(
                    f"There is a {facts[1].name} frame named {facts[0]!r} already, which is another one; it stays. "
                    "Give another name.", ModelWarning, stacklevel=4,
                )  # fmt: skip


def _size_of(skeleton: Skeleton) -> int:
    """How many numbers a model of these joints and frames has."""
    joints, frames = len(skeleton.joints), len(skeleton.frames)
    return 29 * joints + 16 * frames + 3 * skeleton.nq + 10 * skeleton.nv + 6


def _name_configurations(out: Model, made: Appended, *models: Model) -> None:
    """Adds the named configurations of both; what a model has not is neutral."""
    names = dict.fromkeys(entry.key() for model in models for entry in model.referenceConfigurations)
    if not names:
        return
    neutral = algorithms.neutral(out._compiled_structure().model)
    out._configurations = StdMap_String_VectorXd()
    for name in names:
        q = neutral.copy()
        for place, (number, i) in enumerate(made.of_q):
            posture = models[number].referenceConfigurations.get(name)
            if posture is not None:
                q[place] = posture[i]
        out._configurations[name] = q


def joined_geometries(made: Appended, base: SE3, models: Iterable[Any]) -> Any:
    """The geometries of two models, in the order in which a model took up their joints.

    Their pairs are kept, and joined by all between them.

    Args:
        made: What became of the joints and frames.
        base: The second model's world in the frame of the joint that carries it.
        models: Their geometry models.

    Returns:
        The geometry model.
    """
    from pinocchio._geometry.collision_pair import CollisionPair

    of_part = dict(zip(made.parts, models, strict=True))
    whole = type(of_part[made.parts[0]])()
    places: dict[Part, dict[int, int]] = {part: {} for part in made.parts}
    for part, joint in made.order:
        for i, shape in enumerate(of_part[part].geometryObjects):
            if shape.parentJoint == joint:
                added = shape.copy()
                if joint == 0 and part is made.parts[1]:
                    added.placement = base * added.placement
                added.parentJoint = part.joints[joint]
                added.parentFrame = part.frames.get(added.parentFrame, added.parentFrame)
                places[part][i] = whole.ngeoms
                whole.addGeometryObject(added)
    pairs = [
        (places[part][i], places[part][j]) for part, one in of_part.items() for i, j in one.collisionPairs
    ]
    carriers = [shape.parentJoint for shape in whole.geometryObjects]
    ours, theirs = ([place[i] for i in sorted(place)] for place in places.values())
    between = [(i, j) for i in ours for j in theirs if carriers[i] != carriers[j]]
    for i, j in [*pairs, *between]:
        whole.collisionPairs.append(CollisionPair(i, j))
    return whole
