"""The parts of RobotWrapper."""
