"""Calls of `joint.calc` that run no Python: the second one like another leaves a table of what it computes with."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._containers.arguments import checked
from pinocchio._model.joint_data import JointData
from pinocchio._model.joint_state import joint_state, joint_tree
from ulna.compiler.runtime.procedure_method import Calls, Slot, has_machine_code, procedure_method
from ulna.typing import Array


@final
class JointCalls:
    """What calls of one joint were like, and their tables; see `procedure_method`."""

    __slots__ = ("_alive", "_kinds", "_made")

    def __init__(self) -> None:
        self._kinds: dict[int, Any] = {}
        self._made: dict[int, Calls] = {}
        self._alive: list[Any] = []

    def note(self, joint: Any, *arguments: Any) -> None:
        """Notes a call of `calc`.

        Args:
            joint: The joint.
            *arguments: The data, q, and v if it was given.
        """
        jdata, *arrays = arguments
        if not all(type(x) is np.ndarray and x.dtype == float and x.ndim == 1 for x in arrays):
            return
        count, kind = len(arguments), (type(jdata), *(x.shape for x in arrays))
        if self._kinds.get(count) != kind:
            self._kinds[count] = kind
            if self._made.pop(count, None) is not None:
                self._chain(joint)
        elif count not in self._made:
            self._made[count] = _calls_like(joint, jdata, *arrays)
            self._chain(joint)

    def _chain(self, joint: Any) -> None:
        """Gives the joint the tables of calls with and without a velocity."""
        self._alive, first = [], None
        for calls in self._made.values():
            table, alive = calls.table(first)
            self._alive += [first, alive]
            first = table
        joint._know(_calls=first)


def _calls_like(joint: Any, jdata: JointData, q: Array, v: Array | None = None) -> Calls:
    _, scaling, offset = joint.mimic or (0, 1.0, 0.0)
    tree, places = joint_tree(joint.kind, scaling, offset), (max(joint.idx_q, 0), max(joint.idx_v, 0))
    arrays = np.zeros(q.shape), np.zeros(joint.kind.nv if v is None else v.shape)
    run = joint_state.bind(tree, *arrays, np.zeros(jdata._block.shape), *places, int(v is not None))
    calls = Calls(run, (joint, jdata, q) if v is None else (joint, jdata, q, v), returns_none=True)
    calls.expect_kind(1)
    calls.take_array(Slot(1, "_block"), "out", True)
    calls.take_array(Slot(2), "q")
    if v is not None:
        calls.take_array(Slot(3), "v")
    return calls


def repeated(kind: Any) -> Any:
    """Has `calc` of a class of joints run without Python where a call like it was made before.

    Args:
        kind: The class.

    Returns:
        The class.
    """
    kind.calc = procedure_method(checked(kind.calc), kind, "_calls")
    kind._repeats = has_machine_code(kind, "calc")
    return kind
