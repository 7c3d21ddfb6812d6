"""Controllers: from where a robot is and where it should be to how it should move."""

from ulna.control.servo import p_servo as p_servo
