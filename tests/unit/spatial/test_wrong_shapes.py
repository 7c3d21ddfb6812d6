"""Functions of `ulna.spatial` take lists, and refuse arrays of which they would read some entries only."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ulna import spatial
from ulna.errors import DtypeError, InputError, ShapeError
from ulna.spatial import SE3

ROTATION = spatial.rotation_about(2, 0.3)
ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "rpy_to_matrix": ([0.1, 0.2, 0.3],),
    "rpy_rate_matrix": ([0.1, 0.2, 0.3],),
    "rpy_rate_matrix_inverse": ([0.1, 0.2, 0.3],),
    "rpy_rate_matrix_dot": ([0.1, 0.2, 0.3], [1.0, 2.0, 3.0]),
    "eul_to_matrix": ([0.1, 0.2, 0.3],),
    "eul_rate_matrix": ([0.1, 0.2, 0.3],),
    "eul_rate_matrix_inverse": ([0.1, 0.2, 0.3],),
    "matrix_to_rpy": (ROTATION.tolist(),),
    "matrix_to_eul": (ROTATION.tolist(),),
    "matrix_to_angle_axis": (ROTATION.tolist(),),
    "matrix_to_quat_xyzw": (ROTATION.tolist(),),
    "so3_log": (ROTATION.tolist(),),
    "so3_exp": ([0.1, 0.2, 0.3],),
    "so3_left_jacobian": ([0.1, 0.2, 0.3],),
    "so3_right_jacobian": ([0.1, 0.2, 0.3],),
    "so3_left_jacobian_inverse": ([0.1, 0.2, 0.3],),
    "so3_right_jacobian_inverse": ([0.1, 0.2, 0.3],),
    "se3_exp": ([0.1, 0.2, 0.3, 0.4, 0.5, 0.6],),
    "se3_left_jacobian": ([0.1, 0.2, 0.3, 0.4, 0.5, 0.6],),
    "se3_right_jacobian": ([0.1, 0.2, 0.3, 0.4, 0.5, 0.6],),
    "se3_left_jacobian_inverse": ([0.1, 0.2, 0.3, 0.4, 0.5, 0.6],),
    "se3_right_jacobian_inverse": ([0.1, 0.2, 0.3, 0.4, 0.5, 0.6],),
    "quat_exp": ([0.1, 0.2, 0.3],),
    "quat_log": ([0.0, 0.6, 0.0, 0.8],),
    "quat_conjugate": ([0.0, 0.6, 0.0, 0.8],),
    "quat_normalize": ([0.0, 0.6, 0.0, 0.8],),
    "quat_xyzw_to_matrix": ([0.0, 0.6, 0.0, 0.8],),
    "quat_multiply": ([0.0, 0.6, 0.0, 0.8], [0.6, 0.0, 0.0, 0.8]),
    "quat_rotate": ([0.0, 0.6, 0.0, 0.8], [1.0, 2.0, 3.0]),
}


def dense(result: Any) -> list[Any]:
    """A result as nested lists."""
    parts = result if isinstance(result, tuple) else (result,)
    return [np.asarray(part).tolist() for part in parts]


@pytest.mark.parametrize("name", ARGUMENTS)
def test_lists_are_arrays_and_other_shapes_are_refused(name: str) -> None:
    function, arguments = getattr(spatial, name), ARGUMENTS[name]
    arrays = [np.array(a) for a in arguments]
    assert dense(function(*arguments)) == dense(function(*arrays))
    for place, array in enumerate(arrays):
        longer = np.zeros([n + 1 for n in array.shape])
        longer[tuple(slice(n) for n in array.shape)] = array
        for wrong in (longer, array[:2], array.reshape(*array.shape, 1), 5.0):
            with pytest.raises(ShapeError):
                function(*(wrong if k == place else a for k, a in enumerate(arrays)))
        for wrong in ("x", None):
            with pytest.raises(DtypeError):
                function(*(wrong if k == place else a for k, a in enumerate(arrays)))


@pytest.mark.parametrize("name", ARGUMENTS)
@pytest.mark.parametrize("kind", ["int8", "uint8"])
def test_whole_numbers_do_not_overflow_and_unsigned_ones_have_a_sign(name: str, kind: str) -> None:
    whole = [np.round(40 * np.asarray(a)) for a in ARGUMENTS[name]]
    if np.asarray(ARGUMENTS[name][0]).ndim == 2:
        whole = [np.diag([1.0, 1.0, 1.0])]
    function = getattr(spatial, name)
    assert dense(function(*(a.astype(kind) for a in whole))) == dense(function(*whole))


def test_masked_entries_are_refused() -> None:
    with pytest.raises(InputError, match="`w` is a masked array with 1 masked entry"):
        spatial.so3_exp(np.ma.array([0.1, 0.2, 0.3], mask=[0, 1, 0]))
    np.testing.assert_array_equal(
        spatial.so3_exp(np.ma.array([0.1, 0.2, 0.3])), spatial.so3_exp([0.1, 0.2, 0.3])
    )


def test_keywords_are_looked_at_too() -> None:
    assert spatial.so3_exp(w=[0.0, 0.0, 0.0]).tolist() == np.eye(3).tolist()
    with pytest.raises(ShapeError, match=r"`v` has shape \(4,\)"):
        spatial.quat_rotate([0.0, 0.0, 0.0, 1.0], v=np.zeros(4))
    with pytest.raises(ShapeError, match=r"`axis` has shape \(2,\)"):
        spatial.angle_axis_to_matrix(0.3, [0.0, 1.0])


@pytest.mark.parametrize("axis", [3, -1, "x", 5.0, None, [0, 1]])
def test_an_axis_is_0_1_or_2(axis: Any) -> None:
    with pytest.raises(InputError, match="expected 0, 1 or 2 for x, y or z"):
        spatial.rotation_about(axis, 0.3)


def test_the_logarithm_of_a_matrix_names_what_makes_it_a_pose() -> None:
    np.testing.assert_array_equal(spatial.se3_log(SE3.trans(1, 2, 3)).linear, [1.0, 2.0, 3.0])
    with pytest.raises(InputError, match="SE3.from_matrix"):
        spatial.se3_log(np.eye(4))  # type: ignore[arg-type]
