"""The Panda's kinematics against Robotics Toolbox for Python 1.5: recorded figures, and the package itself.

Its jacob0 is "local_world_aligned", its jacobe "local". Its hessiane is hessian0 turned into the tool's axes,
which is not the derivative of jacobe; its jacobm is the gradient of its manipulability for axes="all" only.
"""

from __future__ import annotations

import warnings
from types import SimpleNamespace

import numpy as np
import pytest

from ulna import algorithms as alg
from ulna.model import Model
from ulna.robots.panda import panda as build_panda
from ulna.typing import Floats

JACOB0_QR = [
    [0.0, 0.07962977546230257, 0.0, 0.24663697215094946, 0.0, 0.20056353570957577, 0.0],
    [0.4840468153930443, 0.0, 0.485959792891037, 0.0, 0.1546952569879749, 0.0, 0.0],
    [0.0, -0.4840468153930443, 0.0, 0.49861594034516504, 0.0, 0.10856531740695888, 0.0],
    [0.0, 0.0, -0.2955202066613396, 0.0, 0.9463000876874145, 0.0, 0.09983341664682799],
    [0.0, 1.0, 0.0, -1.0, 0.0, -1.0, 0.0],
    [1.0, 0.0, 0.9553364891256061, 0.0, -0.32328956686350363, 0.0, -0.9950041652780258],
]
JACOBE_QR = [
    [0.0, 0.030907910867440963, 0.0, 0.29518334752098396, 0.0, 0.2104, 0.0],
    [-0.4840468153930443, 0.0, -0.485959792891037, 0.0, -0.1546952569879749, 0.0, 0.0],
    [0.0, 0.4895783100568641, 0.0, -0.471502325916201, 0.0, -0.088, 0.0],
    [0.09983341664682799, 0.0, -0.19866933079506138, 0.0, 0.9092974268256817, 0.0, 0.0],
    [0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 0.0],
    [-0.9950041652780258, 0.0, -0.9800665778412416, 0.0, 0.4161468365471424, 0.0, 1.0],
]
MANIPULABILITY_QR = 0.0837515096811334


@pytest.fixture(scope="module")
def panda() -> Model:
    return build_panda()


def test_recorded_figures(panda: Model) -> None:
    qr, tool = panda.configurations["qr"], panda.frame(panda.tool)
    np.testing.assert_allclose(alg.frame_jacobian(panda, qr, tool), JACOB0_QR, atol=1e-14)
    np.testing.assert_allclose(alg.frame_jacobian(panda, qr, tool, "local"), JACOBE_QR, atol=1e-14)
    assert abs(alg.manipulability(panda, qr, tool) - MANIPULABILITY_QR) < 1e-14


@pytest.fixture(scope="module")
def rtb() -> SimpleNamespace:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        package = pytest.importorskip("roboticstoolbox")
        return SimpleNamespace(panda=package.models.Panda())


def configurations(panda: Model) -> list[Floats]:
    return [panda.configurations["qr"], *alg.random(panda, np.random.default_rng(5), (3,))]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_the_package_itself(panda: Model, rtb: SimpleNamespace) -> None:
    tool, theirs = panda.frame(panda.tool), rtb.panda
    v = np.linspace(-1.0, 1.0, 7)
    for q in configurations(panda):
        pairs = {
            "fkine": (alg.frame_pose(panda, q, tool).matrix(), theirs.fkine(q).A),
            "jacob0": (alg.frame_jacobian(panda, q, tool), theirs.jacob0(q)),
            "jacobe": (alg.frame_jacobian(panda, q, tool, "local"), theirs.jacobe(q)),
            "hessian0": (alg.frame_hessian(panda, q, tool), theirs.hessian0(q)),
            "jacob0_dot": (alg.frame_jacobian_dot(panda, q, v, tool), theirs.jacob0_dot(q, v)),
            "jacobm": (alg.manipulability_gradient(panda, q, tool), theirs.jacobm(q)[:, 0]),
        }
        for axes in ("all", "trans", "rot"):
            pairs[axes] = (alg.manipulability(panda, q, tool, axes=axes), theirs.manipulability(q, axes=axes))
        for mine, other in (("minimum_singular_value", "minsingular"), ("inverse_condition", "invcondition")):
            pairs[mine] = (alg.manipulability(panda, q, tool, mine), theirs.manipulability(q, method=other))
        for representation in ("rpy/xyz", "rpy/zyx", "eul", "exp"):
            pairs[representation] = (
                alg.analytical_jacobian(panda, q, tool, representation),
                theirs.jacob0_analytical(q, representation=representation),
            )
        for name, (mine, other) in pairs.items():
            np.testing.assert_allclose(mine, other, rtol=1e-9, atol=1e-10, err_msg=name)
