"""Large kernels: estimated before they are traced, announced, refused above a limit."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna import compiler, kernels
from ulna.algorithms.multibody import link_frames
from ulna.compiler import trace
from ulna.errors import InputError, TooLargeError
from ulna.model import Model, ModelBuilder, PointContact, Revolute
from ulna.quantities import QUANTITIES, size
from ulna.quantities.size import estimated_nodes
from ulna.spatial import SE3, Inertia

BODY = Inertia.from_com(1.0, (0.05, -0.02, 0.08), np.diag([0.1, 0.2, 0.15]))
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def chain(n: int, parent: str = "before") -> Model:
    """A chain of n revolute joints, or a star of n joints on one that turns."""
    builder = ModelBuilder(f"{parent}{n}").add_link("l0")
    for k in range(1, n + 1):
        on = f"l{k - 1}" if parent == "before" else "l1" if k > 1 else "l0"
        builder.add_link(f"l{k}", BODY)
        place = SE3.trans(0.1, 0.02 * k, 0.03) @ SE3.rx(0.3 + 0.01 * k)
        builder.add_joint(f"j{k}", Revolute(AXES[k % 3]), on, f"l{k}", place)
    return builder.build()


UNBOUND = sorted(
    name
    for name, quantity in QUANTITIES.items()
    if quantity.nodes[0] != 120.0 and "constraints" not in quantity.options
)
QUICK = ("fk", "inverse_dynamics", "mass_matrix", "gravity_forces")


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in UNBOUND]
)
def test_the_estimate_is_about_the_number_of_nodes(name: str) -> None:
    for model, largest in ((chain(12), 1.5), (ulna.load("panda").model, 2.5)):
        nodes = len(kernels.function(model, name).graph)
        assert 0.7 < estimated_nodes(model, QUANTITIES[name], {}) / nodes < largest


def test_a_frame_counts_the_joints_that_carry_it() -> None:
    star = chain(50, "star")
    assert estimated_nodes(star, QUANTITIES["fk"], {"frame": "l50"}) == 2 * 58
    assert estimated_nodes(star, QUANTITIES["fk"], {"frame": "all"}) == 50 * 58
    assert estimated_nodes(star, QUANTITIES["fk"], {"frame": ("l49", "l50")}) == 3 * 58


def test_what_is_too_large_is_refused_before_it_is_traced(monkeypatch: pytest.MonkeyPatch) -> None:
    model = chain(500)
    monkeypatch.setattr(compiler, "trace", lambda *_, **__: pytest.fail("it is traced"))
    with pytest.raises(
        TooLargeError, match=r"joint_torque_regressor of 'before500' .* s and .* GB.* ULNA_MOST_OPERATIONS"
    ):
        kernels.kernel(model, "joint_torque_regressor", parameters="placement")
    monkeypatch.setenv("ULNA_MOST_OPERATIONS", "0")
    with pytest.raises(pytest.fail.Exception, match="it is traced"):
        kernels.kernel(model, "joint_torque_regressor", parameters="placement")


def test_the_limit_can_be_set(monkeypatch: pytest.MonkeyPatch) -> None:
    model = chain(8)
    monkeypatch.setenv("ULNA_MOST_OPERATIONS", "400")
    with pytest.raises(TooLargeError, match="the limit is 400"):
        kernels.function(model, "mass_matrix")
    assert kernels.function(model, "gravity_forces").operations
    monkeypatch.setenv("ULNA_MOST_OPERATIONS", "many")
    with pytest.raises(InputError, match="'many'"):
        kernels.function(model, "gravity_forces")


def test_a_function_of_the_user_ends_at_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ULNA_MOST_OPERATIONS", "1000")

    def endless(q):
        while True:
            q = q * 1.1 + 1.0

    with pytest.raises(TooLargeError, match="1,000 operations so far"):
        trace(endless, q=())


def test_long_tracing_is_announced(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("ULNA_QUIET", raising=False)
    kernels.function(chain(8), "mass_matrix")
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(size, "SECONDS", 0.1)
    kernels.function(chain(8), "mass_matrix")
    said = capsys.readouterr().err
    assert "ulna: tracing mass_matrix of 'before8' (about 1,200 operations), about 37 s" in said


def test_a_second_form_is_not_announced_as_if_the_graph_were_traced(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("ULNA_QUIET", raising=False)
    monkeypatch.setattr(size, "SECONDS", 0.1)
    kernels.kernel(chain(14), "inverse_mass_matrix")
    assert "tracing" not in capsys.readouterr().err
    monkeypatch.setenv("ULNA_MOST_OPERATIONS", "400")
    with pytest.raises(TooLargeError, match="the limit is 400"):
        kernels.kernel(chain(15), "inverse_mass_matrix")


def test_a_wide_robot_takes_linear_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """The number of children whose placements are tried for a frame is bounded."""
    counts = []
    absorbed = link_frames._absorbed
    for n in (20, 40):
        calls: list[int] = []
        monkeypatch.setattr(
            link_frames, "_absorbed", lambda *a, seen=calls: (seen.append(1), absorbed(*a))[1]
        )
        link_frames.choose_link_frames(chain(n, "star"))
        counts.append(len(calls))
    assert counts[1] < 2.2 * counts[0]


@pytest.mark.parametrize("name", ["constrained_dynamics", "impulse_dynamics", "delassus_matrix"])
def test_the_estimate_under_constraints_is_about_the_number_of_nodes(name: str) -> None:
    for n in (8, 24):
        options = {"constraints": (PointContact(f"l{n}"),)}
        model = chain(n)
        nodes = len(kernels.function(model, name, **options).graph)
        assert 0.7 < estimated_nodes(model, QUANTITIES[name], options) / nodes < 1.1
