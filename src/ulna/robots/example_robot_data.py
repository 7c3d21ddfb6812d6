"""The robots of the package example-robot-data: where it is installed, a name for each description."""

from __future__ import annotations

import sys
from pathlib import Path

from ulna.data_classes import dataclass
from ulna.errors import MissingExtra, UnknownName

_FOLDERS = ("cmeel.prefix/share/example-robot-data", "share/example-robot-data")


@dataclass(frozen=True)
class Description:
    """One description of the package.

    Attributes:
        name: what to load it by.
        urdf: the URDF, below the folder robots/.
        srdf: the SRDF beside it, or None.
        floating: whether the real robot is free to move about (a humanoid, a quadruped, a drone), so that a
            free-flyer root makes sense.
        posture: the named configuration of the SRDF it usually starts from, or None.
    """

    name: str
    urdf: str
    srdf: str | None = None
    floating: bool = False
    posture: str | None = None


_FIXED = """
    alex_nub_hands            alex_description/urdf/alex_nub_hands.urdf                      alex_nub_hands default
    alex_psyonic_hands        alex_description/urdf/alex_psyonic_hands.urdf                  alex_psyonic_hands default
    alex_sake_hands           alex_description/urdf/alex_sake_hands.urdf                     alex_sake_hands default
    allegro_left_hand         allegro_hand_description/urdf/allegro_left_hand.urdf
    allegro_right_hand        allegro_hand_description/urdf/allegro_right_hand.urdf
    asr_twodof                asr_twodof_description/urdf/TwoDofs.urdf
    baxter                    baxter_description/urdf/baxter.urdf                            baxter_manipulation neutral
    double_pendulum           double_pendulum_description/urdf/double_pendulum.urdf
    double_pendulum_continuous double_pendulum_description/urdf/double_pendulum_continuous.urdf
    double_pendulum_simple    double_pendulum_description/urdf/double_pendulum_simple.urdf
    finger_edu                finger_edu_description/robots/finger_edu.urdf                  finger_edu hanging
    human                     human_description/robots/human.urdf
    kinova                    kinova_description/robots/kinova.urdf                          kinova arm_up
    panda                     panda_description/urdf/panda.urdf                              panda default
    panda_collision           panda_description/urdf/panda_collision.urdf                    panda default
    so100                     so_arm_description/urdf/so100.urdf
    so101                     so_arm_description/urdf/so101.urdf
    talos_arm                 talos_data/robots/talos_left_arm.urdf                          talos half_sitting
    tiago                     tiago_description/robots/tiago.urdf
    tiago_dual                tiago_description/robots/tiago_dual.urdf
    tiago_no_hand             tiago_description/robots/tiago_no_hand.urdf
    tiago_pro                 tiago_pro_description/robots/tiago_pro.urdf
    ur3                       ur_description/urdf/ur3_robot.urdf
    ur3_empty                 ur_description/urdf/ur3.urdf
    ur3_gripper               ur_description/urdf/ur3_gripper.urdf                           ur3_gripper
    ur3_limited               ur_description/urdf/ur3_joint_limited_robot.urdf
    ur5                       ur_description/urdf/ur5_robot.urdf                             ur5
    ur5_gripper               ur_description/urdf/ur5_gripper.urdf                           ur5_gripper
    ur5_limited               ur_description/urdf/ur5_joint_limited_robot.urdf               ur5_joint_limited_robot
    ur10                      ur_description/urdf/ur10_robot.urdf
    ur10_limited              ur_description/urdf/ur10_joint_limited_robot.urdf
    xarm7                     xarm_description/urdf/xarm7.urdf                               xarm7 home
    z1                        z1_description/urdf/z1.urdf                                    z1 arm_up
"""

_FLOATING = """
    a1                        a1_description/urdf/a1.urdf                                    a1 standing
    alexander                 alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf     alexander default
    anymal                    anymal_b_simple_description/robots/anymal.urdf                 anymal standing
    anymal_c                  anymal_c_simple_description/urdf/anymal.urdf                   anymal standing
    anymal_kinova             anymal_b_simple_description/robots/anymal-kinova.urdf          anymal-kinova standing_with_arm_up
    b1                        b1_description/urdf/b1.urdf                                    b1 standing
    b1_z1                     b1_description/urdf/b1-z1.urdf                                 b1-z1 standing_with_arm_home
    bolt                      bolt_description/robots/bolt.urdf                              bolt standing
    borinot                   borinot_description/urdf/borinot_flying_arm_2.urdf             borinot_flying_arm_2 home
    centauro                  centauro_description/urdf/centauro.urdf                        centauro homing_nominal
    g1                        g1_description/urdf/g1_29dof_rev_1_0.urdf
    g1_with_hands             g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf
    go1                       go1_description/urdf/go1.urdf                                  go1 standing
    go2                       go2_description/urdf/go2.urdf                                  go2 standing
    hector                    hector_description/robots/quadrotor_base.urdf
    hextilt                   hextilt_description/urdf/hextilt_flying_arm_5.urdf             hextilt_flying_arm_5 home
    hyq                       hyq_description/robots/hyq_no_sensors.urdf                     hyq standing
    icub                      icub_description/robots/icub.urdf                              icub half_sitting
    icub_reduced              icub_description/robots/icub_reduced.urdf                      icub half_sitting
    iris                      iris_description/robots/iris_simple.urdf
    iris_full                 iris_description/robots/iris.urdf
    laikago                   laikago_description/urdf/laikago.urdf
    pr2                       pr2_description/urdf/pr2.urdf                                  pr2 tuck_right_arm
    quadruped                 quadruped_description/urdf/quadruped.urdf
    romeo                     romeo_description/urdf/romeo.urdf                              romeo half_sitting
    romeo_small               romeo_description/urdf/romeo_small.urdf                        romeo_small half_sitting
    romeo_laas_small          romeo_description/urdf/romeo_laas_small.urdf                   romeo_small half_sitting
    simple_humanoid           simple_humanoid_description/urdf/simple_humanoid.urdf          simple_humanoid half_sitting
    simple_humanoid_classical simple_humanoid_description/urdf/simple_humanoid_classical.urdf simple_humanoid_classical half_sitting
    solo8                     solo_description/robots/solo.urdf                              solo standing
    solo12                    solo_description/robots/solo12.urdf                            solo standing
    talos                     talos_data/robots/talos_reduced.urdf                           talos half_sitting
    talos_box                 talos_data/robots/talos_reduced_box.urdf                       talos half_sitting
    talos_corrected           talos_data/robots/talos_reduced_corrected.urdf                 talos half_sitting
    talos_full                talos_data/robots/talos_full_v2.urdf                           talos half_sitting
    talos_full_box            talos_data/robots/talos_full_v2_box.urdf                       talos half_sitting
"""  # noqa: E501


def _table(text: str, floating: bool) -> dict[str, Description]:
    descriptions = {}
    for line in text.strip().splitlines():
        name, urdf, srdf, posture, *_ = (*line.split(), None, None)
        assert name is not None and urdf is not None
        if srdf is not None:
            srdf = f"{urdf.split('/')[0]}/srdf/{srdf}.srdf"
        descriptions[name] = Description(name, urdf, srdf, floating, posture)
    return descriptions


DESCRIPTIONS: dict[str, Description] = dict(sorted((_table(_FIXED, False) | _table(_FLOATING, True)).items()))
"""Every URDF of example-robot-data 6.0 by a name, that of the project's own loaders where there is one."""


def share_folder() -> Path | None:
    """The folder example-robot-data of the installed package (it holds robots/), or None."""
    import importlib.metadata  # slow to import, and needed only here

    try:
        distribution = importlib.metadata.distribution("example-robot-data")
    except importlib.metadata.PackageNotFoundError:
        distribution = None
    candidates = [Path(str(distribution.locate_file(f))) for f in _FOLDERS] if distribution else []
    candidates += [Path(sys.prefix) / f for f in _FOLDERS]
    return next((c for c in candidates if (c / "robots").is_dir()), None)


def files(name: str) -> tuple[Path, Path | None]:
    """The URDF and the SRDF of a description.

    Raises:
        UnknownName: there is no description of that name.
        MissingExtra: the package is not installed.
    """
    if name not in DESCRIPTIONS:
        raise UnknownName("robot of example-robot-data", name, DESCRIPTIONS)
    folder = share_folder()
    if folder is None:
        raise MissingExtra("example-robot-data", "robots", f"The robot {name!r}")
    entry = DESCRIPTIONS[name]
    srdf = folder / "robots" / entry.srdf if entry.srdf else None
    return folder / "robots" / entry.urdf, srdf if srdf is not None and srdf.is_file() else None
