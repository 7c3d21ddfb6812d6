"""Lie groups of configurations, and those of joints and models."""

from __future__ import annotations

from pinocchio._model.lie_group import R1, R2, R3, SE2, SE3, SO2, SO3, LieGroup, Rn, blocks_of
from pinocchio._model.model import Model

__all__ = ["R1", "R2", "R3", "SE2", "SE3", "SO2", "SO3", "LieGroup", "Rn", "lieGroup"]


def lieGroup(model: Model) -> LieGroup:
    """The group of a model's configurations."""
    return LieGroup(tuple(block for joint in list(model.joints)[1:] for block in blocks_of(joint)))
