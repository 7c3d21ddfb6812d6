"""Closed forms and elimination for arms of six turning joints."""

from ulna.ik.analytic.chain import Arm as Arm
from ulna.ik.analytic.chain import arm_of as arm_of
from ulna.ik.analytic.geometry import ArmGeometry as ArmGeometry
from ulna.ik.analytic.geometry import arm_geometries as arm_geometries

Plan = ArmGeometry
"""The former name of `ArmGeometry`."""

plans = arm_geometries
"""The former name of `arm_geometries`."""
