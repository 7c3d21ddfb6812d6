"""Searches of contact solvers that run without Python follow every change of what they are given."""

from __future__ import annotations

import copy
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


class _Search:
    """A problem of contacts, and a solver that has searched so often that searches run without Python."""

    def __init__(self, pin: Any, kind: str, count: int) -> None:
        self.pin, self.kind, self.rng = pin, kind, np.random.default_rng(count)
        self.model = pin.buildSampleModelManipulator()
        self.models, self.datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        self.models.extend([pin.PointContactConstraintModel(self.model, 3) for _ in range(count)])
        self.datas.extend([one.createData() for one in self.models])
        self.g = self.velocities()
        self.operator = pin.DelassusOperatorDense(self.matrix())
        self.settings = getattr(pin, f"{kind}SolverSettings")()
        self.result = getattr(pin, f"{kind}SolverResult")()
        self.solver = getattr(pin, f"{kind}ConstraintSolver")(3 * count)
        for _ in range(4):
            self.made()

    def matrix(self) -> Any:
        size = 3 * len(self.models)
        root = self.rng.normal(size=(size, size + 4))
        return root @ root.T / size + 0.1 * np.eye(size)

    def velocities(self) -> Any:
        """Of contacts that slide and close."""
        g = self.rng.normal(size=3 * len(self.models))
        g[2::3] = -abs(g[2::3])
        return g

    def made(self) -> bool:
        return self.solver.solve(self.operator, self.g, self.models, self.datas, self.settings, self.result)

    def functions_in_python(self) -> list[str]:
        names: list[str] = []
        sys.setprofile(
            lambda frame, event, _: names.append(frame.f_code.co_name) if event == "call" else None
        )
        try:
            self.made()
        finally:
            sys.setprofile(None)
        return names[1:]

    def answer(self, result: Any) -> list[Any]:
        said = [result.converged, result.iterations, result.problem_size, result.isValid()]
        numbers = ["primal_feasibility", "dual_feasibility", "complementarity"]
        if self.kind == "ADMM":
            numbers += ["rho", "mu_prox", "spectral_rho_power", "delassus_decomposition_update_count"]
        said += [getattr(result, name) for name in numbers]
        said += [result.retrieveConstraintImpulses().tolist(), result.retrieveConstraintVelocities().tolist()]
        result.retrieveDualSolution(dual := np.zeros(result.problem_size))
        return [*said, dual.tolist(), self.operator.getDamping().tolist() if self.kind == "ADMM" else None]

    def anew(self, guess: Any = None) -> list[Any]:
        """What a new solver, given copies in other classes of lists, says."""
        result, operator = type(self.result)(), copy.copy(self.operator)
        if guess is not None:
            result.setConstraintImpulseGuess(guess)
        type(self.solver)().solve(
            operator, self.g, tuple(self.models), tuple(self.datas), self.settings, result
        )
        found = self.answer(result)
        return [*found[:-1], operator.getDamping().tolist() if self.kind == "ADMM" else None]


@pytest.fixture(params=[("PGS", 1), ("PGS", 3), ("ADMM", 1), ("ADMM", 3)], ids=str)
def search(pin: Any, request: Any) -> _Search:
    return _Search(pin, *request.param)


def test_searches_are_made_without_python(search: _Search) -> None:
    if not type(search.solver)._serves:
        pytest.skip("machine code cannot be called in this way here")
    wanted = search.anew()
    assert not search.functions_in_python() and search.answer(search.result) == wanted
    search.operator, search.g = (
        search.pin.DelassusOperatorDense(search.matrix()),
        search.velocities(),
    )
    search.models, search.datas = type(search.models)(search.models), type(search.datas)(search.datas)
    list.__setitem__(search.models, slice(None), search.solver._key[3])
    wanted = search.anew()
    assert not search.functions_in_python() and search.answer(search.result) == wanted


def test_a_setting_that_is_set_again_slows_few_searches(search: _Search) -> None:
    if not type(search.solver)._serves:
        pytest.skip("machine code cannot be called in this way here")
    search.settings.max_iterations = search.settings.max_iterations
    assert search.functions_in_python() and search.functions_in_python()
    assert not search.functions_in_python() and search.answer(search.result) == search.anew()


def _frictions(search: _Search) -> None:
    for k, one in enumerate(search.models):
        one.setFriction(0.1 * k)


def _cones(search: _Search) -> None:
    search.models[0].set = search.pin.CoulombFrictionCone(0.125)


def _other_contact(search: _Search) -> None:
    other = search.pin.PointContactConstraintModel(search.model, 2)
    other.setFriction(0.01)
    list.__setitem__(search.models, 0, other)


def _other_kind(search: _Search) -> None:
    list.__setitem__(search.models, 0, search.pin.PointAnchorConstraintModel(search.model, 2))
    list.__setitem__(search.datas, 0, search.models[0].createData())


def _fewer(search: _Search) -> None:
    search.models.append(search.pin.PointContactConstraintModel(search.model, 1))
    search.datas.append(search.models[-1].createData())
    search.operator, search.g = (
        search.pin.DelassusOperatorDense(search.matrix()),
        search.velocities(),
    )


def _matrix(search: _Search) -> None:
    search.operator = search.pin.DelassusOperatorDense(search.matrix())


def _compliance(search: _Search) -> None:
    search.operator.updateCompliance(0.25)


def _damping(search: _Search) -> None:
    search.operator.updateDamping(np.linspace(0.1, 0.5, len(search.g)))


def _velocities(search: _Search) -> None:
    search.g[:] = search.velocities()


def _other_velocities(search: _Search) -> None:
    search.g = np.repeat(search.velocities(), 2)[::2]


def _few_iterations(search: _Search) -> None:
    search.settings.max_iterations = 1


def _tolerance(search: _Search) -> None:
    search.settings.absolute_feasibility_tol = search.settings.absolute_complementarity_tol = 1e-3


def _way(search: _Search) -> None:
    if search.kind == "PGS":
        search.settings.over_relaxation = 0.5
    else:
        search.settings.rho_init = 3.0


def _spectral(search: _Search) -> None:
    if search.kind == "ADMM":
        search.settings.admm_update_rule = search.pin.ADMMUpdateRule.SPECTRAL
        search.settings.spectral_rho_power_init = 0.3


def _other_settings(search: _Search) -> None:
    search.settings = type(search.settings)()
    search.settings.max_iterations = 2


def _reset(search: _Search) -> None:
    search.result.reset()


def _reset_solver(search: _Search) -> None:
    search.solver.reset()
    assert not search.solver.isValid()


def _recorded(search: _Search) -> None:
    search.settings.stat_record = True
    search.made()
    assert search.solver.stats.size() > 0
    search.settings.stat_record = False


def _measured(search: _Search) -> None:
    search.settings.measure_timings = True
    search.made()
    assert search.solver.getElapsedTime() > 0.0
    search.settings.measure_timings = False


CHANGES = [
    *(_frictions, _cones, _other_contact, _other_kind, _fewer, _matrix, _compliance, _damping, _velocities),
    *(
        _other_velocities,
        _few_iterations,
        _tolerance,
        _way,
        _spectral,
        _other_settings,
        _reset,
        _reset_solver,
    ),
    *(_recorded, _measured),
]


@pytest.mark.parametrize("change", CHANGES)
def test_searches_follow_all_changes(search: _Search, change: Any) -> None:
    before = search.answer(search.result)
    for _ in range(2):
        change(search)
        for _ in range(4):
            wanted = search.anew()
            assert search.made() == wanted[0]
            assert search.answer(search.result) == wanted
            assert search.solver.isValid() and search.solver.getElapsedTime() == 0.0
            assert search.solver.stats.size() == 0
    unseen = (_reset, _reset_solver, _recorded, _measured, _tolerance, _other_contact, _spectral)
    damps = change is _damping and search.kind == "ADMM"  # which does not count it
    assert search.answer(search.result) != before or change in unseen or damps


def test_searches_start_from_guesses_once(search: _Search) -> None:
    guess = np.tile([0.01, 0.02, 0.5], len(search.models))
    plain, started = search.anew(), search.anew(guess)
    assert plain != started
    for _ in range(3):
        search.result.setConstraintImpulseGuess(guess)
        search.made()
        assert search.answer(search.result) == started
        search.made()
        assert search.answer(search.result) == plain
        search.result.setConstraintImpulseGuess(guess)
        search.result.clearConstraintImpulseGuess()
        search.made()
        assert search.answer(search.result) == plain
    search.result.setConstraintImpulseGuess(guess)
    if type(search.solver)._serves:
        assert not search.functions_in_python()
    search.result.setConstraintImpulseGuess(np.zeros(len(guess) + 3))
    with pytest.raises(InputError, match="guess of the impulse"):
        search.made()


def test_a_guess_of_a_former_size_is_refused(search: _Search) -> None:
    search.result.setConstraintImpulseGuess(np.zeros(len(search.g)))
    _fewer(search)
    with pytest.raises(InputError, match="guess of the impulse"):
        search.made()


def test_wrong_arguments_are_refused_after_many_searches(search: _Search) -> None:
    right = (search.operator, search.g, search.models, search.datas, search.settings, search.result)
    wrong = {0: None, 1: search.g[:-1], 2: None, 3: list(search.datas)[:-1], 4: None, 5: None}
    for k, value in wrong.items():
        with pytest.raises((InputError, TypeError, ValueError)):
            search.solver.solve(*(value if k == j else x for j, x in enumerate(right)))
        assert search.made() == search.anew()[0]
    with pytest.raises(TypeError):
        search.solver.solve(*right[:-1])
    assert type(search.solver).solve(search.solver, *right) == search.anew()[0]
    names = ("delassus", "g", "constraint_models", "constraint_datas", "settings", "result")
    assert search.solver.solve(**dict(zip(names, right, strict=True))) == search.anew()[0]


def test_a_rule_without_a_factor_is_refused(pin: Any) -> None:
    search = _Search(pin, "ADMM", 2)
    search.settings.admm_update_rule = pin.ADMMUpdateRule.SPECTRAL
    for _ in range(3):
        search.made()
    search.operator, search.g = pin.DelassusOperatorDense(np.zeros((6, 6))), -np.ones(6)
    for _ in range(3):
        with pytest.raises(InputError, match="SPECTRAL"):
            search.made()


def test_rho_is_that_of_the_result(pin: Any) -> None:
    search = _Search(pin, "ADMM", 2)
    search.settings.warmstart_rho_with_previous_result = True
    for _ in range(4):
        search.result.rho = 7.0
        search.made()
        warm = search.answer(search.result)
        plain = type(search.settings)()
        plain.rho_init, plain.spectral_rho_power_init = 7.0, 0.2
        search.settings, kept = plain, search.settings
        assert search.anew()[:5] == warm[:5]
        search.settings = kept
    search.result.reset()
    search.made()
    search.settings.warmstart_rho_with_previous_result = False
    assert search.answer(search.result) == search.anew()


def test_copies_do_not_change_with_the_next_search(search: _Search) -> None:
    result, operator = copy.copy(search.result), copy.copy(search.operator)
    kept, damping = search.answer(result), operator.getDamping()
    _velocities(search)
    search.made()
    _matrix(search)
    search.made()
    assert search.answer(result)[:-1] == kept[:-1]
    assert np.array_equal(operator.getDamping(), damping)
    assert search.answer(search.result)[:-1] != kept[:-1]


def test_attributes_of_results_are_of_their_kinds(search: _Search) -> None:
    result = search.result
    assert type(result.converged) is bool and type(result.iterations) is int
    assert type(result.dual_feasibility) is float
    result.iterations, result.converged, result.dual_feasibility = 3, False, 0.5
    assert (result.iterations, result.converged, result.dual_feasibility) == (3, False, 0.5)
    with pytest.raises(TypeError):
        result.iterations = "three"
