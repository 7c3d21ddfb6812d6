"""MJCF: couplings of several joints, actuators with several controls, frames and replicas, collisions by pairs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from support.mjcf_compare import differences
from support.mjcf_physics import compiled, loaded
from ulna.collision import link_pairs
from ulna.errors import ModelWarning
from ulna.formats.mjcf_loops import loops_from_mjcf
from ulna.geometry import Sphere

mujoco: Any = pytest.importorskip("mujoco")
FOUR = "".join(
    f'<body name="{n}" pos="{k} 0 0"><joint name="{n}" ref="{10 * k}" axis="0 1 0"/><geom size="0.1" pos="0.2 0 0"/></body>'
    for k, n in enumerate("abcd")
)


def coupled(*equalities: str) -> str:
    return f"<mujoco><worldbody>{FOUR}</worldbody><equality>{''.join(equalities)}</equality></mujoco>"


def equal(one: str, two: str, line: str = "0.1 2") -> str:
    return f'<joint joint1="{one}" joint2="{two}" polycoef="{line} 0 0 0"/>'


@pytest.mark.parametrize(
    ("equalities", "left"),
    [
        ((equal("a", "b"), equal("a", "c")), 2),
        ((equal("a", "b"), equal("b", "c"), equal("c", "d")), 1),
        ((equal("a", "b"), equal("c", "b"), equal("c", "d")), 1),
        ((equal("a", "b", "0.1 2"), equal("b", "a", "-0.05 0.5")), 3),
    ],
)
def test_joints_coupled_by_several_equalities_keep_all_of_them(
    equalities: tuple[str, ...], left: int
) -> None:
    text = coupled(*equalities)
    model, said = loaded(text)
    assert not said
    assert model.nq == left
    assert differences(text) == []


def test_equalities_that_contradict_each_other_are_named() -> None:
    with pytest.warns(ModelWarning, match="contradict") as caught:
        robot = ulna.load(coupled(equal("a", "b"), equal("b", "a")))
    assert len(caught) == 1
    assert robot.nq == 3


def test_what_is_not_active_or_disabled_is_no_loop() -> None:
    weld = '<weld body1="a" body2="b" active="{}"/>'
    assert len(loops_from_mjcf(coupled(weld.format("true")))) == 1
    assert loops_from_mjcf(coupled(weld.format("false"))) == ()
    off = coupled(weld.format("true")).replace(
        "<mujoco>", '<mujoco><option><flag equality="disable"/></option>'
    )
    assert loops_from_mjcf(off) == ()
    assert loaded(off)[1] == [] == loaded(coupled(weld.format("false")))[1]


def test_actuators_with_several_controls_limit_the_joint_they_act_on() -> None:
    actuators = """<actuator><pid joint="a" input="pos vel ff" kp="1"/><motor joint="b" gear="2" forcerange="-3 3"/>
    <motor joint="c" ctrlrange="-1 1" gear="5"/></actuator>"""
    text = f"<mujoco><worldbody>{FOUR}</worldbody>{actuators}</mujoco>"
    assert compiled(text).nu > 3
    np.testing.assert_array_equal(ulna.load(text).model.effort_limit, (np.inf, 6.0, 5.0, np.inf))


def test_frames_and_replicas() -> None:
    """Elements that MuJoCo's schema does not list, because its reader writes them out."""
    text = """<mujoco><worldbody><frame pos="1 0 0" euler="0 30 0"><body name="a"><joint axis="0 1 0"/><geom size=".1"/>
    <replicate count="3" euler="0 0 40"><body name="r" pos="1 0 0"><joint type="slide" axis="1 0 0"/><geom size=".1"/></body>
    </replicate></body></frame></worldbody></mujoco>"""
    assert loaded(text)[0].nq == 4
    assert differences(text) == []


def test_a_warning_names_what_there_is_most_of_only_three_times() -> None:
    text = f"<mujoco><default><joint stiffness='1'/></default><worldbody>{FOUR}</worldbody></mujoco>"
    (said,) = loaded(text)[1]
    assert "joint 'a' (line 1), joint 'b' (line 1), joint 'c' (line 1) and 1 more" in said


def test_a_free_body_collides_with_the_floor() -> None:
    text = """<mujoco><worldbody><geom type="plane" size="0 0 1"/><body name="ball" pos="0 0 1"><freejoint/>
    <geom size="0.2"/></body></worldbody></mujoco>"""
    from ulna.collision import link_pairs

    assert link_pairs(ulna.load(text).model) == (("world", "ball"),)


@pytest.mark.parametrize("excluded", [True, False])
def test_bodies_of_which_only_some_geoms_may_touch_are_named_unless_they_are_excluded(excluded: bool) -> None:
    """Bodies without joints between them never move apart, and are not named either."""
    two = '<geom size="0.1"/><geom size="0.1" pos="0 0 0.3" contype="2" conaffinity="2"/>'
    exclude = '<exclude body1="a" body2="c"/>' if excluded else ""
    text = f"""<mujoco><worldbody><body name="a"><freejoint/>{two}<body name="fixed" pos="0 1 0">{two}</body></body>
    <body name="c" pos="2 0 0"><freejoint/>{two}</body></worldbody><contact>{exclude}
    <exclude body1="fixed" body2="c"/></contact></mujoco>"""
    model, said = loaded(text)
    named = [text for text in said if "only some geoms may touch" in text]
    assert [("'a' and 'c'" in text, "'fixed'" in text) for text in named] == [(True, False)] * (not excluded)
    pairs = {frozenset(pair) for pair in link_pairs(model)}
    assert (frozenset("ac") in pairs) is not excluded and frozenset(("fixed", "c")) not in pairs


def test_bodies_without_a_name_leave_the_others_theirs() -> None:
    text = """<mujoco><worldbody><body><joint name="j1"/><geom size=".1"/>
    <body name="body_1" pos="1 0 0"><joint name="j2"/><geom size=".2"/></body></body></worldbody></mujoco>"""
    model = ulna.load(text).model
    assert [link.name for link in model.links] == ["world", "body_1_2", "body_1"]
    assert model.joints[model.link("body_1").joint].name == "j2"
    geoms = {geometry.name: geometry.shape for link in model.links for geometry in link.visuals}
    assert geoms == {"body_1_2Geom_0": Sphere(0.1), "body_1Geom_0": Sphere(0.2)}


def test_geoms_have_the_colours_that_mujoco_draws() -> None:
    text = """<mujoco><asset><material name="m" rgba="0 1 0 1"/></asset><worldbody><body>
    <joint/><geom material="m" rgba="1 0 0 1" size=".1"/><geom material="m" size=".2"/><geom rgba="0 0 1 .5" size=".3"/>
    <geom material="m" rgba=".5 .5 .5 1" size=".4"/></body></worldbody></mujoco>"""
    m = compiled(text)
    scene = mujoco.MjvScene(m, maxgeom=20)
    data = mujoco.MjData(m)
    mujoco.mj_forward(m, data)
    mujoco.mjv_updateScene(
        m, data, mujoco.MjvOption(), None, mujoco.MjvCamera(), mujoco.mjtCatBit.mjCAT_ALL, scene
    )
    drawn = [g.rgba.tolist() for g in scene.geoms[: scene.ngeom] if g.objtype == mujoco.mjtObj.mjOBJ_GEOM]
    visuals = ulna.load(text).model.links[1].visuals
    materials = [geometry.material for geometry in visuals]
    assert [list(material.rgba or ()) for material in materials if material is not None] == drawn
