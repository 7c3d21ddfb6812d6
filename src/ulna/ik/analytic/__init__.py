"""Closed forms and elimination for arms of six turning joints."""

from ulna.ik.analytic.chain import Arm as Arm
from ulna.ik.analytic.chain import arm_of as arm_of
from ulna.ik.analytic.geometry import Plan as Plan
from ulna.ik.analytic.geometry import plans as plans
