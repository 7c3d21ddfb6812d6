"""Sums over all bodies, in loops: centre of mass, momentum, energy; see `algorithms/dynamics/centroidal.py`.

| symbol | meaning | shape | unit |
|---|---|---|---|
| c | mass times position of the centre of mass | (3) | [kg m] |
| f, n | momentum of all bodies about the world's origin, or its rate | (3), (3) | [N s, N m s], [N, N m] |
| T | kinetic energy of the bodies | () | [J] |

Source: Orin, Goswami & Lee 2013; Featherstone 2008, eq. 2.63.
"""

from __future__ import annotations

from typing import NamedTuple

from ulna.compiler.procedures import Array1, Array3, broadcast, f64, procedure
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.newton_euler import (
    Motions,
    acceleration_of,
    add_cross_of_twists,
    body_force,
    velocity_of,
)
from ulna.recursions._procedures.placements import Placements, place_in_world
from ulna.recursions._procedures.vectors import add, cross, momentum, rotate, three


class Sums(NamedTuple):
    """Storage.

    Attributes:
        total: c, f, n, T in row 0, (1, 10, W).
        mass: The mass of all bodies, (1,) [kg].
    """

    total: Array3[f64]
    mass: Array1[f64]


@procedure
def _start(sums, W):
    for k in range(10):
        sums.total[0, k, 0:W] = broadcast(0.0, W)


@procedure
def _add_first_moment(tree, T, i, sums, W):
    """Adds mass times position of a body."""
    m = tree.inertias[i, 0]
    x, y, z = rotate(T, i, tree.inertias[i, 1], tree.inertias[i, 2], tree.inertias[i, 3], W)
    px, py, pz = three(T, i, 9, W)
    add(sums.total, 0, 0, x + px * m, y + py * m, z + pz * m, W)


@procedure
def _add_momentum(tree, T, moves, i, sums, W):
    """Adds the momentum I V of a body, and its kinetic energy."""
    lx, ly, lz = three(moves.V, i, 0, W)
    rx, ry, rz = three(moves.V, i, 3, W)
    fx, fy, fz, nx, ny, nz = momentum(tree.inertias, i, lx, ly, lz, rx, ry, rz)
    work = (lx * fx + ly * fy + lz * fz) + (rx * nx + ry * ny + rz * nz)
    sums.total[0, 9, 0:W] = sums.total[0, 9, 0:W] + 0.5 * work
    _add_in_world(T, i, fx, fy, fz, nx, ny, nz, sums, W)


@procedure
def _add_in_world(T, i, fx, fy, fz, nx, ny, nz, sums, W):
    """Adds a wrench of the moving frame of a step, about the world's origin."""
    fx, fy, fz = rotate(T, i, fx, fy, fz, W)
    nx, ny, nz = rotate(T, i, nx, ny, nz, W)
    px, py, pz = three(T, i, 9, W)
    cx, cy, cz = cross(px, py, pz, fx, fy, fz)
    add(sums.total, 0, 3, fx, fy, fz, W)
    add(sums.total, 0, 6, nx + cx, ny + cy, nz + cz, W)


@procedure
def _first_moments(tree, places, sums, q, W):
    """c of one block of samples."""
    place_in_world(tree, places, q, W)
    _start(sums, W)
    for i in range(1, len(tree.parents)):
        _add_first_moment(tree, places.T, i, sums, W)


@procedure
def _momenta(tree, places, moves, sums, q, v, W):
    """c, f, n and T, that of the drives included, of one block of samples."""
    _first_moments(tree, places, sums, q, W)
    for i in range(1, len(tree.parents)):
        _sx, _sy, _sz, _wx, _wy, _wz = velocity_of(tree, places.X, moves.V, v, i, W)
        _add_momentum(tree, places.T, moves, i, sums, W)
    for k in range(len(tree.armature)):
        rate = v[k, 0:W]
        sums.total[0, 9, 0:W] = sums.total[0, 9, 0:W] + rate * rate * (0.5 * tree.armature[k])


@procedure
def _rates(tree, places, moves, sums, q, v, a, W):
    """c, and the rates of f and n, of one block of samples."""
    _first_moments(tree, places, sums, q, W)
    for i in range(1, len(tree.parents)):
        acceleration_of(tree, places.X, moves.A, a, i, True, W)
        sx, sy, sz, wx, wy, wz = velocity_of(tree, places.X, moves.V, v, i, W)
        add_cross_of_twists(moves.V, i, sx, sy, sz, wx, wy, wz, moves.A, W)
        body_force(tree, moves, i, True, W)
        fx, fy, fz = three(moves.F, i, 0, W)
        nx, ny, nz = three(moves.F, i, 3, W)
        _add_in_world(places.T, i, fx, fy, fz, nx, ny, nz, sums, W)


@procedure
def _over_mass(sums, first, out, W):
    """Writes three of the sums, divided by the mass."""
    for k in range(3):
        out[k, 0:W] = sums.total[0, first + k, 0:W] / sums.mass[0]


@procedure
def _about_center(sums, out, W):
    """Writes f, and n about the centre of mass."""
    cx, cy, cz = three(sums.total, 0, 0, W)
    fx, fy, fz = three(sums.total, 0, 3, W)
    nx, ny, nz = three(sums.total, 0, 6, W)
    x, y, z = cross(cx / sums.mass[0], cy / sums.mass[0], cz / sums.mass[0], fx, fy, fz)
    out[0, 0:W] = fx
    out[1, 0:W] = fy
    out[2, 0:W] = fz
    out[3, 0:W] = nx - x
    out[4, 0:W] = ny - y
    out[5, 0:W] = nz - z


@procedure
def _potential(tree, sums, W):
    """The potential energy."""
    x, y, z = three(sums.total, 0, 0, W)
    return -(x * tree.gravity[0] + y * tree.gravity[1] + z * tree.gravity[2])


@recursion(W=1, places=Placements, sums=Sums)
def center_of_mass(tree, places, sums, q, out, blocks, W):
    """Positions of the centre of mass in the world, (blocks, 3, W) [m]; arguments as of the others here.

    Args:
        places: Storage, with the world's frames.
        q: Configurations, one a lane, (blocks, nq, W) [rad, m].
        out: What is written.
    """
    for b in range(blocks):
        _first_moments(tree, places, sums, q[b], W)
        _over_mass(sums, 0, out[b], W)


@recursion(W=1, places=Placements, sums=Sums)
def potential_energy(tree, places, sums, q, out, blocks, W):
    """Potential energies, (blocks, 1, W) [J]; see `center_of_mass`."""
    for b in range(blocks):
        _first_moments(tree, places, sums, q[b], W)
        out[b, 0, 0:W] = _potential(tree, sums, W)


@recursion(W=1, places=Placements, moves=Motions, sums=Sums)
def center_of_mass_velocity(tree, places, moves, sums, q, v, out, blocks, W):
    """Velocities of the centre of mass in the world, (blocks, 3, W) [m/s]; see `center_of_mass`."""
    for b in range(blocks):
        _momenta(tree, places, moves, sums, q[b], v[b], W)
        _over_mass(sums, 3, out[b], W)


@recursion(W=1, places=Placements, moves=Motions, sums=Sums)
def centroidal_momentum(tree, places, moves, sums, q, v, out, blocks, W):
    """Momenta about the centre of mass, (blocks, 6, W) [N s, N m s]; see `center_of_mass`."""
    for b in range(blocks):
        _momenta(tree, places, moves, sums, q[b], v[b], W)
        _about_center(sums, out[b], W)


@recursion(W=1, places=Placements, moves=Motions, sums=Sums)
def kinetic_energy(tree, places, moves, sums, q, v, out, blocks, W):
    """Kinetic energies, (blocks, 1, W) [J]; see `center_of_mass`."""
    for b in range(blocks):
        _momenta(tree, places, moves, sums, q[b], v[b], W)
        out[b, 0, 0:W] = sums.total[0, 9, 0:W]


@recursion(W=1, places=Placements, moves=Motions, sums=Sums)
def mechanical_energy(tree, places, moves, sums, q, v, out, blocks, W):
    """Kinetic and potential energies together, (blocks, 1, W) [J]; see `center_of_mass`."""
    for b in range(blocks):
        _momenta(tree, places, moves, sums, q[b], v[b], W)
        out[b, 0, 0:W] = sums.total[0, 9, 0:W] + _potential(tree, sums, W)


@recursion(W=1, places=Placements, moves=Motions, sums=Sums)
def center_of_mass_acceleration(tree, places, moves, sums, q, v, a, out, blocks, W):
    """Accelerations of the centre of mass in the world, (blocks, 3, W) [m/s^2]; see `center_of_mass`."""
    for b in range(blocks):
        _rates(tree, places, moves, sums, q[b], v[b], a[b], W)
        _over_mass(sums, 3, out[b], W)


@recursion(W=1, places=Placements, moves=Motions, sums=Sums)
def centroidal_momentum_rate(tree, places, moves, sums, q, v, a, out, blocks, W):
    """Rates of the momentum about the centre of mass, (blocks, 6, W) [N, N m]; see `center_of_mass`."""
    for b in range(blocks):
        _rates(tree, places, moves, sums, q[b], v[b], a[b], W)
        _about_center(sums, out[b], W)
