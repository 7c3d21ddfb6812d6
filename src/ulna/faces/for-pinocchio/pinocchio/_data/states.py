"""What a Data knows of its contents: the states they belong to, and what is computed only when it is read.

Every field has a mark: 0 where it is filled, the number of the algorithm that left it to be computed when it is read
(or that spoils it), -1 where it waits in `Data._waiting`. Bound algorithms write the marks of all they touch.
"""

from __future__ import annotations

from collections.abc import Container
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from pinocchio._data.binding import ALGORITHMS, Algorithm, Runs, kept_by
from pinocchio._data.deferred_fields import FILLED_BY, OWN
from pinocchio._data.storage import PER_JOINT, Blocks
from pinocchio._model.kernel_parameters import NAMES
from ulna.errors import InputError
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._data.data import Data
    from pinocchio._data.deferred_fields import Late
    from pinocchio._model.kernels import Engine
    from pinocchio._model.model import Model

STATES = {
    "places": "q",
    "own": "q",
    "moving": "qv",
    "speeds": "qv",
    "gains": "qva",
    "jacobians": "q",
    "rates": "qv",
    "derivatives": "qva",
    "aba": "qva",
}
"""What results are of: of `oMi`, of joints' placements, of joints' velocities, of `v`, of `a`, of `J`, of `dJ`, of
derivatives, of accelerations that torques gave."""
_WAITS = -1.0


class Waiting(NamedTuple):
    """Fields that are computed with the kernels of an earlier moment, or under forces."""

    late: Late
    engine: Engine
    state: tuple[Floats, ...]


class States:
    """What of a Data is about its states."""

    slots: ClassVar[dict[str, int]]
    """Where the mark of a field is."""

    _blocks: Blocks
    _marks: Any
    _marked: Floats
    _waiting: dict[str, Waiting]
    _layout: Any
    _model: Model
    _engine: Engine | None
    _run: Runs
    _told: dict[int, Engine]
    _run_at: dict[Any, Any]
    _ties: list[Any]
    _known: set[str]
    _q: Any
    _qv: Any
    _qva: Any
    _q_of_joints: Any
    _qv_of_joints: Any
    _q_of_jacobians: Any
    _qv_of_jacobians: Any
    _of_derivatives: Any
    _of_forward: Any

    def target(self, name: str) -> Floats:
        """Where an algorithm writes: the array of that name, of the joints but the universe, of the whole robot."""
        if name in PER_JOINT:
            return self._blocks[name][1:]
        return self._blocks[name[:-3]][0] if name.endswith("[0]") else self._blocks[name]

    def mark_of(self, field: str) -> Floats:
        """Where the mark of a field is written."""
        k = self.slots[field]
        return self._marked[k : k + 1].reshape(())

    def attach(self, model: Model) -> Engine:
        """The kernels of the model's present numbers; what was bound to others is let go.

        Raises:
            InputError: see `engine_for`.
        """
        engine, before = engine_for(model, self), self._engine
        if engine is not before or model is not self._model:
            told = before is not None and engine.kernels is before.kernels  # other numbers alone
            self._hold(self._told if told else ())
            if not told:
                self._run, self._run_at, self._told = Runs(), {}, {}
            self._engine, self._model, self._ties = engine, model, []
        return engine

    def _hold(self, but: Container[int]) -> None:
        """What is left to be computed stays of the kernels and the state it was left of; not of algorithms in `but`."""
        for field, slot in self.slots.items():
            number = int(self._marks[slot])
            if number > 0 and number not in but and (late := ALGORITHMS[number - 1].late.get(field)):
                engine = self._engine_of(number)
                state = (x.copy() for x in self._state_of(number, late))
                self.leave(late, self._left_by(number, late), engine and engine.copied(), *state)

    def keeps(self, engine: Engine, algorithm: Algorithm) -> tuple[tuple[str, ...], list[Floats]]:
        """The names of the numbers that an algorithm is told at every call, and where it keeps them for late fields."""
        kept = () if not algorithm.late else NAMES if algorithm.on == "numbers" else NAMES[:1]
        if engine.names and algorithm.number not in self._told:
            self._told[algorithm.number] = engine.copied()
        told = self._told.get(algorithm.number, engine)
        return kept, told.among(kept)

    def _engine_of(self, number: int) -> Engine | None:
        """The kernels, and the numbers, that an algorithm left late fields of."""
        return self._told.get(number, self._engine)

    def _left_by(self, number: float, late: Late) -> tuple[str, ...]:
        """The fields that an algorithm left to be computed together."""
        fields = (field for field, other in ALGORITHMS[int(number) - 1].late.items() if other is late)
        return tuple(field for field in fields if self._marks[self.slots[field]] == number)

    def _state_of(self, number: float, late: Late) -> tuple[Floats, ...]:
        return tuple(self.target(f"{ALGORITHMS[int(number) - 1].name} {x}") for x in late.inputs)

    def leave(self, late: Late, fields: tuple[str, ...], engine: Any, *state: Floats) -> None:
        """Leaves fields to be computed when they are read; `state` is kept, and is copied by whom it belongs to."""
        waiting = Waiting(late, engine, state)
        for field in fields:
            self._waiting[field] = waiting
            self._marks[self.slots[field]] = _WAITS

    def moved(self, engine: Engine, q: Floats, v: Floats | None = None) -> None:
        """Leaves the joints' own placements to be computed, and tells where and how fast they are."""
        self.leave(OWN["liMi"], ("liMi",), engine, q.copy())
        self._q_of_joints = q
        if v is not None:
            self._qv_of_joints = q, v

    def knows(self, algorithm: Algorithm) -> None:
        """Remembers which states an algorithm leaves."""
        names = (*algorithm.targets, *kept_by(algorithm))
        self._known.update(name.split()[0] for name in names if " " in name)

    def written(self, *fields: str) -> None:
        """Fields that were filled just now."""
        for field in fields:
            self._marks[self.slots[field]] = 0.0

    def spoil(self, algorithm: Algorithm) -> None:
        """Marks what an algorithm spoils that is not bound."""
        for field in algorithm.spoils:
            self._marks[self.slots[field]] = float(algorithm.number)

    def read(self, field: str) -> None:
        """Computes what was left to be computed until it is read.

        Raises:
            InputError: the last algorithm left an intermediate step there in Pinocchio, and nothing here.
        """
        number = self._marks[self.slots[field]]
        if number == 0.0:
            return
        if number == _WAITS:
            waiting = self._waiting[field]
            late, engine, state = waiting
            fields = tuple(f for f, other in self._waiting.items() if other is waiting)
            fields = tuple(f for f in fields if self._marks[self.slots[f]] == _WAITS)
        else:
            algorithm = ALGORITHMS[int(number) - 1]
            late = algorithm.late.get(field)
            if late is None:
                raise InputError(
                    f"`data.{field}` is not what it was before {algorithm.title}, which leaves an intermediate step "
                    f"there in Pinocchio, and nothing here. Call {FILLED_BY[field]} first."
                )
            engine, fields = self._engine_of(int(number)), self._left_by(number, late)
            state = self._state_of(number, late)
        late.fill(self, engine, fields, *state)
        for one in fields:
            self._marks[self.slots[one]] = 0.0
            self._waiting.pop(one, None)
        if "v" in fields:
            self._qv = state[:2]
        if "a" in fields:
            self._qva = state[:3]

    def settle(self) -> None:
        """Computes all that was left to be computed; what is spoiled stays so."""
        for field, slot in self.slots.items():
            number = self._marks[slot]
            if number and (number == _WAITS or field in ALGORITHMS[int(number) - 1].late):
                self.read(field)

    def require(self, what: Any, mend: str) -> Any:
        """`what`, a state that an earlier algorithm leaves.

        Raises:
            InputError: it has not been left yet.
        """
        if what is None:
            raise InputError(f"This Data holds nothing to answer from yet. Call {mend} first.")
        return what


_OF_LATE = {"speeds": "v", "gains": "a"}


def _left(name: str) -> property:
    """What results are of: an array, or several in a tuple; None until an algorithm has left them."""
    keys = [f"{name} {x}" for x in STATES[name]]

    def get(self: States) -> Any:
        if name in _OF_LATE:
            self.read(_OF_LATE[name])
        if name not in self._known:
            return None
        return self._blocks[keys[0]] if len(keys) == 1 else tuple(self._blocks[key] for key in keys)

    def put(self: States, value: Any) -> None:
        self._known.add(name)
        for key, values in zip(keys, (value,) if len(keys) == 1 else value, strict=True):
            self._blocks[key][...] = values

    return property(get, put)


for _name, _of in {
    "_q": "places",
    "_qv": "speeds",
    "_qva": "gains",
    "_q_of_joints": "own",
    "_qv_of_joints": "moving",
    "_q_of_jacobians": "jacobians",
    "_qv_of_jacobians": "rates",
    "_of_derivatives": "derivatives",
    "_of_forward": "aba",
}.items():
    setattr(States, _name, _left(_of))


def engine_for(model: Model, data: States) -> Engine:
    """The kernels of the model's present numbers, when the Data fits the model.

    Raises:
        InputError: joints were added since the Data was made, or it was made for another robot.
    """
    if data._layout is not model._layout and data._layout != model._layout:
        raise InputError(
            f"This Data was made for a model of {len(data._layout)} joints that are not those of the model, which "
            f"now has {model.njoints}. Make a new one: data = model.createData()."
        )
    return model.engine()


def frames_fit(model: Model, data: Data) -> None:
    """Raises InputError when frames were added since the Data was made."""
    if data.nframes != len(model.frames):
        raise InputError(
            f"This Data was made when the model had {data.nframes} frames; now it has {model.nframes}. "
            "Make a new one: data = model.createData() (robot.rebuildData() for a RobotWrapper)."
        )
