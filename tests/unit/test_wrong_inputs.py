"""What newcomers pass in place of a configuration, and what they call inside compiled functions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from ulna.checks.arrays import check_finite
from ulna.errors import InputError, NonFiniteError, TraceError
from ulna.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return ulna.load("panda")


class _Table:
    """A table with named columns, which takes part in ufuncs as those of pandas do."""

    def to_numpy(self) -> Any:
        return np.zeros((5, 7))

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self.to_numpy()

    def __array_ufunc__(self, *_: Any, **__: Any) -> Any:
        raise NotImplementedError("tables have no ufuncs with core axes")


@pytest.mark.parametrize(
    ("library", "name", "advice"),
    [
        ("pandas.core.frame", "DataFrame", r"q\[list\(robot.joint_names\)\].to_numpy\(\)"),
        ("pandas.core.series", "Series", r"q.to_numpy\(\)"),
        ("polars.series.series", "Series", r"q.to_numpy\(\)"),
        ("xarray.core.dataarray", "DataArray", r"q.to_numpy\(\)"),
    ],
)
def test_tables_are_refused_with_the_way_to_an_array(
    robot: Robot, library: str, name: str, advice: str
) -> None:
    table = type(name, (_Table,), {"__module__": library})()
    for call in (robot.fk, robot.mass_matrix, robot.kernel("fk")):
        with pytest.raises(
            InputError, match=f"`q` is a {name} of {library.split('.', maxsplit=1)[0]}; .*{advice}"
        ):
            call(table)


def test_tables_of_dask_are_refused(robot: Robot) -> None:
    table = type("DataFrame", (_Table,), {"__module__": "dask.dataframe.dask_expr._collection"})()
    with pytest.raises(InputError, match=r"q\[list\(robot.joint_names\)\].to_dask_array\(lengths=True\)"):
        robot.fk(table)


def test_names_and_dictionaries_in_place_of_a_configuration(robot: Robot) -> None:
    with pytest.raises(InputError, match=r'robot.configurations\["qr"\]'):
        robot.fk("qr")
    with pytest.raises(InputError, match=r"np.array\(\[q\[name\] for name in robot.joint_names\]\)"):
        robot.fk(dict(zip(robot.joint_names, np.zeros(7), strict=True)))
    q = dict(zip(robot.joint_names, range(7), strict=True))
    assert np.array([q[name] for name in robot.joint_names]).tolist() == list(range(7))


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda r, q: r.distance(q), "robot.distance"),
        (lambda r, q: r.collides(q), "robot.collides"),
        (lambda r, q: r.distance_gradient(q), "robot.collision.distance_gradient"),
        (lambda r, q: r.first_contact(q, 2.0 * q), "robot.collision.first_contact"),
        (lambda r, q: r.first_contact(np.zeros(7), q), "robot.collision.first_contact"),
    ],
)
def test_collision_checks_in_compiled_functions(robot: Robot, call: Any, name: str) -> None:
    with pytest.raises(TraceError, match=f"{name} takes numbers only.*ulna.collision.sphere_clearance"):
        ulna.compile(lambda q: call(robot, q), robot)


def test_searches_in_compiled_functions(robot: Robot) -> None:
    with pytest.raises(TraceError, match="ik .* takes numbers only.*Call it outside"):
        ulna.compile(lambda q: robot.ik(robot.fk(q)).q, robot)
    with pytest.raises(TraceError, match="robot.ik_all takes numbers only.*Call it outside"):
        ulna.compile(lambda q: robot.ik_all(robot.fk(q)).q, robot)


@pytest.mark.parametrize("size", [100, 50_000])
def test_finite_entries_are_checked_in_arrays_of_any_size(size: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Scalar products of long arrays take threads of BLAS, which made `fk` thirty times slower on a busy machine."""
    vdot = np.vdot

    def short(a: np.ndarray, b: np.ndarray) -> object:
        assert a.size < 10_000
        return vdot(a, b)

    monkeypatch.setattr(np, "vdot", short)
    array = np.linspace(-1e200, 1e200, size)
    check_finite("x", array)
    for values in ([np.nan], [np.inf, -np.inf], [-np.inf]):
        array[7 : 7 + len(values)] = values
        with pytest.raises(NonFiniteError, match=r"x\[7\]|index"):
            check_finite("x", array)
