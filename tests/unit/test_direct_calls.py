"""Methods of a robot once their kernels are there: called by machine code, and otherwise what they were."""

from __future__ import annotations

import copy
import functools
import inspect
import os
import pickle
import pydoc
import subprocess
import sys
import threading
import types
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest

import ulna
from ulna.compiler.runtime.kernel import native_type
from ulna.quantities import THEMES
from ulna.quantities.direct_calls import THREAD

Q, V, W = np.linspace(0.1, 0.7, 7), np.linspace(-0.3, 0.3, 7), np.linspace(2.0, -1.0, 7)
CALLS: list[tuple[str, tuple, dict[str, Any]]] = [
    ("fk", (Q,), {}), ("fk", (Q, "panda_hand"), {}), ("fk", (Q,), {"frame": "panda_hand"}), ("fk", (Q, "all"), {}),
    ("fk", (Q, ["panda_hand", "panda_link3"]), {}), ("fk", (Q, "pando_hand"), {}), ("fk", (Q, 3), {}), ("fk", (), {}),
    ("jacobian", (Q,), {}), ("jacobian", (Q, "panda_hand", "world"), {}), ("jacobian", (Q,), {"reference": "local"}),
    ("jacobian", (Q, None, "Local"), {}), ("jacobian", (Q,), {"frames": None}), ("mass_matrix", (list(Q),), {}),
    ("mass_matrix", (np.stack([Q, V]),), {}), ("mass_matrix", (Q[:5],), {}), ("mass_matrix", (Q * np.nan,), {}),
    ("inverse_dynamics", (Q, V, W), {}), ("inverse_dynamics", (Q, V, W, {"panda_hand": [0, 0, 1, 0, 0, 0]}), {}),
    ("inverse_dynamics", (Q, V), {"a": W, "friction": True}), ("inverse_dynamics", (Q, V, W, {}, "worlds"), {}),
    ("forward_dynamics", (Q, V, W), {}), ("forward_dynamics", (Q, V, W), {"friction": "no"}),
    ("manipulability", (Q,), {}), ("manipulability", (Q, "asada"), {}), ("manipulability", (Q,), {"axes": "trans"}),
    ("center_of_mass", (Q, "panda_joint3"), {}), ("center_of_mass", (Q,), {"subtree": "panda_joint99"}),
]  # fmt: skip


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    robot = ulna.load("panda", visuals="simple")
    robot.fk(Q)
    for thread in threading.enumerate():  # that compiles what all methods share, where the cache is empty
        if thread.name == THREAD:
            thread.join()
    return robot


def outcome(f: Any, *args: Any, **named: Any) -> Any:
    try:
        return np.asarray(f(*args, **named)).tobytes()
    except Exception as error:
        return type(error), str(error)


@pytest.mark.parametrize("call", CALLS)
def test_calls_have_the_outcome_of_the_function(
    panda: ulna.Robot, call: tuple[str, tuple, dict[str, Any]]
) -> None:
    name, args, named = call
    expected = outcome(getattr(panda, name), *args, **named)  # runs Python, and makes the kernel
    assert outcome(inspect.getattr_static(panda, name), panda, *args, **named) == expected


@pytest.mark.skipif(native_type() is None, reason="kernels are not called by machine code here")
def test_known_kernels_are_called_without_python(panda: ulna.Robot) -> None:
    hand = panda.fk(Q, "panda_hand")
    panda.inverse_dynamics(Q, V, W), panda.derivatives.jacobian(Q), panda.fk(Q)
    panda.fk(Q, out=np.zeros((4, 4)))  # what writes into `out` is compiled at its first use
    names: list[str] = []
    sys.setprofile(lambda frame, event, _: names.append(frame.f_code.co_name) if event == "call" else None)
    try:
        T, again = np.zeros((4, 4)), panda.fk(Q, frame="panda_hand")
        pose = panda.fk(Q, out=T)
        panda.inverse_dynamics(Q, V, W), panda.derivatives.jacobian(Q)
    finally:
        sys.setprofile(None)
    assert names == [] and pose is T
    np.testing.assert_array_equal(again, hand)
    np.testing.assert_array_equal(T, panda.kernel("fk")(Q))


def test_methods_stay_functions_with_their_documentation(panda: ulna.Robot) -> None:
    for theme in THEMES:
        for name, member in list(vars(theme).items()):
            if hasattr(member, "quantity"):
                function = getattr(theme, name)
                assert inspect.isfunction(function) and function.quantity is member.quantity
                assert inspect.signature(member) == inspect.signature(function)
    before = pydoc.render_doc(panda.fk), pydoc.render_doc(ulna.Robot.jacobian), dir(ulna.Robot)
    panda.fk(Q), panda.jacobian(Q), panda.fk(Q)
    assert (pydoc.render_doc(panda.fk), pydoc.render_doc(ulna.Robot.jacobian), dir(ulna.Robot)) == before
    assert panda.fk == panda.fk and panda.fk.__self__ is panda


def test_two_robots_call_their_own_kernels(panda: ulna.Robot) -> None:
    other = ulna.load("ur5", visuals="simple")
    q = Q[:6]
    for _ in range(3):
        assert panda.fk(Q).tobytes() == panda.kernel("fk")(Q).tobytes()
        assert other.fk(q).tobytes() == other.kernel("fk")(q).tobytes()
        assert other.fk(q, "wrist_1_link").tobytes() == other.kernel("fk", frame="wrist_1_link")(q).tobytes()


def test_a_kernel_that_is_there_stays_when_another_thread_has_made_it_too() -> None:
    """Machine code calls it without a reference of its own."""
    robot = ulna.load("ur5", visuals="simple")
    table: Any = robot._kernel_table
    for options in ((), ("wrist_1_link",)):
        first = table.make("fk", *options)
        assert table.make("fk", *options) is first
    assert robot._kernels.fk is table.make("fk") is table.by_options["fk"][None]


def test_with_an_empty_cache_the_first_call_does_not_wait_for_it(tmp_path: Path) -> None:
    script = """
import threading, numpy as np, ulna
from ulna.quantities.direct_calls import THREAD
robot = ulna.load("panda", visuals="simple")
robot.fk(np.zeros(7))
at_work = [thread for thread in threading.enumerate() if thread.name == THREAD]
for thread in at_work:
    thread.join()
robot.jacobian(np.zeros(7))
owners = {name: [c for c in type(robot).__mro__ if name in vars(c)][0] for name in ("fk", "jacobian")}
print(len(at_work), *(type(vars(owner)[name]).__name__ for name, owner in owners.items()))
"""
    environment = {**os.environ, "ULNA_CACHE": str(tmp_path)}
    outputs = [
        subprocess.run(
            [sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(2)
    ]
    what = ["method_call"] * 2 if native_type() is not None else ["function"] * 2
    assert outputs[1] == ["0", *what] and outputs[0][1:] == what and outputs[0][0] in "01"


def test_wrappers_of_methods_are_called_at_every_call(
    panda: ulna.Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`functools.wraps` copies the attributes by which methods are recognised."""

    class Doubled(ulna.Robot):
        @functools.wraps(ulna.Robot.mass_matrix)
        def mass_matrix(self, q: Any) -> Any:
            return 2.0 * super().mass_matrix(q)

    doubled, count, original = Doubled(panda.model), 0, ulna.Robot.gravity_forces

    def counting(self: Any, q: Any) -> Any:
        nonlocal count
        count += 1
        return original(self, q)

    owner = next(kind for kind in ulna.Robot.__mro__ if "gravity_forces" in vars(kind))
    monkeypatch.setattr(owner, "gravity_forces", functools.wraps(original)(counting))
    for _ in range(4):
        np.testing.assert_allclose(doubled.mass_matrix(Q), 2.0 * panda.mass_matrix(Q))
        panda.gravity_forces(Q)
    ulna.load("ur5", visuals="simple").gravity_forces(Q[:6])
    assert count == 5


def test_methods_in_class_dictionaries_are_mocked_and_copied_as_functions(panda: ulna.Robot) -> None:
    """`unittest.mock` looks into these: once a method was called, it took the instance for the first argument."""
    panda.fk(Q), panda.fk(Q)
    expected = panda.fk(Q).tobytes()
    method, function = inspect.getattr_static(ulna.Robot, "fk"), ulna.Robot.fk
    assert isinstance(method, types.FunctionType)
    assert mock.create_autospec(ulna.Robot, instance=True).fk(Q) is not None
    owner = next(kind for kind in ulna.Robot.__mro__ if "fk" in vars(kind))
    for kind in (ulna.Robot, owner):
        with mock.patch.object(kind, "fk", autospec=True, return_value=5) as fake:
            assert panda.fk(Q) == 5
            fake.assert_called_once_with(panda, Q)
    assert panda.fk(Q).tobytes() == expected
    for copied in (copy.copy(method), copy.deepcopy(method), pickle.loads(pickle.dumps(method))):
        assert copied is function
    for bound in (
        copy.copy(panda.fk),
        functools.partial(ulna.Robot.fk, panda),
        pickle.loads(pickle.dumps(panda.fk)),
    ):
        assert bound(Q).tobytes() == expected
