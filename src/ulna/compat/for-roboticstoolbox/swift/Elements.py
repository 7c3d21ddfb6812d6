"""The controls once more, for `from swift.Elements import ...`."""

from swift._element import SwiftElement
from swift._option_controls import Checkbox, Radio, Select
from swift._simple_controls import Button, Label, Slider

__all__ = ["Button", "Checkbox", "Label", "Radio", "Select", "Slider", "SwiftElement"]
