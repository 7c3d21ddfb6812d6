"""Controllers: from where a robot is and where it should be to how it should move.

Each is a pure function of the state and a few numbers, compiled with the robot: well under two microseconds a call.
`stage` and `ddp` find controls over a horizon.
"""

from ulna.control.admittance import admittance as admittance
from ulna.control.cartesian import impedance as impedance
from ulna.control.cartesian import operational_space as operational_space
from ulna.control.ddp import DDPIteration as DDPIteration
from ulna.control.ddp import DDPSolution as DDPSolution
from ulna.control.ddp import ddp as ddp
from ulna.control.joints import computed_torque as computed_torque
from ulna.control.joints import joint_pd as joint_pd
from ulna.control.obstacles import obstacle_rows as obstacle_rows
from ulna.control.rates import resolved_rate as resolved_rate
from ulna.control.reactive import Reactive as Reactive
from ulna.control.servo import p_servo as p_servo
from ulna.control.stages import Stage as Stage
from ulna.control.stages import StageDerivatives as StageDerivatives
from ulna.control.stages import TerminalDerivatives as TerminalDerivatives
from ulna.control.stages import TerminalStage as TerminalStage
from ulna.control.stages import custom_stage as custom_stage
from ulna.control.stages import stage as stage
