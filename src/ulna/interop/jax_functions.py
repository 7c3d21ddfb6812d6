"""Compiled functions as JAX functions: one primitive with its rules, which XLA runs as native code.

The primitive has three parameters: the function, in how many of its last inputs it is linear, and for a forward
derivative what it is one of. That is linear in the tangents, which is what JAX needs to know to transpose it;
transposed it is the reverse derivative of the same function, which loops have, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import jax  # pyright: ignore[reportMissingImports]
import jax.extend  # pyright: ignore[reportMissingImports]
import jax.numpy as jnp  # pyright: ignore[reportMissingImports]
from jax.core import ShapedArray, Tracer  # pyright: ignore[reportMissingImports]
from jax.interpreters import ad, batching, mlir  # pyright: ignore[reportMissingImports]

from ulna.compiler import Function
from ulna.compiler.language.ports import batch_shape
from ulna.compiler.runtime.xla_call import load_xla_call
from ulna.errors import DtypeError, InputError
from ulna.interop.arguments import check_count
from ulna.interop.derivatives import Choice, derivatives_of
from ulna.system import forks

Origin = tuple[Function, Choice]
"""A function, and for each of its inputs whether it has a tangent in a forward derivative."""

_lock = forks.lock(forks.RECIPES)
_targets: dict[
    tuple[str, str], tuple[str, Any]
] = {}  # XLA may call what was registered until the process ends


@final
class JaxFunction:
    """A compiled function of JAX arrays; see `ulna.interop.to_jax`.

    Args:
        function: The traced function.
    """

    def __init__(self, function: Function) -> None:
        self.function = function

    def __call__(self, *arrays: Any) -> Any:
        """Evaluates the function, at once or in a JAX transformation.

        Args:
            *arrays: An array (..., n) for each input, of JAX or what it converts.

        Returns:
            An array, or a tuple of several, float64 where an argument is, else float32. Whole numbers become JAX's
            default type; float64 takes `jax_enable_x64`.

        Raises:
            TypeError: If the number of arrays is not that of the inputs.
            DtypeError: If an argument holds no real numbers.
            ShapeError: If a shape does not fit.
            InputError: If an array lies on another device than the CPU.
        """
        check_count(self.function, arrays)
        converted = [self._array(x, p.name) for x, p in zip(arrays, self.function.inputs, strict=True)]
        kinds = [
            x.dtype if jnp.issubdtype(x.dtype, jnp.floating) else jnp.result_type(float) for x in converted
        ]
        kind = jnp.float64 if jnp.float64 in kinds else jnp.float32
        results = _evaluate(self.function, 0, [x.astype(kind) for x in converted])
        return results[0] if self.function.single else results

    def __repr__(self) -> str:
        return f"<JAX function {self.function.name}{self.function.signature}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return JaxFunction, (self.function,)

    def _array(self, value: Any, name: str) -> Any:
        """An argument as a JAX array."""
        x = jnp.asarray(value)
        if not (jnp.issubdtype(x.dtype, jnp.floating) or jnp.issubdtype(x.dtype, jnp.integer)):
            raise DtypeError(name, str(x.dtype), "real numbers", f"jnp.asarray({name}, float) converts it.")
        if not isinstance(x, Tracer):
            device = next(iter(x.devices()))
            if device.platform != "cpu":
                raise InputError(
                    f"`{name}` is on {device}; expected an array on the CPU. "
                    f'jax.device_put({name}, jax.devices("cpu")[0]) copies it there.'
                )
        return x


def _evaluate(f: Function, linear: int, arrays: Sequence[Any]) -> tuple[Any, ...]:
    """Applies the primitive to arrays whose batch axes are made alike."""
    batch = batch_shape(f.inputs, [x.shape for x in arrays])
    wide = [jnp.broadcast_to(x, batch + p.shape) for x, p in zip(arrays, f.inputs, strict=True)]
    return tuple(_call.bind(*wide, function=f, linear=linear, origin=None))


_call = jax.extend.core.Primitive("ulna")
_call.multiple_results = True


def _shapes(*arrays: Any, function: Function, linear: int, origin: Origin | None) -> list[Any]:
    """The shapes and types of the results."""
    first = arrays[0]
    batch = first.shape[: first.ndim - len(function.inputs[0].shape)]
    return [ShapedArray(batch + p.shape, first.dtype) for p in function.outputs]


def _native(*arrays: Any, function: Function, linear: int, origin: Origin | None) -> list[Any]:
    """The call of the native code, which is compiled now."""
    shapes = _shapes(*arrays, function=function, linear=linear, origin=origin)
    results = [jax.ShapeDtypeStruct(s.shape, s.dtype) for s in shapes]
    if any(0 in s.shape for s in results):
        return [jnp.zeros(s.shape, s.dtype) for s in results]
    return list(jax.ffi.ffi_call(_target(function, arrays[0].dtype.name), results)(*arrays))


def _target(function: Function, dtype: str) -> str:
    """The name by which XLA knows the code."""
    shapes = str([p.shape for p in (*function.inputs, *function.outputs)])
    key = f"{function.fingerprint}{shapes}", dtype
    with _lock:
        if key not in _targets:
            address, code = load_xla_call(function, dtype)
            name = f"ulna.{len(_targets)}.{function.name}.{dtype}"
            jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(address), platform="cpu")
            _targets[key] = name, code
        return _targets[key][0]


def _forward(
    primals: Sequence[Any], tangents: Sequence[Any], *, function: Function, linear: int, origin: Origin | None
) -> Any:
    """The rule of the forward derivative."""
    moving = tuple(type(t) is not ad.Zero for t in tangents)
    derivative = derivatives_of(function).forward(moving)
    moving_tangents = [t for t, m in zip(tangents, moving, strict=True) if m]
    results = _call.bind(*primals, function=function, linear=linear, origin=origin)
    return results, _call.bind(
        *primals,
        *moving_tangents,
        function=derivative,
        linear=len(moving_tangents),
        origin=(function, moving),
    )


def _transposed(
    cotangents: Sequence[Any], *arrays: Any, function: Function, linear: int, origin: Origin | None
) -> list[Any]:
    """The rule of the reverse derivative, of a function that is linear in its last inputs."""
    unknown = tuple(ad.is_undefined_primal(x) for x in arrays)
    count = len(arrays) - linear
    if any(unknown[:count]):
        raise InputError(f"{function.name} is not linear in what it is to be transposed by.")
    batch = next(
        x.aval.shape[: x.aval.ndim - len(p.shape)]
        for x, p, u in zip(arrays, function.inputs, unknown, strict=True)
        if u
    )
    kind = next(x.aval.dtype for x, u in zip(arrays, unknown, strict=True) if u)
    bars = [
        jnp.zeros(batch + p.shape, kind) if type(bar) is ad.Zero else bar
        for bar, p in zip(cotangents, function.outputs, strict=True)
    ]
    if origin is None:
        back = derivatives_of(function).reverse(unknown, without=linear)
    else:
        unknown_tangents = iter(unknown[count:])
        wanted = tuple(m and next(unknown_tangents) for m in origin[1])
        back = derivatives_of(origin[0]).reverse(wanted)
    # It is linear in the cotangents, the last inputs, in turn.
    cotangents_of_inputs = iter(
        _call.bind(*arrays[:count], *bars, function=back, linear=len(bars), origin=None)
    )
    return [next(cotangents_of_inputs) if u else None for u in unknown]


def _batched(
    arrays: Sequence[Any], axes: Sequence[Any], *, function: Function, linear: int, origin: Origin | None
) -> Any:
    """The rule of `vmap`: one more batch axis in front."""
    length = next(x.shape[d] for x, d in zip(arrays, axes, strict=True) if d is not None)
    wide = [
        jnp.broadcast_to(x, (length, *x.shape)) if d is None else jnp.moveaxis(x, d, 0)
        for x, d in zip(arrays, axes, strict=True)
    ]
    results = _call.bind(*wide, function=function, linear=linear, origin=origin)
    return results, [0] * len(results)


_call.def_abstract_eval(_shapes)
_call.def_impl(jax.jit(_native, static_argnames=("function", "linear", "origin")))
mlir.register_lowering(_call, mlir.lower_fun(_native, multiple_results=True))
ad.primitive_jvps[_call] = _forward
ad.primitive_transposes[_call] = _transposed
batching.primitive_batchers[_call] = _batched
