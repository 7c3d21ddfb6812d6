"""External forces on the bodies, in loops; see `algorithms/multibody/external_forces.py`."""

from __future__ import annotations

from ulna.compiler.procedures import procedure
from ulna.recursions._procedures.placements import chain_placements
from ulna.recursions._procedures.vectors import add, cross, rotate_back, three


@procedure
def _turned_out(B, k, x, y, z):
    """R (x, y, z) of lanes, R being constant in row k of B."""
    return (
        x * B[k, 0] + y * B[k, 1] + z * B[k, 2],
        x * B[k, 3] + y * B[k, 4] + z * B[k, 5],
        x * B[k, 6] + y * B[k, 7] + z * B[k, 8],
    )


@procedure
def _at_joint(T, row, B, k, reference, fx, fy, fz, nx, ny, nz, W):
    """The wrench at the frame in row k of B, written in a reference, in the moving frame of a row."""
    if reference == 0:
        tx, ty, tz = three(T, row, 9, W)
        cx, cy, cz = cross(tx, ty, tz, fx, fy, fz)
        nx, ny, nz = nx - cx, ny - cy, nz - cz
    if reference == 2:
        fx, fy, fz = _turned_out(B, k, fx, fy, fz)
        nx, ny, nz = _turned_out(B, k, nx, ny, nz)
    else:
        fx, fy, fz = rotate_back(T, row, fx, fy, fz, W)
        nx, ny, nz = rotate_back(T, row, nx, ny, nz, W)
    if reference != 0:
        nx = nx + (fz * B[k, 10] - fy * B[k, 11])
        ny = ny + (fx * B[k, 11] - fz * B[k, 9])
        nz = nz + (fy * B[k, 9] - fx * B[k, 10])
    return fx, fy, fz, nx, ny, nz


@procedure
def subtract_wrenches(tree, places, frames, wrenches, F, W):
    """Subtracts wrenches at frames, six numbers each, from the forces on the bodies that carry them."""
    if frames.reference[0] != 2:
        chain_placements(tree, places, W)
    for k in range(len(frames.rows)):
        row = frames.rows[k]
        if row > 0:
            fx, fy, fz = wrenches[6 * k, 0:W], wrenches[6 * k + 1, 0:W], wrenches[6 * k + 2, 0:W]
            nx, ny, nz = wrenches[6 * k + 3, 0:W], wrenches[6 * k + 4, 0:W], wrenches[6 * k + 5, 0:W]
            fx, fy, fz, nx, ny, nz = _at_joint(
                places.T, row, frames.placements, k, frames.reference[0], fx, fy, fz, nx, ny, nz, W
            )
            add(F, row, 0, -fx, -fy, -fz, W)
            add(F, row, 3, -nx, -ny, -nz, W)
