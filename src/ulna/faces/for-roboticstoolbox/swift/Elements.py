"""The controls once more, for `from swift.Elements import ...`."""

from swift._choices import Checkbox, Radio, Select
from swift._element import SwiftElement
from swift._elements import Button, Label, Slider

__all__ = ["Button", "Checkbox", "Label", "Radio", "Select", "Slider", "SwiftElement"]
