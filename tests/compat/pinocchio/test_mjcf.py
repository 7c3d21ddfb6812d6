"""MJCF files through Ulna's package: the same models, numbers and geometries as Pinocchio reads out of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from support.two_pythons import both

BODIES = """
<mujoco model="arm"><compiler angle="radian"/>
  <asset><material name="red" rgba="1 0 0 0.5"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="base">
      {free}<geom name="g0" size="0.1"/>
      <body name="c" pos="0.1 0.2 0.3" euler="0.1 0.2 0.3">
        <joint name="j1" axis="1 0 0" pos="0.1 0.02 0.03" range="-1 1" damping="0.1" armature="0.01" frictionloss="0.3"/>
        <joint name="j2" type="slide" axis="0 1 0"/>
        <geom name="seen" type="capsule" pos="0 0 0.5" size="0.05 0.5" contype="0" conaffinity="0" group="1" mass="0"/>
        <geom name="sheet" type="capsule" pos="0 0 0.5" size="0.05 0.5" group="3" material="red"/>
        <site name="s" pos="0.1 0 0.4"/>
        <body name="z" pos="0 0 1"><joint name="j3" type="ball" pos="0 0.1 0"/>
          <geom type="box" size="0.1 0.2 0.3" rgba="0 1 0 1"/></body>
        <body name="a" pos="0 0 1"><joint name="j0"/><geom type="ellipsoid" size="0.1 0.2 0.3"/></body>
        <body name="f" pos="0 0 1" euler="0.3 0 0"><geom type="cylinder" size="0.1 0.2"/></body>
      </body>
    </body>
  </worldbody>
  {keys}
</mujoco>"""
ARM = BODIES.format(free="", keys='<keyframe><key name="home" qpos="0.1 0.2 1 0 0 0 0.3"/></keyframe>')
CLOSED = """
<mujoco><compiler angle="radian"/><worldbody><body name="base"><geom size="0.1"/>
  <body name="c" pos="0.1 0.2 0.3" euler="0.1 0.2 0.3"><joint name="j1" axis="1 0 0"/><geom size="0.1"/></body>
  <body name="d" pos="0.4 0.2 0.3" euler="0.1 0.4 0.3"><joint name="j2" axis="1 0 0"/><geom size="0.1"/>
    <body name="e" pos="0 0 1"><geom size="0.1"/></body></body></body></worldbody>
  <equality><connect body1="c" body2="e" anchor="0.1 0.2 0.3"/><weld body1="c" body2="d"/>
  <weld body1="d" relpose="0.1 0.2 0.3 1 0 0 0"/></equality></mujoco>"""
UNNAMED = """
<mujoco><worldbody><body name="n"><joint/><joint type="slide"/><geom size="0.1"/><site pos="0 0 1"/><site name="s"/><site/>
  <body name="p"><joint name="q"/><joint type="slide"/><geom size="0.1"/></body>
  <body name="r"><joint/><geom size="0.1"/></body></body></worldbody></mujoco>"""
FLOATING = BODIES.format(free="<freejoint/>", keys="")


def test_models_of_mjcf_files(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    folder = tmp_path / "files"
    folder.mkdir()
    (folder / "arm.xml").write_text(ARM)
    (folder / "floating.xml").write_text(FLOATING)
    (folder / "closed.xml").write_text(CLOSED)
    (folder / "unnamed.xml").write_text(UNNAMED)
    own, wanted = both(Path(__file__).parent / "mjcf_asked.py", tmp_path, str(folder))
    for file, questions in wanted.items():
        for question, value in questions.items():
            answer = own[file][question]
            if value and isinstance(np.ravel(np.asarray(value, dtype=object))[0], str):
                assert answer == value, (file, question)
            else:
                np.testing.assert_allclose(answer, value, atol=1e-9, err_msg=f"{file}: {question}")
