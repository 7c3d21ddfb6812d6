"""Lists of constraints, remembered with the kernels that are bound to them."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._constraints.frame_pair import changes
from pinocchio._constraints.rigid_constraint import checked_constraints, structures_of
from pinocchio._containers.arrays import not_applicable
from pinocchio._data.data import Data
from pinocchio._model.model import Model

_MAX_SETS = 8
"""So many lists of constraints does a Data know."""


@final
class ConstraintSet:
    """A list of constraints with its data, for one model, and the algorithms bound to them.

    Attributes:
        live: Of each constraint its placements, gains and wanted acceleration, the arrays that users write to.
        runs: What is bound, by the key of the algorithm.
        delassus_places: The placements when a Delassus matrix was computed last, (c, 2, 4, 4).
        given: The lists that the set was asked for with last, in place of which others may have the same entries.
        left_fields: Fields of all its data in which a function noted that it leaves nothing; see `leave`.
    """

    def __init__(self, model: Model, models: Any, datas: Any) -> None:
        self.model, self.models, self.datas = model, checked_constraints(model, models, datas), list(datas)
        self.version, self.shapes = changes[0], structures_of(self.models)
        self.places = tuple(one._places for one in self.models)
        self.live = tuple(
            x
            for one, known in zip(self.models, self.datas, strict=True)
            for x in (one._places, one._gains._v, known._views["contact_acceleration_desired"]._v)
        )
        self.runs: dict[Any, Any] = {}
        self.delassus_places = np.zeros((len(self.shapes), 2, 4, 4))
        self.left_fields: tuple[str, ...] = ()
        self.given: tuple[Any, Any] = (None, None)
        # Comparisons by `list`: with `==` a `StdVec` on the other side would compare entry by entry in Python.
        self.is_of_models, self.is_of_datas = self.models.__eq__, self.datas.__eq__

    def note_places(self) -> None:
        """Notes the present placements as those of a Delassus matrix, as its kernels do by themselves."""
        for k, place in enumerate(self.places):
            self.delassus_places[k] = place

    def is_given_again(self, models: Any, datas: Any) -> bool:
        """Whether the lists are those of the last such question, and not made for each call.

        Returns:
            Whether they are.
        """
        known, self.given = self.given, (models, datas)
        return known[0] is models and known[1] is datas

    def leave(self, function: str, fields: tuple[str, ...]) -> None:
        """Notes in all data, once, that a function leaves something in fields in Pinocchio, and nothing here.

        Args:
            function: Its name.
            fields: Their names; always the same tuple.
        """
        if self.left_fields is not fields:
            for known in self.datas:
                known._leave(function, fields)
            self.left_fields = fields

    def matches(self, model: Model, models: Any, datas: Any) -> bool:
        """Whether the set was made for these constraints, and no placement has changed.

        Returns:
            Whether it was.
        """
        return (
            self.model is model
            and self.version == changes[0]
            and self.is_of_datas(datas) is True
            and self.is_of_models(models) is True
        )


def constraint_set_of(model: Model, data: Data, models: Any, datas: Any) -> ConstraintSet:
    """The constraints as they are bound to a Data.

    Args:
        data: Its data, which keeps the set.

    Returns:
        The set, made or found.

    Raises:
        InputError: see `checked_constraints`; the Data does not fit the model.
    """
    constraint_set = cached_constraint_set(model, data, models, datas)
    if constraint_set is None:
        data._attach(model)
        models, datas = list(models), list(datas)
        constraint_set = cached_constraint_set(model, data, models, datas)
    if constraint_set is None:
        constraint_set = ConstraintSet(model, models, datas)
        current = [known for known in data._constraint_sets if known.version == changes[0]]
        data._constraint_sets = [*current, constraint_set][-_MAX_SETS:]
    return constraint_set


def cached_constraint_set(model: Model, data: Data, models: Any, datas: Any) -> ConstraintSet | None:
    """The constraints as they were bound to a Data before.

    Returns:
        The set, or None.
    """
    version = changes[0]
    for known in data._constraint_sets:  # data first: they are compared by their identity
        if (
            known.version == version
            and known.is_of_datas(datas) is True
            and known.is_of_models(models) is True
            and known.model is model
        ):
            return known
    return None


def bound_run(model: Any, data: Any, models: Any, datas: Any, key: Any) -> Any:
    """What is bound to constraints that a Data knows.

    Args:
        model, data: Anything; with what is no model and no data nothing is bound.
        key: The key of the algorithm in `ConstraintSet.runs`.

    Returns:
        What is bound, or `not_applicable`.

    Raises:
        AttributeError: The data is none.
    """
    known = cached_constraint_set(model, data, models, datas)
    return not_applicable if known is None else known.runs.get(key, not_applicable)
