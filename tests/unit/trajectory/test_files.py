"""Trajectories in files come back as they went."""

from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna import trajectory
from ulna.errors import InputError
from ulna.model import ModelBuilder, Revolute
from ulna.spatial import SE3

POINTS = np.random.default_rng(3).normal(size=(6, 4))


def test_npz_keeps_every_bit(tmp_path: Path) -> None:
    t = trajectory.minimum_jerk(POINTS, duration=3.0)
    t.save(tmp_path / "t.npz")
    back = trajectory.load(tmp_path / "t.npz")
    assert back == t and repr(back) == repr(t)


def test_csv_keeps_every_row(tmp_path: Path) -> None:
    t = trajectory.s_curve(POINTS[0], POINTS[1], 1.0, 2.0, 9.0)
    t.save(tmp_path / "t.csv", rate=200.0)
    head = (tmp_path / "t.csv").read_text().splitlines()[0]
    assert head == "t,q0,q1,q2,q3,v_q0,v_q1,v_q2,v_q3,a_q0,a_q1,a_q2,a_q3"
    rows, back = t.sample(rate=200.0), trajectory.load(tmp_path / "t.csv")
    inner = rows.t[:-1]
    np.testing.assert_array_equal(back(inner), rows.q[:-1])
    np.testing.assert_array_equal(back.v(inner), rows.v[:-1])
    np.testing.assert_array_equal(back.a(inner), rows.a[:-1])
    np.testing.assert_allclose(back.end, rows.q[-1], atol=1e-14)
    np.testing.assert_allclose(back(rows.t + 0.002), t(rows.t + 0.002), atol=1e-6)


def test_a_table_without_accelerations_is_read_too(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("t,a1,a2,v_a1,v_a2\n0,0,0,0,0\n1,1,2,0,0\n")
    t = trajectory.load(tmp_path / "t.csv")
    assert t.space.names == ("a1", "a2")
    np.testing.assert_allclose(t(0.5), [0.5, 1.0])


def test_poses_go_to_csv(tmp_path: Path) -> None:
    line = trajectory.pose_line(SE3.identity(), SE3.trans(1, 2, 3), 1.0)
    line.save(tmp_path / "t.csv", rate=10.0)
    table = np.loadtxt(tmp_path / "t.csv", delimiter=",", skiprows=1)
    assert table.shape == (11, 1 + 16 + 12)
    np.testing.assert_allclose(table[-1, 1:17].reshape(4, 4), line.end)
    with pytest.raises(InputError, match="poses"):
        trajectory.load(tmp_path / "t.csv")
    with pytest.raises(InputError, match=r"save it as \.csv"):
        line.save(tmp_path / "t.npz")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "head line"),
        ("x,q0\n0,1\n1,2\n", "head line"),
        ("t,q0,v_q0\n0,1,0\n", "two rows"),
        ("t,q0,v_q0\n0,1,0\n1,2\n", "3 numbers"),
        ("t,q0,v_q0\n0,1,0\n1,two,0\n", "3 numbers"),
        ("t,q0\n0,1\n1,2\n", "0 velocities"),
        ("t,q0,v_q0\n0,1,0\n1,nan,0\n", "row 3"),
        ("t,q0,v_q0\n0,1,0\n0,2,0\n", "does not increase"),
        ("t,q0,v_q0\n1,1,0\n2,2,0\n", "expected 0"),
    ],
)
def test_broken_tables_are_refused(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(InputError, match=said):
        trajectory.load(tmp_path / "t.csv")


def test_broken_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file"):
        trajectory.load(tmp_path / "missing.npz")
    with pytest.raises(InputError, match="ends in"):
        trajectory.load(tmp_path / "t.bag")
    with pytest.raises(InputError, match="ends in"):
        trajectory.quintic(0.0, 1.0, 1.0).save(tmp_path / "t.bag")
    (tmp_path / "t.npz").write_bytes(b"nothing")
    with pytest.raises(InputError, match=r"no \.npz"):
        trajectory.load(tmp_path / "t.npz")
    (tmp_path / "latin.csv").write_bytes("t,q0,v_q0\n0,1,ä".encode("latin-1"))
    with pytest.raises(InputError, match="no table"):
        trajectory.load(tmp_path / "latin.csv")
    (tmp_path / "bare.csv").write_text("t\n0\n1\n")
    with pytest.raises(InputError, match="no columns of positions"):
        trajectory.load(tmp_path / "bare.csv")
    trajectory.quintic(0.0, 1.0, 1.0).save(tmp_path / "good.npz")
    content = (tmp_path / "good.npz").read_bytes()
    (tmp_path / "cut.npz").write_bytes(content[:-30])
    with pytest.raises(InputError, match=r"no \.npz"):
        trajectory.load(tmp_path / "cut.npz")
    with np.load(tmp_path / "good.npz") as kept:
        arrays = dict(kept)
    for changed in ({"names": np.array(["a", "b"])}, {"names": np.zeros(1)}, {"kind": np.array("x")}):
        np.savez(tmp_path / "changed.npz", **{**arrays, **changed})  # type: ignore[arg-type]
        with pytest.raises(InputError, match="holds"):
            trajectory.load(tmp_path / "changed.npz")
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    with pytest.raises(InputError, match="expected a trajectory"):
        trajectory.load(tmp_path / "other.npz")


@pytest.mark.parametrize(
    "names",
    [
        *[("v_left", "a_right"), ("a_1", "v_1"), ('q"1', '"q'), ("new\nline", "t,1")],
        *[("x", "v_x"), ("v_x", "x"), ("x", "a_x", "v_x"), ("t", "v_t"), ("v", "v_v", "a_v", "v_a_v")],
    ],
)
def test_joints_of_any_name_come_back_from_a_table(tmp_path: Path, names: tuple[str, ...]) -> None:
    builder = ModelBuilder("arm").add_link("base")
    for k, name in enumerate(names):
        builder.add_link(f"link{k}")
        builder.add_joint(name, Revolute((0, 0, 1)), "base" if k == 0 else f"link{k - 1}", f"link{k}")
    robot = ulna.Robot(builder.build())
    move = trajectory.straight(robot, robot.neutral, np.linspace(1.0, -0.5, robot.nq), duration=2.0)
    move.save(tmp_path / "move.csv", rate=50)
    again = trajectory.load(tmp_path / "move.csv")
    assert again.space.names == names
    np.testing.assert_allclose(again(0.77), move(0.77), atol=1e-9)


def test_columns_of_a_table_are_found_by_their_names_or_refused(tmp_path: Path) -> None:
    file = tmp_path / "move.csv"
    file.write_text("t,a,b,v_b,v_a\n0,0,0,2,1\n1,1,2,2,1\n")
    np.testing.assert_allclose(trajectory.load(file)(0.25), [0.25, 0.5], atol=1e-12)
    file.write_text("t,q_0,v_0,q_1,v_1\n0,0,1,0,2\n1,1,1,2,2\n")
    with pytest.raises(InputError, match="expected those of all positions, then of all velocities"):
        trajectory.load(file)
    file.write_text("t,a,v_a\n0,0,1,5\n1,1,1,5\n")
    with pytest.raises(InputError, match="3 names of columns, and rows of 4 numbers"):
        trajectory.load(file)
