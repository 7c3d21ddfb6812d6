"""What a model computes, once by MuJoCo from its file and once by Ulna, in MuJoCo's coordinates, to be compared."""

from __future__ import annotations

import copy
import functools
import math
import os
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ulna import algorithms as alg
from ulna.collision import link_pairs
from ulna.errors import ModelWarning
from ulna.formats.mjcf import model_from_mjcf
from ulna.geometry import Box, Capsule, Cylinder, Ellipsoid, Geometry, Mesh, Plane, Sphere
from ulna.model import FreeFlyer, Model, Spherical
from ulna.typing import Floats

mj: Any = pytest.importorskip("mujoco")
Results = dict[str, Any]
FREE, BALL = 0, 1
LIMIT_ROW, FRICTION_ROW, EQUALITY_ROW = 3, 1, 0
"""mjtConstraint: of a joint's limit, of dry friction at a degree of freedom, of an equality."""
FAR = 30.0
MARKER = 1e8
"""A control that no range in the samples contains."""


def compiled(source: str | Path) -> Any:
    if isinstance(source, Path):
        return mj.MjModel.from_xml_path(os.fspath(source))
    return mj.MjModel.from_xml_string(source)


def loaded(source: str | Path) -> tuple[Model, list[str]]:
    """Ulna's model of a file, and its warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model = model_from_mjcf(source, trusted=True)
    return model, [str(w.message) for w in caught if issubclass(w.category, ModelWarning)]


def free_state(m: Any, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """A position and velocity with no regard to couplings, the same for every rest position."""
    qpos = np.zeros(m.nq)
    for j in np.flatnonzero(m.jnt_type <= BALL):
        qpos[m.jnt_qposadr[j] + 3 * int(m.jnt_type[j] == FREE)] = 1.0
    mj.mj_integratePos(m, qpos, rng.normal(size=m.nv), 0.7)
    return qpos, rng.normal(size=m.nv)


def coupled_state(model: Model, m: Any, rng: np.random.Generator) -> tuple[Floats, Floats, Floats, Floats]:
    """q, v of Ulna, and MuJoCo's qpos and qvel = G v, with G (m.nv, model.nv)."""
    q = alg.integrate(model, np.array(model.neutral), rng.normal(size=model.nv))
    qpos, G = np.zeros(m.nq), np.zeros((m.nv, model.nv))
    for j, joint in enumerate(model.joints):
        at, dof = int(m.jnt_qposadr[j]), int(m.jnt_dofadr[j])
        if joint.mimic is not None:
            qpos[at] = joint.mimic.multiplier * q[joint.idx_q] + joint.mimic.offset
            G[dof, joint.idx_v] = joint.mimic.multiplier
            continue
        values = np.array(q[joint.idx_q : joint.idx_q + joint.nq])
        if isinstance(joint.kind, (FreeFlyer, Spherical)):
            values[-4:] = np.roll(values[-4:], 1)
        qpos[at : at + len(values)] = values
        block = np.eye(joint.nv)
        if isinstance(joint.kind, FreeFlyer):  # MuJoCo's linear velocity is in the world
            block[:3, :3] = rotation(values[-4:])
        G[dof : dof + joint.nv, joint.idx_v : joint.idx_v + joint.nv] = block
    return q, rng.normal(size=model.nv), qpos, G


def rotation(wxyz: Floats) -> Floats:
    R = np.zeros(9)
    mj.mju_quat2Mat(R, wxyz)
    return R.reshape(3, 3)


def of_mujoco(m: Any, qpos: Floats, qvel: Floats) -> Results:
    """What MuJoCo computes; nothing of it is read off the file."""
    d = mj.MjData(m)
    d.qpos, d.qvel = qpos, qvel
    mj.mj_forward(m, d)
    M = np.zeros((m.nv, m.nv))
    mj.mj_fullM(m, d, M)
    friction = np.zeros(m.nv)
    rows = d.efc_type == FRICTION_ROW
    friction[d.efc_id[rows]] = d.efc_frictionloss[rows]
    at_rest = mj.MjData(m)
    at_rest.qpos = qpos
    mj.mj_forward(m, at_rest)
    lower, upper = _limits(m)
    return {
        "poses": {m.body(b).name: (d.xpos[b].copy(), d.xmat[b].copy()) for b in range(1, m.nbody)},
        "sites": {m.site(s).name: (d.site_xpos[s].copy(), d.site_xmat[s].copy()) for s in range(m.nsite)},
        "mass": M,
        "bias": np.array(d.qfrc_bias),
        "gravity": np.array(at_rest.qfrc_bias),
        "passive": np.array(d.qfrc_passive),
        "friction": friction,
        "lower": lower,
        "upper": upper,
        "effort": _efforts(m),
        "contacts": _contacts(m, qpos),
        "shapes": _shapes(m, d),
        "configurations": {m.key(k).name or f"key_{k}": np.array(m.key_qpos[k]) for k in range(m.nkey)},
        "equalities": np.array(d.efc_pos[d.efc_type == EQUALITY_ROW]),
    }


def _limits(m: Any) -> tuple[Floats, Floats]:
    """Where MuJoCo's limits begin to act on hinges and slides."""
    ends = []
    for far in (-100.0, 100.0):
        found = np.full(m.njnt, math.copysign(math.inf, far))
        d = mj.MjData(m)
        d.qpos = m.qpos0
        scalar = m.jnt_type > BALL
        d.qpos[m.jnt_qposadr[scalar]] = far
        mj.mj_forward(m, d)
        for row in np.flatnonzero(d.efc_type == LIMIT_ROW):
            j = int(d.efc_id[row])
            if scalar[j]:
                found[j] = far - math.copysign(1.0, far) * -d.efc_pos[row]
        ends.append(found)
    return ends[0], ends[1]


def _efforts(m: Any) -> Floats:
    """The largest force of the actuators on each hinge and slide; infinite where more control means more force."""
    largest = np.full(m.njnt, math.inf)
    d = mj.MjData(m)
    driven = np.zeros((2, m.nv))
    for k, sign in enumerate((-1.0, 1.0)):
        mj.mj_resetData(m, d)
        d.ctrl, d.act = sign * MARKER, sign * MARKER
        mj.mj_forward(m, d)
        driven[k] = d.qfrc_actuator
    for j in range(m.njnt):
        force = np.abs(driven[:, m.jnt_dofadr[j]]).max()
        if m.jnt_type[j] > BALL and 0.0 < force < 1e5:
            largest[j] = force
        elif m.jnt_type[j] > BALL and m.jnt_actfrclimited[j]:
            largest[j] = np.abs(m.jnt_actfrcrange[j]).max()
    return largest


def _contacts(m: Any, qpos: Floats) -> set[frozenset[str]]:
    """The bodies of which MuJoCo brings geoms into contact when everything is near everything."""
    m = copy.copy(m)
    m.geom_type[:], m.geom_size[:], m.geom_rbound[:] = 2, 0.1, 0.1  # spheres, which any distance suits
    for margin in ("geom_margin", "pair_margin", "body_margin"):
        getattr(m, margin, np.zeros(0))[:] = FAR
    m.opt.o_margin = FAR
    d = mj.MjData(m)
    d.qpos = qpos
    mj.mj_kinematics(m, d)
    mj.mj_comPos(m, d)
    mj.mj_collision(m, d)
    ends = (m.geom_bodyid[c.geom] for c in d.contact)
    return {frozenset(m.body(b).name for b in bodies) for bodies in ends}


KINDS = {2: "Sphere", 3: "Capsule", 4: "Ellipsoid", 5: "Cylinder", 6: "Box"}


def _shapes(m: Any, d: Any) -> list[tuple[str, Floats]]:
    """Body, kind, sizes and places of the geoms that MuJoCo draws; of meshes the corners of their boxes."""
    out = []
    for g in range(m.ngeom):
        kind, at, R = int(m.geom_type[g]), d.geom_xpos[g], d.geom_xmat[g].reshape(3, 3)
        if m.geom_group[g] > 2 or kind in (0, 1):
            continue
        body = m.body(m.geom_bodyid[g]).name
        if kind in KINDS:
            sizes = m.geom_size[g][: {2: 1, 3: 2, 5: 2}.get(kind, 3)]
            out.append((f"{body} {KINDS[kind]}", np.r_[sizes, at, R.ravel()]))
        elif kind == 7:
            mesh = int(m.geom_dataid[g])
            start, count = int(m.mesh_vertadr[mesh]), int(m.mesh_vertnum[mesh])
            corners = m.mesh_vert[start : start + count] @ R.T + at
            out.append((f"{body} Mesh", _box(corners)))
    return out


def _box(corners: Floats) -> Floats:
    """Least and largest coordinates, as exact as the single precision in which MuJoCo keeps meshes."""
    return np.round(np.r_[corners.min(axis=0), corners.max(axis=0)], 5) + 0.0


def of_ulna(model: Model, m: Any, q: Floats, v: Floats, G: Floats) -> Results:
    """The same of Ulna; what has the size of the velocity is in Ulna's coordinates, q' = G v in MuJoCo's."""
    frames = {f.name: alg.frame_pose(model, q, f) for f in model.frames if f.kind in ("link", "user")}
    names = [m.body(b).name for b in range(1, m.nbody)]
    free = [j for j in model.joints if isinstance(j.kind, FreeFlyer)]
    convective = np.zeros(m.nv)
    for joint in free:
        linear, angular = v[joint.idx_v : joint.idx_v + 3], v[joint.idx_v + 3 : joint.idx_v + 6]
        R = G[np.flatnonzero(G[:, joint.idx_v])[0] :][:3, joint.idx_v : joint.idx_v + 3]
        start = int(np.flatnonzero(G[:, joint.idx_v + 3])[0]) - 3
        convective[start : start + 3] = R @ np.cross(angular, linear)
    limits = [joint.limits for joint in model.joints]
    scalar = [joint.kind.nq == 1 for joint in model.joints]
    near = {frozenset(pair) for pair in link_pairs(model)}
    return {
        "poses": {n: (frames[n].translation, frames[n].rotation.ravel()) for n in names},
        "sites": {
            m.site(s).name: (frames[m.site(s).name].translation, frames[m.site(s).name].rotation.ravel())
            for s in range(m.nsite)
        },
        "mass": alg.mass_matrix(model, q),
        "bias": alg.bias_forces(model, q, v),
        "gravity": alg.gravity_forces(model, q),
        "passive": -model.damping * v,
        "friction": model.friction,
        "lower": np.array([x.lower[0] if s else -np.inf for x, s in zip(limits, scalar, strict=True)]),
        "upper": np.array([x.upper[0] if s else np.inf for x, s in zip(limits, scalar, strict=True)]),
        "effort": np.array([x.effort[0] if s else np.inf for x, s in zip(limits, scalar, strict=True)]),
        "contacts": near,
        "shapes": [
            _shape(link.name, frames[link.name], g)
            for link in model.links
            for g in link.visuals
            if not isinstance(g.shape, Plane)
        ],
        "configurations": dict(model.configurations),
        "convective": convective,
    }


def _shape(link: str, pose: Any, g: Geometry) -> tuple[str, Floats]:
    at, shape = pose @ g.placement, g.shape
    name = f"{link} {type(shape).__name__}"
    place = np.r_[at.translation, at.rotation.ravel()]
    if isinstance(shape, Sphere):
        return name, np.r_[shape.radius, place]
    if isinstance(shape, (Capsule, Cylinder)):
        return name, np.r_[shape.radius, shape.length / 2.0, place]
    if isinstance(shape, Ellipsoid):
        return name, np.r_[shape.radii, place]
    if isinstance(shape, Box):
        return name, np.r_[np.array(shape.size) / 2.0, place]
    assert isinstance(shape, (Mesh, Plane))
    if isinstance(shape, Plane):
        return name, np.zeros(0)
    rows = (line.split() for line in Path(shape.path).read_text().splitlines())
    corners = np.array([row[1:] for row in rows if row and row[0] == "v"], dtype=float) * shape.scale
    corners = corners @ at.rotation.T + at.translation
    return name, _box(corners)


def same(one: Any, two: Any) -> bool:
    """Whether two results are equal up to rounding."""
    if isinstance(one, dict):
        return one.keys() == two.keys() and all(same(one[k], two[k]) for k in one)
    if isinstance(one, set):
        return one == two
    if isinstance(one, (list, tuple)):
        return len(one) == len(two) and all(same(a, b) for a, b in zip(one, two, strict=True))
    if isinstance(one, str):
        return one == two
    one, two = np.asarray(one), np.asarray(two)
    if one.shape != two.shape:
        return False
    finite = np.isfinite(one)
    scale = 1.0 + np.abs(one[finite]).max(initial=0.0)
    close = np.allclose(one[finite], two[finite], rtol=0.0, atol=2e-9 * scale)
    return bool(close and np.array_equal(one[~finite], two[~finite]))


@functools.cache
def schema() -> dict[str, frozenset[str]]:
    """The attributes of each element of MuJoCo's schema, by its path below <mujoco>: "worldbody/body/joint"."""
    found: dict[str, list[str]] = {}
    path: list[str] = []
    for line in mj.mj_printSchema(False, True).splitlines():
        tag = line[:30].strip()
        if tag:
            depth = (len(line) - len(line.lstrip())) // 3
            path = [*path[:depth], tag.split()[0].replace("(world)", "")]
            found.setdefault("/".join(path[1:]), [])
        found["/".join(path[1:])] += line[30:].split()
    return {path: frozenset(names) for path, names in found.items()}
