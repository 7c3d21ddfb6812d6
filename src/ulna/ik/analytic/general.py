"""All solutions of any six turning joints: elimination to an eigenvalue problem, after Raghavan and Roth.

| symbol | meaning | shape | source |
|---|---|---|---|
| p, l | point and direction of the last axis, which turning about it leaves alone | (3,), (3,) | Raghavan & Roth 1993 |
| phi | p, l, p.p, p.l, p x l, (p.p) l - 2 (p.l) p, 1: products that a motion maps linearly | (15,) | ibid., eq. 7-10 |
| rho(E) | how a motion acts on phi | (15, 15) | expanded below |
| x_i | cos q_i, sin q_i, 1 | (3,) | |
| L, B | E_3 E_4 E_5 phi = (E_1 E_2)^-1 G phi: L (x_3 x_4 x_5) = B (x_1 x_2) | (14, 27), (14, 9) | ibid., eq. 11 |
| S(t_3) | equations free of q_1, q_2 in half tangents, and t_4 times them | (12, 12), degree 2 | Manocha & Canny 1994 |

det S(t_3) = 0 is an eigenvalue problem of size 24: 8 of the eigenvalues are +-i, the real ones among the other 16 are
the solutions. The loop E_1 ... E_6 = G may be entered at any joint, which gives six such problems; one may be singular
where the axes lie specially while another is not, so the best conditioned are used. What comes out are starts for
Newton's method; nothing is a solution before forward kinematics says so.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.ik.analytic.lines import Line
from ulna.spatial import SE3
from ulna.typing import Floats

_REAL = 0.05  # the largest imaginary part, for |t| = 1, of an eigenvalue that Newton's method gets to try
_EQUAL = 1e-6  # how near, for |t| = 1, eigenvalues count as one that several solutions share
_SPAN = 1e-6  # the part of the largest singular value below which vectors of such span no more
_MIX = 0.7311  # any number that tells apart solutions with the same t3, and with the same t4 or t5
_EYE = np.eye(3)
_BACK = np.array([1.0, -1.0, 1.0])[:, None, None]


def starts(lines: list[Line], G: SE3, problems: int = 2) -> tuple[Floats, float]:
    """Angles near which the solutions of E_1 ... E_6 = G lie.

    Args:
        lines: The six axes.
        G: The motion to make.
        problems: How many of the six eigenvalue problems to solve.

    Returns:
        Angles (k, 6), more than there are solutions; and the condition number of the best problem.
    """
    size = max(*(float(np.abs(p).max()) for p in (*(line.point for line in lines), G.translation)), 1e-9)
    lines = [Line(line.direction, line.point / size) for line in lines]
    G = SE3(G.rotation, G.translation / size)
    back = G.inverse()
    rho_G, rho_back = _rho(G), _rho(back)
    acts = [_affine_rho(line) for line in lines]
    carried = [rho_back @ act @ rho_G for act in acts[:5]]
    entered = []
    for first in range(6):
        order = [*range(first, 6), *range(first)]
        loop = [lines[i].moved(back) if i < first else lines[i] for i in order]
        L, B = _equations([carried[i] if i < first else acts[i] for i in order[:5]], loop[5], rho_G)
        entered.append((first, loop, *_pencil(L, B)))
    entered.sort(key=lambda entry: entry[-1])
    solutions = [
        np.roll(_angles(loop, G, pencil), first, axis=-1) for first, loop, pencil, _ in entered[:problems]
    ]
    return np.concatenate(solutions), float(entered[0][-1])


class _Pencil:
    """S(t) = S2 t^2 + S1 t + S0 and what leads back from its null vectors to angles."""

    def __init__(self, S: Floats, L: Floats, B: Floats, turned: Floats) -> None:
        self.S, self.L, self.B, self.turned = S, L, B, turned


def _pencil(L: Floats, B: Floats) -> tuple[_Pencil, float]:
    """The eigenvalue problem of one way into the loop, with the best of some choices of zero angles."""
    u, s, _ = np.linalg.svd(B[:, :8])
    rank = int((s > 1e-9 * s[0]).sum())
    N = u[:, rank:].T
    M = N @ L
    M[:, 26] -= N @ B[:, 8]
    M = M.reshape(-1, 3, 3, 3)
    best: tuple[_Pencil, float] | None = None
    for turned in (np.array([0.3, 1.1, -0.7]), np.array([1.9, -0.4, 2.3]), np.array([-1.2, 2.6, 0.9])):
        H = [_half_tangent(x) for x in turned]
        D = np.moveaxis(H[0].T @ (H[1].T @ (M @ H[2])).reshape(-1, 3, 9), 1, 0).reshape(3, -1, 3, 3)
        S = np.zeros((3, 2 * D.shape[1], 4, 3))
        S[:, : D.shape[1], :3] = D
        S[:, D.shape[1] :, 1:] = D
        S = S.reshape(3, -1, 12)
        if (
            S.shape[1] > 12
        ):  # more equations than unknowns: mix them, Newton's method sorts out what is too much
            mix = np.random.default_rng(0).standard_normal((12, S.shape[1]))
            S = mix @ S
        singular = np.linalg.svd(S[2], compute_uv=False)
        condition = float(singular[0] / max(singular[-1], 1e-300))
        if best is None or condition < best[1]:
            best = _Pencil(S, L, B, turned), condition
    assert best is not None
    return best


def _angles(lines: list[Line], G: SE3, pencil: _Pencil) -> Floats:
    """Angles (k, 6) from the real eigenvalues."""
    S = pencil.S
    values: Any
    vectors: Any
    try:
        lower = -np.linalg.solve(S[2], np.concatenate([S[0], S[1]], axis=1))
        companion = np.block([[np.zeros((12, 12)), np.eye(12)], [lower]])
        values, vectors = np.linalg.eig(companion)
    except np.linalg.LinAlgError:
        return np.zeros((0, 6))
    real = np.abs(values.imag) < _REAL * (1.0 + values.real**2)
    if not real.any():
        return np.zeros((0, 6))
    t3 = values[real].real
    v = vectors[:, real]
    upper = np.abs(v[12:]).sum(axis=0) > np.abs(v[:12]).sum(
        axis=0
    )  # v and t v: the longer half is the better
    v = _separated(t3, np.where(upper, v[12:], v[:12])).real.T.reshape(-1, 4, 3)
    t4, t5 = _ratio(v.transpose(0, 2, 1)), _ratio(v)
    inner = 2.0 * np.arctan(np.stack([t3, t4, t5], axis=-1)) + pencil.turned
    x = np.stack([np.cos(inner), np.sin(inner), np.ones_like(inner)], axis=-1)
    left = np.einsum("rabc,na,nb,nc->nr", pencil.L.reshape(14, 3, 3, 3), x[:, 0], x[:, 1], x[:, 2])
    y = np.linalg.lstsq(pencil.B[:, :8], (left - pencil.B[:, 8]).T, rcond=1e-9)[0].T
    q2, q1 = np.arctan2(y[:, 5], y[:, 2]), np.arctan2(y[:, 7], y[:, 6])
    angles = np.stack([q1, q2, *inner.T], axis=-1)
    R = np.broadcast_to(_EYE, (len(angles), 3, 3))
    for line, angle in zip(lines, angles.T, strict=False):
        K = _skew(line.direction)
        s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
        R = R @ (_EYE + s * K + (1.0 - c) * (K @ K))
    R = np.swapaxes(R, -1, -2) @ G.rotation
    h = lines[5].direction
    sine = np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=-1) @ h
    return np.column_stack([angles, np.arctan2(sine, np.trace(R, axis1=1, axis2=2) - (R @ h) @ h)])


def _separated(t3: Floats, v: Any) -> Any:
    """Null vectors (12, k) of which each belongs to one solution, where several solutions have the same t3.

    Vectors of equal eigenvalues are any basis of what their solutions span. All of these are products of powers of
    their own t4 and t5, so with the basis Q the matrices X of Q_low X = Q_high, for either, have common eigenvectors.
    """
    out = np.array(v, dtype=complex)
    order = np.argsort(t3)
    gaps = np.diff(t3[order]) > _EQUAL * (1.0 + t3[order][1:] ** 2)
    for group in np.split(order, np.flatnonzero(gaps) + 1):
        u, s, _ = np.linalg.svd(v[:, group], full_matrices=False)
        rank = int((s > _SPAN * s[0]).sum())
        if rank < 2:
            continue
        Q = u[:, :rank].reshape(4, 3, rank)
        X = _shift(Q[:-1], Q[1:]) + _MIX * _shift(Q[:, :-1], Q[:, 1:])
        mixed = u[:, :rank] @ np.linalg.eig(X)[1]
        largest = np.take_along_axis(mixed, np.abs(mixed).argmax(axis=0)[None], axis=0)
        out[:, group[:rank]] = mixed / largest
    return out


def _shift(low: Any, high: Any) -> Any:
    """The matrix X (r, r) with low X = high, entries (..., r) each, as the least-squares fit."""
    rank = low.shape[-1]
    return np.linalg.lstsq(low.reshape(-1, rank), high.reshape(-1, rank), rcond=None)[0]


def _equations(acts: list[Floats], last: Line, rho_G: Floats) -> tuple[Floats, Floats]:
    """L (14, 27) and B (14, 9), from how the first five joints act."""
    phi = _products(last.point, last.direction)
    L = phi
    for act in acts[:1:-1]:  # (15, ...) becomes (15, 3, ...)
        L = np.moveaxis(np.tensordot(act, L, axes=1), 0, 1)
    B = rho_G @ phi
    for act in acts[
        :2
    ]:  # the first joint's inverse comes next to G; turning back has the sine's sign changed
        B = np.moveaxis(np.tensordot(act * _BACK, B, axes=1), 0, 1)
    return L[:14].reshape(14, 27), B[:14].reshape(14, 9)


def _affine_rho(line: Line) -> Floats:
    """rho(E(q)) = parts[0] cos q + parts[1] sin q + parts[2], (3, 15, 15)."""
    h = line.direction
    along = np.outer(h, h)
    parts = np.stack([_blocks(_EYE - along), _blocks(_skew(h)), _blocks(along)])
    parts[2, [6, 7, 14], [6, 7, 14]] = 1.0
    return _rho(SE3(_EYE, line.point)) @ parts @ _rho(SE3(_EYE, -line.point))


def _products(p: Floats, l: Floats) -> Floats:
    s, d = p @ p, p @ l
    return np.concatenate([p, l, [s, d], np.cross(p, l), s * l - 2.0 * d * p, [1.0]])


def _rho(E: SE3) -> Floats:
    """How phi changes with a rotation R, and then with a translation t."""
    R, t = E.rotation, E.translation
    turned = _blocks(R)
    turned[[6, 7, 14], [6, 7, 14]] = 1.0
    shift = np.eye(15)
    cross = _skew(t)
    shift[0:3, 14] = t
    shift[6, 0:3], shift[6, 14] = 2.0 * t, t @ t
    shift[7, 3:6] = t
    shift[8:11, 3:6] = cross
    shift[11:14, 3:6] = (t @ t) * _EYE - 2.0 * np.outer(t, t)
    shift[11:14, 7] = -2.0 * t
    shift[11:14, 8:11] = -2.0 * cross
    return shift @ turned


def _blocks(R: Floats) -> Floats:
    """R where phi has vectors, zeros elsewhere."""
    out = np.zeros((15, 15))
    for k in (0, 3, 8, 11):
        out[k : k + 3, k : k + 3] = R
    return out


def _skew(v: Floats) -> Floats:
    x, y, z = v.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _half_tangent(turned: float) -> Floats:
    """(1 + t^2) (cos q, sin q, 1) as polynomials in t = tan((q - turned) / 2), (3, 3): columns 1, t, t^2."""
    c, s = np.cos(turned), np.sin(turned)
    return np.array([[c, -2.0 * s, -c], [s, 2.0 * c, -s], [1.0, 0.0, 1.0]])


def _ratio(v: Floats) -> Floats:
    """The ratio of neighbours along the last axis of (n, rows, powers), as the least-squares fit."""
    low, high = v[..., :-1].reshape(len(v), -1), v[..., 1:].reshape(len(v), -1)
    return (low * high).sum(axis=-1) / np.maximum((low * low).sum(axis=-1), 1e-300)
