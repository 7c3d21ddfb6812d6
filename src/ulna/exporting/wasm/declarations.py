"""The types of the JavaScript module, for TypeScript and for editors."""

from __future__ import annotations

from typing import Any

_TOP = """// Written by Ulna; do not edit.

/** Numbers, row after row, or rows of them. Matrices of three.js are column after column: transpose them first. */
export type Numeric = ArrayLike<number> | readonly (readonly number[])[] | readonly (readonly (readonly number[])[])[];

/** What the module knows of the robot and its functions. */
export interface Description {
  readonly name: string;
  readonly dtype: "float64" | "float32";
  /** Numbers and names of joints, limits [rad or m] (null: none); null without a robot. */
  readonly robot: null | {
    readonly name: string; readonly nq: number; readonly nv: number;
    readonly joints: readonly { name: string; q: number; nq: number; v: number; nv: number; kind: string }[];
    readonly lowerPosition: readonly (number | null)[]; readonly upperPosition: readonly (number | null)[];
    readonly neutral: readonly number[];
  };
  readonly functions: Readonly<Record<string, {
    summary: string; choices: Record<string, string>; inputs: readonly Argument[]; outputs: readonly Argument[];
  }>>;
  readonly searches: Readonly<Record<string, {
    frames: readonly string[]; choices: Record<string, string>; goal: Argument; q0: Argument; start: readonly number[];
  }>>;
}
export interface Argument { name: string; shape: readonly number[]; size: number; unit: string; text: string }

/** A configuration found by a search. */
export interface Solution {
  /** Configuration [rad or m]; where `success` is false, the nearest to the goal that was found. */
  q: Float64Array;
  /** Whether every goal is met within the tolerances, within the joint limits. */
  success: boolean;
  /** Greatest distance of a frame from its goal [m], and greatest angle [rad]. */
  positionError: number; rotationError: number;
  /** The same for each frame. */
  positionErrors: Float64Array; rotationErrors: Float64Array;
  /** Steps taken, and the number of the starting point that led to the solution. */
  iterations: number; attempt: number;
}

export interface SearchOptions {
  /** Greatest distance from the goal [m], default 1e-6. */
  positionTolerance?: number;
  /** Greatest angle from the goal [rad], default 1e-6. */
  rotationTolerance?: number;
  /** About how many starting points are tried, default 400. */
  attempts?: number;
}
"""

_TAIL = """
export type Source = string | URL | Response | BufferSource | WebAssembly.Module;

/**
 * Loads the functions, by default from the .wasm file beside this module.
 * @throws Error Where WebAssembly SIMD is missing, or the file cannot be read.
 */
export function load(source?: Source): Promise<Kernels>;
/** The same at once, from bytes or a compiled module. */
export function loadSync(source: BufferSource | WebAssembly.Module): Kernels;
export const description: Description;
export default load;
"""


def declarations(about: dict[str, Any]) -> str:
    """The text of the .d.ts file.

    Args:
        about: From `description`.

    Returns:
        The text.
    """
    array = "Float32Array" if about["dtype"] == "float32" else "Float64Array"
    lines = [
        _TOP,
        "/** The functions. All arguments are checked; a TypeError or RangeError says what is wrong. */",
    ]
    lines += ["export interface Kernels {", "  readonly description: Description;"]
    for name, f in about["functions"].items():
        lines += [*_comment(f), f"  {name}{_signature(f, array)};"]
    for name, s in about["searches"].items():
        frames = ", ".join(s["frames"])
        summary = (
            f"Inverse kinematics of {frames}: a configuration that reaches the pose T [m], within the limits."
        )
        detail = "Near q0 [rad or m] if that is given, else any."
        lines += [f"  /** {_plain(summary)} {detail} */"]
        lines += [f"  {name}(T: Numeric, q0?: Numeric | null, options?: SearchOptions): Solution;"]
    return "\n".join([*lines, "}", _TAIL])


def _comment(f: dict[str, Any]) -> list[str]:
    """The documentation of a function."""
    choices = ", ".join(f"{key}: {value}" for key, value in f["choices"].items())
    lines = [
        f"   * {_plain(f['summary'] or 'A function of your own.')}",
        *([f"   * ({_plain(choices)})"] if choices else []),
    ]
    for word, arguments in (("@param", f["inputs"]), ("@returns", f["outputs"])):
        for a in arguments:
            shape = "(" + ", ".join(map(str, a["shape"])) + ")" if a["shape"] else "a number"
            unit = f" [{a['unit']}]" if a["unit"] else ""
            name = f" {_parameter(a['name'])}" if word == "@param" else ""
            lines.append(f"   * {word}{name} {shape}{unit} {_plain(a['text'])}".rstrip())
    return ["  /**", *lines, "   */"]


_RESERVED = (
    "arguments", "await", "break", "case", "catch", "class", "const", "continue", "debugger", "default",
    "delete", "do", "else", "enum", "eval", "export", "extends", "false", "finally", "for", "function",
    "if", "implements", "import", "in", "instanceof", "interface", "let", "new", "null", "package",
    "private", "protected", "public", "return", "static", "super", "switch", "this", "throw", "true", "try",
    "typeof", "var", "void", "while", "with", "yield",
)  # fmt: skip


def _parameter(name: str) -> str:
    """A name that a parameter may have in TypeScript."""
    return f"{name}_" if name in _RESERVED else name


def _signature(f: dict[str, Any], array: str) -> str:
    inputs = [f"{_parameter(a['name'])}: {'Numeric' if a['shape'] else 'number'}" for a in f["inputs"]]
    taken = {a["name"] for a in f["inputs"]}
    outputs = []
    for k, a in enumerate(f["outputs"]):
        name = a["name"] if a["name"] not in taken else f"{a['name']}_result"
        outputs.append(f"{name if len(f['outputs']) > 1 or k else 'out'}?: {array}")
    kinds = [array if a["shape"] else "number" for a in f["outputs"]]
    result = kinds[0] if len(kinds) == 1 else f"[{', '.join(kinds)}]"
    return f"({', '.join([*inputs, *outputs])}): {result}"


def _plain(text: str) -> str:
    """A text that can stand in a comment."""
    return " ".join(text.replace("*/", "* /").split())
