"""The builder of LLVM IR: each method appends an instruction; those that compute return the name of the result."""

from __future__ import annotations


class Instructions:
    """The lines of functions in textual LLVM IR.

    Attributes:
        lines: The lines so far.
        current_block: The label of the basic block that is being written.
    """

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.current_block = "entry"

    def text(self) -> str:
        """All lines."""
        return "\n".join(self.lines)

    def begin_function(self, head: str) -> None:
        """Begins a function and its first block.

        Args:
            head: The line from `define` to the attributes, without the brace.
        """
        self.lines.append(f"{head} {{")
        self.open_block("entry")

    def end_function(self) -> None:
        """Ends a function."""
        self.lines += ["}", ""]

    def open_block(self, label: str) -> None:
        """Begins a basic block."""
        self.lines.append(f"{label}:")
        self.current_block = label

    def write(self, *instructions: str) -> None:
        """Appends instructions as they are."""
        self.lines += ["  " + instruction for instruction in instructions]

    def let(self, name: str, instruction: str) -> str:
        """Appends `%name = instruction`.

        Args:
            name: The name without the `%`.
            instruction: The right side.

        Returns:
            The name of the result.
        """
        self.lines.append(f"  %{name} = {instruction}")
        return f"%{name}"

    def field(self, name: str, base: str, offset: int, kind: str = "ptr") -> str:
        """Appends instructions that load a field of a structure.

        Args:
            name: The name without the `%`; the address gets the name `name.p`.
            base: The address of the structure.
            offset: Offset of the field from that address [byte].
            kind: The type of the field.

        Returns:
            The name of its value.
        """
        pointer = self.let(f"{name}.p", f"getelementptr i8, ptr {base}, i64 {offset}")
        return self.let(name, f"load {kind}, ptr {pointer}")

    def item(self, name: str, base: str, index: int, kind: str = "ptr") -> str:
        """Appends instructions that load an item of an array.

        Args:
            name: The name without the `%`; the address gets the name `name.p`.
            base: The address of the array.
            index: The number of the item.
            kind: The type of the items.

        Returns:
            The name of its value.
        """
        pointer = self.let(f"{name}.p", f"getelementptr {kind}, ptr {base}, i64 {index}")
        return self.let(name, f"load {kind}, ptr {pointer}")

    def jump(self, label: str) -> None:
        """Ends the block by a jump to another."""
        self.write(f"br label %{label}")

    def branch(self, condition: str, label: str, otherwise: str) -> None:
        """Ends the block by a jump to one block where a condition holds, else to another.

        Args:
            condition: The name of an i1.
            label: The block where it holds.
            otherwise: The block where it does not hold.
        """
        self.write(f"br i1 {condition}, label %{label}, label %{otherwise}")
