"""The masses and inertias of a model: read as arrays, replaced, or perturbed.

The ten parameters of a body are m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz, with the rotational inertia about
the origin of its joint's moving frame [kg, kg m, kg m^2], in the order of Pinocchio. A body is all that a movable
joint carries rigidly, as in `model.inertias`; the equations of motion are linear in these parameters.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ulna.checks.arrays import check_finite, number_or_array, real_array
from ulna.checks.labels import in_order
from ulna.checks.values import flag, generator, number, short_repr
from ulna.errors import InputError, ModelError, ShapeError, UnknownName
from ulna.model.assemble import aggregate
from ulna.model.check import checked_inertia
from ulna.model.joints.axes import constant
from ulna.model.model import Model
from ulna.model.parts import Joint
from ulna.spatial import Inertia
from ulna.typing import Array, ArrayLike, Floats

_OF_DRIVES = ("armature", "damping", "friction", "effort")


def dynamic_parameters(model: Model) -> Floats:
    """The ten parameters of each joint's body, one after the other, shape (10 nbodies,)."""
    if not model.inertias:
        return np.zeros(0)
    return np.concatenate([np.asarray(body.parameters(), dtype=float) for body in model.inertias])


def with_dynamic_parameters(model: Model, parameters: ArrayLike, *, check: bool = True) -> Model:
    """The model whose bodies have these parameters.

    Of a body that changes, the link right after the joint gets all the inertia, and the links fixed to it become
    massless: the equations of motion do not depend on how a body's inertia is spread over its links. A body that
    keeps its parameters keeps its links.

    Args:
        model: The model.
        parameters: Ten parameters of each joint's body, shape (10 nbodies,) or (nbodies, 10) [kg, kg m, kg m^2].
        check: Whether to refuse bodies that cannot exist: of negative mass, or with principal moments of inertia that
            are negative or break the triangle inequality.

    Returns:
        A new model.

    Raises:
        ShapeError, NonFiniteError: they are not ten finite numbers for each body.
        ModelError: a body cannot exist; or it has no mass, but first moments, which no model can hold.
    """
    p = real_array("parameters", parameters)
    count = len(model.joints)
    flag("check", check)
    if p.shape not in ((10 * count,), (count, 10)):
        raise ShapeError("parameters", p.shape, f"({10 * count},): ten for each of {count} bodies")
    p = p.reshape(count, 10)
    check_finite("parameters", p)
    before = dynamic_parameters(model).reshape(count, 10)
    inertias, links = list(model.inertias), list(model.links)
    for i, joint in enumerate(model.joints):
        if (p[i] == before[i]).all():
            continue
        inertias[i] = body = _body(joint.name, p[i], check)
        for k, link in enumerate(links):
            if link.joint == i:
                in_link = (
                    link.placement.act_inverse(body) if link.name == joint.child_link else Inertia.zero()
                )
                links[k] = replace(link, inertia=_constant(in_link))
    return replace(model, inertias=tuple(inertias), links=tuple(links))


def with_link_inertias(model: Model, inertias: Mapping[str, Inertia]) -> Model:
    """The model with other inertias of some links.

    Args:
        model: The model.
        inertias: For names of links, their inertia in the link's frame [kg, m, kg m^2].

    Returns:
        A new model.

    Raises:
        InputError: `inertias` is no dictionary.
        UnknownName: no link of that name.
        ModelError: an inertia cannot be one.
    """
    links = list(model.links)
    if not isinstance(inertias, Mapping):
        raise InputError(
            f"`inertias` is {short_repr(inertias)}; expected a dictionary from names of links to an Inertia."
        )
    for name, inertia in inertias.items():
        k = model.link_index(name)
        links[k] = replace(links[k], inertia=checked_inertia(name, inertia))
    bodies, base = aggregate(model.joints, tuple(links))
    return replace(model, links=tuple(links), inertias=bodies, base_inertia=base)


def with_joint_dynamics(model: Model, **values: ArrayLike) -> Model:
    """The model with other numbers of the drives.

    Args:
        model: The model.
        **values: Any of `armature` [kg, kg m^2], `damping` (viscous) [N s/m, N m s/rad], `friction` (Coulomb) [N, N
            m] and `effort` (the greatest, may be inf) [N, N m]: one number, or one for each entry of v, shape (nv,),
            none below zero. They are the totals at each entry of v: what the drives of mimic joints add to
            `model.armature`, `damping` and `friction` is part of them, and mimic joints have no values any more.

    Returns:
        A new model.

    Raises:
        UnknownName: another name.
        ShapeError: neither one number nor (nv,).
        InputError: a value below zero, or nan, or inf.
    """
    for name, numbers in values.items():
        if name not in _OF_DRIVES:
            raise UnknownName("number of the drives", name, _OF_DRIVES)
        value = number_or_array(name, in_order(name, numbers, model.velocity_names), model.nv)
        if np.isnan(value).any() or (value < 0.0).any() or (name != "effort" and np.isinf(value).any()):
            raise InputError(f"`{name}` is {value}; expected finite numbers, none below zero.")
        model = with_drive_values(model, name, value)
    return model


def with_drive_values(model: Model, name: str, value: Array) -> Model:
    """The model with one property of its drives replaced.

    Args:
        model: The robot.
        name: "armature", "damping", "friction" or "effort".
        value: The totals at each entry of v, shape (nv,), which may be traced.

    Returns:
        A new model.
    """
    joints = []
    for joint in model.joints:
        entries = tuple(value[joint.idx_v : joint.idx_v + joint.kind.nv].tolist())
        if joint.mimic is None:
            joints.append(_changed(joint, name, entries))
        elif name != "effort":  # what its drive adds is in its source's number
            joints.append(_changed(joint, name, (0.0,) * len(entries)))
        else:
            joints.append(joint)
    return replace(model, joints=tuple(joints))


def perturbed(
    model: Model, fraction: float = 0.1, seed: int | np.random.Generator | None = None, com: float = 0.0
) -> Model:
    """A model with random errors in masses and inertias: to test how robust a controller is.

    The mass of each link, and its rotational inertia about the centre of mass, are multiplied by two factors drawn
    evenly from 1 - fraction to 1 + fraction. A physically consistent body stays so.

    Args:
        model: The model.
        fraction: Greatest relative change, from 0 to below 1 [-].
        seed: Seed or generator; the same seed gives the same model.
        com: Greatest shift of each coordinate of the links' centres of mass [m].

    Returns:
        A new model.

    Raises:
        InputError: `fraction` or `com` is out of range.
    """
    fraction = number("fraction", fraction, "a number from 0 to below 1, such as 0.1", least=0.0)
    if fraction >= 1.0:
        raise InputError(f"`fraction` is {fraction}; expected a number from 0 to below 1, such as 0.1.")
    com = number("com", com, "a length of zero or more [m]", least=0.0)
    rng = generator("seed", seed)
    changed = {}
    for link in model.links:
        factors, shift = rng.uniform(1.0 - fraction, 1.0 + fraction, 2), rng.uniform(-com, com, 3)
        inertia = link.inertia
        if inertia.mass > 0.0:
            mass, tensor = factors[0] * inertia.mass, factors[1] * inertia.inertia
            changed[link.name] = Inertia(mass, inertia.com + shift, tensor)
    return with_link_inertias(model, changed)


def _body(joint: str, p: Floats, check: bool) -> Inertia:
    """The inertia of ten parameters, if a model can hold it."""
    subject = f"The body of joint {joint!r}"
    if p[0] == 0.0 and p[1:4].any():
        raise ModelError(
            f"{subject} is to have no mass, but the first moments {p[1:4]} kg m. No model can hold that: give it "
            "a mass, or identify with physical=True."
        )
    if p[0] == 0.0:
        xx, xy, yy, xz, yz, zz = p[4:]
        inertia = Inertia(0.0, np.zeros(3), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    else:
        inertia = Inertia.from_parameters(p)
    if check and not inertia.is_physical():
        moments = np.linalg.eigvalsh(inertia.inertia)
        raise ModelError(
            f"{subject} cannot exist: mass {p[0]:.6g} kg, principal moments {moments} kg m^2; expected a mass of zero "
            "or more, and moments of which none is negative or larger than the other two together. Identify with "
            "physical=True, or pass check=False."
        )
    return _constant(inertia)


def _constant(inertia: Inertia) -> Inertia:
    return Inertia(float(inertia.mass), constant(inertia.com + 0.0), constant(inertia.inertia + 0.0))


def _changed(joint: Joint, name: str, entries: tuple[float, ...]) -> Joint:
    if name == "effort":
        return replace(joint, limits=replace(joint.limits, effort=entries))
    changes: dict[str, Any] = {name: entries}
    return replace(joint, **changes)
