"""Kinematics, dynamics, their derivatives, regressors."""
