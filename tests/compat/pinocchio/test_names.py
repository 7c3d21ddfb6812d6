"""Names: all are said in words, the page of names is up to date, and what is not offered says what to use."""

from __future__ import annotations

import importlib
import inspect
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import variables
from ulna.errors import InputError

ROOT = Path(__file__).parents[3]
MODULES = (
    "cholesky",
    "explog",
    "liegroups",
    "linalg",
    "rpy",
    "serialization",
    "shortcuts",
    "utils",
    "visualize",
)


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _own(thing: Any) -> bool:
    return str(getattr(thing, "__module__", "")).startswith("pinocchio")


def test_every_public_name_is_documented_in_words(pin: Any) -> None:
    silent = []
    for module in (pin, *(importlib.import_module(f"pinocchio.{name}") for name in MODULES)):
        assert module.__doc__
        for name in dir(module):
            thing = getattr(module, name)
            if name.startswith("_") or isinstance(thing, ModuleType) or not _own(thing):
                continue
            if not inspect.getdoc(thing):
                silent.append(f"{module.__name__}.{name}")
            if inspect.isclass(thing):
                members = {n: m for cls in thing.__mro__ if _own(cls) for n, m in vars(cls).items()}
                silent += [
                    f"{name}.{n}"
                    for n, member in members.items()
                    if not n.startswith("_")
                    and (inspect.isroutine(member) or isinstance(member, (property, staticmethod)))
                    and not inspect.getdoc(getattr(thing, n) if isinstance(member, staticmethod) else member)
                ]
    assert not silent


def test_names_that_are_imported_when_used_are_there(pin: Any) -> None:
    from pinocchio._package.lazy_names import lazy_names  # pyright: ignore

    names = lazy_names()
    assert set(names) <= set(dir(pin))
    for name in names:
        assert getattr(pin, name) is not None


def test_functions_made_of_records_have_their_names_and_arguments(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q, zero = model.createData(), np.linspace(0.1, 0.6, 6), np.zeros(6)
    assert list(inspect.signature(pin.rnea).parameters) == ["model", "data", "q", "v", "a", "fext"]
    assert pin.rnea.__module__ == "pinocchio._algorithms.dynamics" and "torques" in pin.rnea.__doc__
    with pytest.raises(TypeError, match=r"rnea\(\) missing 2 required"):
        pin.rnea(model, data, q)
    weight = pin.computeGeneralizedGravity(model, data, q)
    for _ in range(2):  # the general case, and the bound kernel
        np.testing.assert_allclose(pin.rnea(model, data, q=q, v=zero, a=zero), weight, atol=1e-12)
        np.testing.assert_allclose(pin.rnea(model, data, list(q), zero, zero), weight, atol=1e-12)
    with pytest.raises(InputError, match="accelerations without velocities"):
        pin.forwardKinematics(model, data, q, a=zero)


def test_none_is_no_argument(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data, q, zero = model.createData(), np.linspace(0.1, 0.6, 6), np.zeros(6)
    pin.forwardKinematics(model, data, q, zero, zero)
    pin.computeJointJacobians(model, data, q)
    calls: dict[str, Any] = {
        "fext": lambda: pin.rnea(model, data, q, zero, zero, None),
        "v": lambda: pin.forwardKinematics(model, data, q, None),
        "q": lambda: pin.computeJointJacobians(model, data, q=None),
        "data": lambda: pin.computeTotalMass(model, None),
        "argument_position": lambda: pin.dIntegrate(model, q, zero, None),
        "NoneType": lambda: pin.getFrameVelocity(model, data, 5, None),
        "other": lambda: pin.Model(None),
        "res": lambda: pin.Symmetric3(np.eye(3)).inverse(None),
        "upper_bound": lambda: pin.randomConfiguration(model, q, None),
        "lower_bound": lambda: pin.randomConfiguration(model, upper_bound=q),
    }
    for words, call in calls.items():
        for _ in range(2):  # the general case, and what is known of its types
            with pytest.raises(TypeError, match=words):
                call()
    assert pin.computeTotalMass(model, data) == pin.computeTotalMass(model)
    np.testing.assert_array_equal(pin.centerOfMass(model, data, q, None), data.com[0])  # no: no subtrees


def test_what_is_misspelt_offers_the_nearest_name(pin: Any) -> None:
    with pytest.raises(AttributeError, match="Did you mean 'forwardKinematics'"):
        _ = pin.forwardKinematic
    with pytest.raises(ImportError, match="Did you mean 'forwardKinematics'"):
        from pinocchio import forwardKinematic  # noqa: F401  # pyright: ignore
    with pytest.raises(ImportError, match="convert them to URDF"):
        from pinocchio import buildModelsFromSdf  # noqa: F401  # pyright: ignore
    with pytest.raises(AttributeError, match="compile"):
        _ = pin.casadi
    assert not hasattr(pin, "no such name")


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ("casadi cppad", "ulna.compile"),
        ("buildModelFromSdf WITH_SDF", "convert them to URDF"),
        ("MJCFParser", "buildModelFromMJCF"),
        ("OSQP SPECTRAL", "ADMMUpdateRule"),
        ("Panda3dVisualizer RVizVisualizer", "MeshcatVisualizer"),
        ("numpy inspect", "no part of Pinocchio"),
        (
            "pinocchio_pywrap_default submodules map_indexing_suite_X_entry deprecation",
            "binding of Pinocchio",
        ),
        ("quite_another_thing", "pip install pin"),
    ],
)
def test_what_is_not_offered_says_what_to_use(pin: Any, names: str, words: str) -> None:
    for name in names.split():
        with pytest.raises(AttributeError) as caught:
            getattr(pin, name)
        assert words in str(caught.value), caught.value


@pytest.mark.slow
def test_the_page_of_names_is_up_to_date() -> None:
    pytest.importorskip("pinocchio")
    script = ROOT / "benchmarks" / "compat_pinocchio_names.py"
    done = subprocess.run(
        [sys.executable, str(script), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_classes_show_no_names_but_pinocchios_and_older_spellings(pin: Any) -> None:
    more = {
        "Model": {"jointPosition", "ulna"},
        "Data": {"bodyRegressor"},
        "Frame": set(),
        "GeometryModel": set(),
    }
    script = (
        f"import json, pinocchio; print(json.dumps({{n: dir(getattr(pinocchio, n)) for n in {list(more)}}}))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=variables(None)
    )
    for name, offered in json.loads(done.stdout).items():
        shown = {n for n in dir(getattr(pin, name)) if not n.startswith("_")}
        assert shown - set(offered) == more[name]
