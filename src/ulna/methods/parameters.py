"""What a robot's model has for the parameters that can be inputs of kernels."""

from __future__ import annotations

from typing import final

from ulna import model as models
from ulna.quantities.part import Part
from ulna.typing import Floats


@final
class Parameters(Part):
    """The numbers of the model: `robot.parameters["inertia"]`; `robot.with_parameters` returns a robot with others."""

    __slots__ = ()

    def __getitem__(self, name: str) -> Floats:
        """The value of a parameter; `ulna.model.parameters` lists their names."""
        return models.parameters(self.model, name)

    def __call__(self, name: str) -> Floats:
        """The same, as it was spelt before."""
        return self[name]

    @property
    def dynamic(self) -> Floats:
        """Mass, first moments and inertia of each joint's body, (10 nbodies,); see `ulna.model.dynamic_parameters`."""
        return models.dynamic_parameters(self.model)
