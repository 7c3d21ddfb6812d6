"""Reads a procedure and all that it calls: one instance in the typed tree for each combination of types."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.conversions import literal
from ulna.compiler.imperative.source import Definition, source_of
from ulna.compiler.imperative.statements import ProcedureReader
from ulna.compiler.imperative.types import Type, annotated_types, records_in, type_named


class ProgramReader:
    """Reads a procedure and all that it calls; each combination of a procedure and types once.

    Args:
        constants: Values of parameters that are compiled in.

    Attributes:
        constants: The same.
        instances: The procedures that were read, callees first.
        outside: What names of modules stood for, and the records among the types, by module and dotted name.
    """

    def __init__(self, constants: Mapping[str, bool | int | float] | None = None) -> None:
        self.constants = dict(constants or {})
        self.instances: dict[Any, t.Instance] = {}
        self.outside: dict[tuple[str, str], Any] = {}
        self._reading: list[Definition] = []

    def entry(self, definition: Definition) -> t.Instance:
        """The instance for calls from Python: every parameter has an annotation, or is among the constants.

        Args:
            definition: The procedure.

        Returns:
            The instance; those that it calls, itself included, are in `instances`, callees first.

        Raises:
            ProcedureError: If the source cannot be compiled.
        """
        source = source_of(definition.function)
        types = {k: v for k, v in self._annotations(definition).items() if k not in self.constants}
        for name in definition.parameters:
            if name not in types and name not in self.constants:
                source.fail(
                    source.tree.lineno, f"the parameter `{name}` has no type",
                    "Annotate it (int, float, f32, Array1[f32], ...), or give its value as a constant.",
                )  # fmt: skip
        constants = {
            name: literal(value, source.tree.lineno)
            for name, value in self.constants.items()
            if name in definition.parameters
        }
        return self._instance(definition, types, constants)

    def instance_of(self, definition: Definition, arguments: Sequence[t.Expression]) -> t.Instance:
        """The instance for the arguments of a call within a procedure.

        Args:
            definition: The procedure.
            arguments: An argument for each of its parameters.

        Returns:
            The instance, made at the first such call.
        """
        types = self._annotations(definition)
        constants: dict[str, t.Constant] = {}
        for name, value in zip(definition.parameters, arguments, strict=True):
            may_be_compiled_in = name not in types or name in definition.constants
            if may_be_compiled_in and isinstance(value, t.Constant) and value.is_literal:
                types.pop(name, None)
                constants[name] = value
            elif name not in types:
                types[name] = value.type
        return self._instance(definition, types, constants)

    def _annotations(self, definition: Definition) -> dict[str, Type]:
        source = source_of(definition.function)
        try:
            annotations = annotated_types(definition.function)
        except TypeError as error:
            source.fail(source.tree.lineno, str(error))
        types = {}
        for name, annotation in annotations.items():
            type_ = type_named(annotation)
            if type_ is None:
                source.fail(
                    source.tree.lineno, f"the annotation of `{name}` names no type of the language",
                    "It has bool, int, float, f32, f64, Array1[f32] to Array3[...], Kernel and NamedTuples of these.",
                )  # fmt: skip
            types[name] = type_
            for record in records_in(annotation):
                self.outside[record.__module__, record.__qualname__] = record
        return types

    def _instance(
        self, definition: Definition, types: Mapping[str, Type], constants: Mapping[str, t.Constant]
    ) -> t.Instance:
        values = tuple((name, value.value, value.type) for name, value in constants.items())
        key = (definition.function, tuple(types.items()), values)
        if key in self.instances:
            return self.instances[key]
        source = source_of(definition.function)
        if definition in self._reading:
            source.fail(source.tree.lineno, "a procedure cannot call itself", "Write a loop.")
        self._reading.append(definition)
        try:
            name = f"{definition.__name__}.{len(self.instances)}"
            reader = ProcedureReader(definition, types, constants, self.instance_of, self.outside)
            instance = reader.instance(name)
        finally:
            self._reading.pop()
        self.instances[key] = instance
        return instance
