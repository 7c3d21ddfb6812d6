"""Nothing is silently accepted: complex numbers, None, data of other models, wrong flags, sizes without bounds."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from ulna.errors import InputError

MODEL = (
    "pin.rnea({m}, {d}, q, v, v)",
    "pin.forwardKinematics({m}, {d}, q)",
    "pin.crba({m}, {d}, q)",
    "pin.computeAllTerms({m}, {d}, q, v)",
    "pin.updateFramePlacements({m}, {d})",
    "pin.updateFramePlacement({m}, {d}, 1)",
    "pin.updateGlobalPlacements({m}, {d})",
    "pin.getFrameVelocity({m}, {d}, 1)",
    "pin.getFrameJacobian({m}, {d}, 1, pin.LOCAL)",
    "pin.computeFrameJacobian({m}, {d}, q, 1)",
    "pin.computeJointJacobian({m}, {d}, q, 1)",
    "pin.computeSupportedInertiaByFrame({m}, {d}, 1, True)",
    "pin.computeSupportedForceByFrame({m}, {d}, 1)",
    "pin.computeJointKinematicRegressor({m}, {d}, 1, pin.LOCAL)",
    "pin.computeStaticTorque({m}, {d}, q, forces)",
    "pin.centerOfMass({m}, {d}, q)",
    "pin.cholesky.decompose({m}, {d})",
    "pin.computeMechanicalEnergy({m}, {d}, q, v)",
)
ALONE = (
    "pin.integrate({m}, q, v)",
    "pin.difference({m}, q, q)",
    "pin.neutral({m})",
    "pin.randomConfiguration({m})",
)
ARRAYS = (
    "pin.rnea(m, d, {x}, v, v)",
    "pin.rnea(m, d, q, {x}, v)",
    "pin.integrate(m, q, {x})",
    "pin.interpolate(m, q, {x}, 0.5)",
    "pin.dIntegrate(m, {x}, v)",
    "pin.tangentMapProduct(m, q, {x})",
    "pin.neutral(m) @ pin.JointModelRX().calc(m.joints[1].createData(), {x})",
    "setattr(d, 'tau', {x})",
    "setattr(m, 'armature', {x})",
    "pin.exp6({x})",
    "pin.Motion({x})",
    "pin.Force({x})",
)
FLAGS = (
    ("pin.crba(m, d, q, 'abc')", "convention"),
    ("pin.crba(m, d, q, 1)", "convention"),
    ("pin.centerOfMass(m, d, q, compute_subtree_coms='no')", "compute_subtree_coms"),
    ("pin.jacobianCenterOfMass(m, d, q, 'no')", "compute_subtree_coms"),
    ("pin.getJointJacobian(m, d, 1, 0)", "reference frame"),
    ("pin.rpy.computeRpyJacobian(np.zeros(3), 0)", "reference frame"),
    ("pin.ModelPool(m, 2**70)", "2361183241434822606848|1180591620717411303424"),
    ("pin.ModelPool(m, -1)", "-1"),
    ("pin.rneaInParallel(2**70, pin.ModelPool(m, 2), columns, columns, columns)", "num_thread"),
    ("pin.rneaInParallel(3, pin.ModelPool(m, 2), columns, columns, columns)", "the pool has 2 data"),
    ("pin.abaInParallel(-1, pin.ModelPool(m, 2), columns, columns, columns)", "num_thread"),
    ("pin.ModelPool(None, 1)", "None"),
    ("pin.getJointJacobian(m, d, 'here', pin.LOCAL)", "here"),
    ("pin.getJointJacobian(m, d, -1, pin.LOCAL)", "-1"),
    ("pin.getFrameVelocity(m, d, 10**6)", "1000000"),
    ("pin.computeStaticTorqueDerivatives(m, d, q, None)", "one for each joint"),
    ("pin.aba(m, d, q, v, v, 3)", "one for each joint"),
    ("pin.computeCollisions(shapes, pin.GeometryModel().createData(), True)", "made for 0 geometries"),
    ("pin.computeDistance(shapes, pin.GeometryModel().createData(), 0)", "made for 0 geometries"),
    ("shapes.createData().activateCollisionPair(9)", "there are none"),
    ("pin.updateGeometryPlacements(m, d, far, far.createData())", "another robot"),
    ("pin.computeCollisions(m, d, far, far.createData(), q, True)", "another robot"),
    ("pin.buildReducedModel(m, far, [1], q)", "another robot"),
)

HELD = (
    ("setattr(m.inertias[1], 'mass', [None])", "mass"),
    ("setattr(m, 'gravity', [])", "gravity"),
    ("setattr(m, 'referenceConfigurations', abs)", "referenceConfigurations"),
    ("setattr(d, 'kinetic_energy', int)", "kinetic_energy"),
    ("setattr(d, 'Ivx', -1)", "Ivx"),
    ("setattr(pin.Quaternion.Identity(), 'x', np.zeros(0))", "`x`"),
    ("setattr(pin.BaumgarteCorrectorParameters(1.0, 2.0), 'Kd', int)", "Kd"),
    ("setattr(m.frames[2].copy(), 'parentFrame', (1,))", "frame"),
    ("setattr(m.frames[2].copy(), 'type', m)", "expected a FrameType"),
    ("setattr(m, 'inertias', None)", "read only"),
    ("setattr(m, 'jointPlacements', [pin.SE3.Identity()])", "7 entries"),
    ("anchor.mapJointSpaceToConstraintMotion(m, d, held, object(), q, pin.LOCAL)", "each joint"),
    ("pin.LieGroup((1,))", "LieGroup"),
    ("pin.liegroups.Rn('a')", "`n`"),
    ("pin.StdVec_Force(3)", "StdVec_Force was given 3"),
    ("pin.JointModelHX(int)", "pitch"),
    ("pin.ModelPool(m, 2).getModel(int)", "int"),
    ("pin.ContactCholeskyDecomposition(m, d, np.zeros(6))", "constraint is"),
    ("pin.dIntegrateTransport(m, q, v, np.zeros(0), pin.ARG1)", "Jin"),
    ("pin.Data(None)", "pinocchio.Model"),
    ("pin.GeometryModel().collisionPairs.append(2)", "CollisionPair"),
    ("pin.GeometryModel().collisionPairs.extend([pin.CollisionPair(0, 1), q])", "CollisionPair"),
    ("pin.GeometryModel().createData().activeCollisionPairs.append('text')", "True or False"),
    ("m.referenceConfigurations.update({3: q})", "expected a text"),
    ("m.referenceConfigurations.__ior__({'here': 'there'})", "expected real numbers"),
    ("m.referenceConfigurations.setdefault('here')", "None|real numbers"),
)
"""What is assigned or passed, and what the message says of it."""


@pytest.fixture(scope="module")
def names() -> Iterator[dict[str, Any]]:
    with using("pinocchio"):
        import pinocchio as pin

        m = pin.buildSampleModelManipulator()
        small = pin.buildReducedModel(m, [6], pin.neutral(m))
        d, q = m.createData(), np.linspace(0.1, 0.6, 6)
        pin.forwardKinematics(m, d, q, q, q)
        pin.computeJointJacobians(m, d, q)
        forces = pin.StdVec_Force([pin.Force.Zero() for _ in range(m.njoints)])
        far = pin.buildSampleGeometryModelManipulator(m)
        far.geometryObjects[0].parentJoint = 9
        yield {
            "far": far,
            "pin": pin,
            "m": m,
            "d": d,
            "q": q,
            "v": q,
            "columns": np.zeros((6, 3)),
            "other": small.createData(),
            "anchor": (anchor := pin.FrameAnchorConstraintModel(m, 3)),
            "held": anchor.createData(),
            "np": np,
            "forces": forces,
            "shapes": pin.buildSampleGeometryModelManipulator(m),
        }


@pytest.mark.parametrize("call", MODEL)
def test_what_is_no_model_or_no_data_of_it(call: str, names: dict[str, Any]) -> None:
    for m, d in (("None", "d"), ("m", "None"), ("d", "m"), ("q", "d"), ("m", "other")):
        for _ in range(2):
            with pytest.raises(InputError, match="expected|createData") as caught:
                eval(call.format(m=m, d=d), names)
            assert isinstance(caught.value, TypeError) or d == "other"


def test_every_function_checks_its_model_and_its_data(names: dict[str, Any]) -> None:
    """Whatever else is passed: of what a function reads first, the model and the data are named."""
    pin, checked = names["pin"], 0
    usual = {"model": names["m"], "data": names["d"], **dict.fromkeys(("q", "v", "a", "tau"), names["q"])}
    for name in dir(pin):
        function = getattr(pin, name)
        if name.startswith("_") or inspect.isclass(function) or not callable(function):
            continue
        parameters = inspect.signature(function).parameters.values()
        needed = [p.name for p in parameters if p.default is p.empty and p.kind is p.POSITIONAL_OR_KEYWORD]
        for which, wrong in (
            ("model", 3),
            ("model", None),
            ("data", 3),
            ("data", None),
            ("data", names["other"]),
        ):
            if which not in needed or ({"model", "data"} - set(needed) and wrong is names["other"]):
                continue
            with pytest.raises(InputError) as caught:
                function(*(wrong if x == which else usual.get(x, 2) for x in needed))
            assert isinstance(caught.value, TypeError) or wrong is names["other"], (name, which)
            checked += 1
    assert checked > 400


@pytest.mark.parametrize("call", ALONE)
def test_an_invalid_model_is_refused(call: str, names: dict[str, Any]) -> None:
    for m in ("None", "d", "q"):
        with pytest.raises(TypeError, match=r"expected a pinocchio.Model"):
            eval(call.format(m=m), names)


@pytest.mark.parametrize("call", ARRAYS)
def test_what_is_no_array_of_real_numbers(call: str, names: dict[str, Any]) -> None:
    for x in ("q + 1j", "np.array([None] * 6)", "np.array(['1'] * 6)", "'abcdef'"):
        with pytest.raises(TypeError, match="expected real numbers") as caught:
            eval(call.format(x=x), names)
        assert isinstance(caught.value, InputError)


@pytest.mark.parametrize(("call", "word"), FLAGS)
def test_wrong_flags_sizes_and_indices(call: str, word: str, names: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=word):
        eval(call, names)


@pytest.mark.parametrize(("call", "word"), HELD)
def test_what_does_not_fit_is_called_by_its_name(call: str, word: str, names: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=word) as caught:
        eval(call, names)
    assert isinstance(caught.value, TypeError)
    with pytest.raises(TypeError, match="LieGroup"):
        _ = names["pin"].liegroups.R1() * 3


def test_integers_and_objects_that_are_numbers_are_taken(names: dict[str, Any]) -> None:
    pin, m, d, v = (names[x] for x in ("pin", "m", "d", "v"))
    wanted = pin.rnea(m, d, np.ones(6), v, v)
    for ones in (
        [1] * 6,
        np.ones(6, int),
        np.ones(6, bool),
        np.ones(6, np.float32),
        np.array([1] * 6, object),
    ):
        np.testing.assert_array_equal(pin.rnea(m, d, ones, v, v), wanted)
