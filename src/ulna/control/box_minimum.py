"""The minimum of a quadratic function within limits, by projected Newton steps, as machine code.

The function is k' H k / 2 + h' k, with H = Quu + mu positive definite and h = Qu of `backward`, and low <= k <= high.
Entries of k at a limit from which the slope h + H k does not lead away are held there; a Newton step moves the others,
and is cut back to the limits. Sources: Bertsekas, Projected Newton methods for optimization problems with simple
constraints, SIAM Journal on Control and Optimization 20 (1982); Tassa, Mansard & Todorov, Control-limited differential
dynamic programming (ICRA 2014), section III-B.
"""

from __future__ import annotations

from ulna.compiler.procedures import procedure

FREE, POINT, SLOPE, STEP, NEXT = 0, 1, 2, 3, 4
ROWS = 5
"""The rows of `box`, (ROWS, m): which entries are free (1 or 0), k, its slope, a step, and k after it."""

_ROUNDS = 100
_SHORTEST = 1e-9  # part of a step
_SUFFICIENT = 0.1  # part of the decrease to first order that a step must achieve
_WHOLE = 2.0  # what `_descend` returns for a whole step that met no limit


@procedure(contract=True)
def factorised(n, Q, factor, box, mu):
    """L D L' = Quu + mu, D on the diagonal; False where a pivot is not positive (Golub & Van Loan 2013, 4.1.2).

    Rows and columns of entries that are not free are those of the identity.

    Args:
        n: Row and column of Q at which Quu begins.
        Q: The Hessian by state and control, (n + m, width) [any].
        factor: L below the diagonal and D on it, (m, m); overwritten [any].
        box: Its row FREE says which entries are free, (ROWS, m).
        mu: What is added to the diagonal [any].

    Returns:
        Whether Quu + mu is positive definite.
    """
    for j in range(factor.shape[0]):
        pivot = (Q[n + j, n + j] + mu) * box[FREE, j] + (1.0 - box[FREE, j])
        for k in range(j):
            pivot = pivot - factor[j, k] * factor[j, k] * factor[k, k]
        if not pivot > 0.0:
            return False
        factor[j, j] = pivot
        for i in range(j + 1, factor.shape[0]):
            entry = Q[n + i, n + j] * box[FREE, i] * box[FREE, j]
            for k in range(j):
                entry = entry - factor[i, k] * factor[j, k] * factor[k, k]
            factor[i, j] = entry / pivot
    return True


@procedure
def is_outside(t, n, gains, limits):
    """Whether k of a knot is outside its limits.

    Args:
        t: The knot.
        n: The column of the gains that is k.
        gains: Control laws, (N, m, width) [any].
        limits: Least and greatest k, (2, N, m) [any].

    Returns:
        Whether an entry is.
    """
    found = False
    for i in range(gains.shape[1]):
        if gains[t, i, n] < limits[0, t, i] or gains[t, i, n] > limits[1, t, i]:
            found = True
    return found


@procedure(contract=True)
def find_minimum(t, n, Q, q, factor, box, gains, limits, mu):
    """Leaves in `box` the best k of a knot within its limits and which entries are free there, and their factor.

    Args:
        t: The knot.
        n: Row and column of Q at which Quu begins, and the column of the gains that is k.
        Q: The Hessian by state and control, (n + m, width) [any].
        q: The gradient, (width,) [any].
        factor: That of all entries; then that of the free ones, (m, m) [any].
        box: All entries are free at first, (ROWS, m); overwritten [any].
        gains: Control laws, of which k is the minimum without limits, (N, m, width) [any].
        limits: Least and greatest k, (2, N, m) [any].
        mu: What is added to the diagonal of Quu [any].

    Returns:
        How often the slope was looked at.
    """
    for i in range(box.shape[1]):
        box[POINT, i] = min(max(gains[t, i, n], limits[0, t, i]), limits[1, t, i])
    rounds, part = 0, 1.0
    while part > 0.0 and rounds < _ROUNDS:
        _find_slope(n, Q, q, box, mu)
        is_changed = _find_free(t, box, limits)
        if is_changed:
            factorised(n, Q, factor, box, mu)
        if is_changed or part != _WHOLE:
            _find_step(factor, box)
            part = _descend(t, n, Q, box, limits, mu)
        else:
            part = 0.0
        rounds += 1
    _find_slope(n, Q, q, box, mu)
    if _find_free(t, box, limits):
        factorised(n, Q, factor, box, mu)
    return rounds


@procedure(contract=True)
def _find_slope(n, Q, q, box, mu):
    m = box.shape[1]
    for i in range(m):
        total = q[n + i] + mu * box[POINT, i]
        for j in range(m):
            total = total + Q[n + i, n + j] * box[POINT, j]
        box[SLOPE, i] = total


@procedure
def _find_free(t, box, limits):
    """Notes which entries are free: all but those that the slope presses against a limit; whether any changed."""
    is_changed = False
    for i in range(box.shape[1]):
        free = 1.0
        if box[POINT, i] <= limits[0, t, i] and box[SLOPE, i] >= 0.0:
            free = 0.0
        if box[POINT, i] >= limits[1, t, i] and box[SLOPE, i] <= 0.0:
            free = 0.0
        if free != box[FREE, i]:
            is_changed = True
        box[FREE, i] = free
    return is_changed


@procedure(contract=True)
def _find_step(factor, box):
    """The step of the free entries to the minimum without limits."""
    m = factor.shape[0]
    for i in range(m):
        total = -box[SLOPE, i] * box[FREE, i]
        for k in range(i):
            total = total - box[STEP, k] * factor[i, k]
        box[STEP, i] = total
    for i in range(m - 1, -1, -1):
        total = box[STEP, i] / factor[i, i]
        for k in range(i + 1, m):
            total = total - box[STEP, k] * factor[k, i]
        box[STEP, i] = total


@procedure(contract=True)
def _descend(t, n, Q, box, limits, mu):
    """Takes the longest part of the step, 1, 1/2, ..., that decreases the function enough.

    Returns the part, `_WHOLE` where nothing met a limit, and 0 where no part does.
    """
    m, part = box.shape[1], 1.0
    while part > _SHORTEST:
        first, second, is_cut = 0.0, 0.0, False
        for i in range(m):
            ahead = box[POINT, i] + part * box[STEP, i]
            box[NEXT, i] = min(max(ahead, limits[0, t, i]), limits[1, t, i])
            if box[NEXT, i] != ahead:
                is_cut = True
        for i in range(m):
            change = box[NEXT, i] - box[POINT, i]
            bend = mu * change
            for j in range(m):
                bend = bend + Q[n + i, n + j] * (box[NEXT, j] - box[POINT, j])
            first = first + change * box[SLOPE, i]
            second = second + 0.5 * change * bend
        if first == 0.0:
            return _WHOLE
        if first < 0.0 and first + second <= _SUFFICIENT * first:
            for i in range(m):
                box[POINT, i] = box[NEXT, i]
            return _WHOLE if part == 1.0 and not is_cut else part
        part = 0.5 * part
    return 0.0
