"""The equations in one angle, against values made from known angles."""

from __future__ import annotations

import numpy as np
import pytest

from ulna.ik.analytic.lines import Line, nearest_points, perpendicular, swing, turn, turn_about
from ulna.ik.analytic.subproblems import angle_between, four_angles, square, two_angles


def _turns(a: float, b: float) -> float:
    return abs((a - b + np.pi) % (2.0 * np.pi) - np.pi)


@pytest.mark.parametrize("seed", range(5))
def test_the_angle_between_two_vectors_is_found_about_any_axis(seed: int) -> None:
    rng = np.random.default_rng(seed)
    h = rng.standard_normal(3)
    h /= np.linalg.norm(h)
    u, x = rng.standard_normal(3), rng.uniform(-np.pi, np.pi)
    assert _turns(angle_between(h, u, turn(h, x) @ u, 0.0), x) < 1e-12


def test_a_vector_on_the_axis_turns_by_any_angle_so_the_near_one_is_returned() -> None:
    h = np.array([0.0, 0.0, 1.0])
    assert angle_between(h, 2.0 * h, 3.0 * h, 0.7) == 0.7
    assert two_angles(0.0, 0.0, 0.0, 1.0, -0.4) == -0.4


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_both_angles_of_the_linear_equation_solve_it(sign: float) -> None:
    a, b, c = 0.3, -1.2, 0.9
    x = two_angles(a, b, c, sign, 0.0)
    assert a * np.cos(x) + b * np.sin(x) == pytest.approx(c, abs=1e-14)
    assert _turns(x, two_angles(a, b, c, -sign, 0.0)) > 0.1


def test_without_a_solution_the_nearest_angle_is_returned() -> None:
    assert two_angles(1.0, 0.0, 2.0, 1.0, 0.0) == 0.0


@pytest.mark.parametrize("seed", range(20))
def test_the_quartic_finds_every_angle_it_was_made_from(seed: int) -> None:
    rng = np.random.default_rng(seed)
    roots = rng.uniform(-np.pi, np.pi, 4)
    p = np.poly(np.exp(1j * roots))  # z^2 f(z), up to a factor that makes it self-inversive
    p = p * np.exp(-0.5j * np.angle(p[0] * p[4]))
    coefficients = np.array([p[2].real / 2, p[1].real, -p[1].imag, p[0].real, -p[0].imag])
    found = [four_angles(coefficients, float(n)) for n in range(4)]
    for root in roots:
        assert min(_turns(root, x) for x in found) < 1e-6


def test_a_quadratic_in_disguise_keeps_its_two_angles() -> None:
    coefficients = np.array([-np.cos(0.7), 1.0, 0.0, 0.0, 0.0])  # cos x = cos 0.7
    found = [four_angles(coefficients, float(n)) for n in range(4)]
    for root in (0.7, -0.7):
        assert min(_turns(root, x) for x in found) < 1e-9


def test_squares_of_numbers_and_of_vectors() -> None:
    rng = np.random.default_rng(0)
    x = 0.8
    basis = np.array([1.0, np.cos(x), np.sin(x), np.cos(2 * x), np.sin(2 * x)])
    for shape in ((), (3,)):
        a, b, c = (rng.standard_normal(shape)[()] for _ in range(3))
        value = a + b * np.cos(x) + c * np.sin(x)
        assert square((a, b, c)) @ basis == pytest.approx(np.sum(value * value))


def test_lines_turn_points_and_know_their_common_normal() -> None:
    a = Line(np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]))
    b = Line(np.array([0.0, 1.0, 0.0]), np.array([3.0, 5.0, 2.0]))
    on_a, on_b = nearest_points(a, b)
    assert np.allclose(on_a, [1.0, 0.0, 2.0]) and np.allclose(on_b, [3.0, 0.0, 2.0])
    assert np.allclose(turn_about(a, np.pi / 2) @ np.array([2.0, 0.0, 0.0]), [1.0, 1.0, 0.0])
    back = turn_about(a.reversed(), 0.3) @ turn_about(a, 0.3)
    assert np.allclose(back.matrix(), np.eye(4))
    still, cosine, sine = swing(a.direction, np.array([1.0, 2.0, 3.0]))
    assert np.allclose(
        still + np.cos(0.4) * cosine + np.sin(0.4) * sine, turn(a.direction, 0.4) @ [1.0, 2.0, 3.0]
    )
    for h in np.eye(3):
        assert abs(perpendicular(h) @ h) < 1e-15 and np.linalg.norm(perpendicular(h)) == pytest.approx(1.0)
