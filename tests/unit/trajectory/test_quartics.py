"""Quartics through even samples: their values, and the coefficients that bound them."""

import numpy as np

from ulna.trajectory.quartics import AT_PROBES, NODES, PROBES, TO_BERNSTEIN, TO_HALVES


def test_coefficients_are_those_of_the_quartic_and_of_its_halves() -> None:
    rng = np.random.default_rng(4)
    s = np.linspace(0.0, 1.0, 201)
    for _ in range(50):
        quartic = np.polynomial.Polynomial(rng.normal(size=5))
        samples = quartic(NODES)
        whole, halves = TO_BERNSTEIN @ samples, TO_HALVES @ samples
        np.testing.assert_allclose(whole[[0, -1]], quartic(np.array([0.0, 1.0])), atol=1e-12)
        np.testing.assert_allclose(halves[[0, 4, 8]], quartic(np.array([0.0, 0.5, 1.0])), atol=1e-12)
        np.testing.assert_allclose(AT_PROBES @ samples, quartic(PROBES), atol=1e-12)
        for coefficients, part in ((whole, s), (halves[:5], 0.5 * s), (halves[4:], 0.5 + 0.5 * s)):
            values = quartic(part)
            assert coefficients.min() <= values.min() + 1e-12 and values.max() <= coefficients.max() + 1e-12
        assert halves.min() >= whole.min() - 1e-12 and halves.max() <= whole.max() + 1e-12  # never looser


def test_coefficients_of_a_half_are_those_of_the_quartic_on_it() -> None:
    """The quartic on [0, 1/2], with its parameter stretched to [0, 1], has the first five coefficients."""
    quartic = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.5, -0.7])
    for start, part in ((0.0, slice(0, 5)), (0.5, slice(4, 9))):
        stretched = TO_BERNSTEIN @ quartic(start + 0.5 * NODES)
        np.testing.assert_allclose((TO_HALVES @ quartic(NODES))[part], stretched, atol=1e-12)
