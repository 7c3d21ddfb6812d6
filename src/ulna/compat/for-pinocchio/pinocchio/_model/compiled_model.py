"""Kernels compiled for a model, with parameters of the model as constants or as inputs."""

from __future__ import annotations

import copy
from collections.abc import Callable, Container, Sequence
from dataclasses import replace
from typing import Any, final

import numpy as np

from pinocchio._model.bound_kernels import ParameterKernel
from pinocchio._model.core_model import core_model
from pinocchio._model.kernel_parameters import with_parameters
from pinocchio._model.live_parameters import LiveParameters
from pinocchio._spatial.small_kernels import pose
from ulna import kernels, spatial
from ulna.algorithms.constraints.kkt_factors import joined
from ulna.compiler import compile as compile_function
from ulna.model import Frame
from ulna.model import Model as CoreModel
from ulna.model.joints.axes import snap_pose
from ulna.system import forks
from ulna.system.cached import cached_property
from ulna.typing import Array, Floats

COMPILING = forks.lock(forks.RECIPES)
"""Held while a kernel is compiled, so that other threads that need it wait instead of compiling it, too."""
_MAX_FRAME_CHANGES = 3
"""How many times frames move before kernels take their placements as inputs."""


@final
class CompiledModel:
    """Ulna's model of a Model, and the kernels compiled for it; some parameters may be inputs of all kernels.

    Attributes:
        source: The Model.
        parameter_names: Which parameters are inputs, out of `PARAMETERS`; the others are constants.
        parameters: Their values at one moment, block by block.
        live_parameters: The blocks of the Model that hold them.
        cache: The kernels, shared by all that differ in `parameters` alone.
    """

    def __init__(
        self,
        source: LiveParameters,
        parameter_names: tuple[str, ...] = (),
        before: CompiledModel | None = None,
    ) -> None:
        self.source, self.parameter_names = source, parameter_names
        self._core = core_model(source)
        self.live_parameters = tuple(
            block for name in parameter_names for block in source._parameter_blocks(name)
        )
        self.parameters = tuple(block.copy() for block in self.live_parameters)
        self.cache: dict[Any, Any] = {}
        self._frame_kernels = _FrameKernels(before and before._frame_kernels)

    def with_values(self, parameters: tuple[Floats, ...]) -> CompiledModel:
        """The same kernels with other values of the parameters that are inputs."""
        other = copy.copy(self)
        other.parameters = parameters
        return other

    @property
    def model(self) -> CoreModel:
        """Ulna's model of these parameters."""
        if not self.parameter_names:
            return self._core
        return with_parameters(self._core, self._by_name(self.parameters))

    @property
    def gravity(self) -> Array:
        """The acceleration of free fall (3,)."""
        return self._by_name(self.parameters).get("gravity", self._core.gravity)

    def core_kernel(self, name: str) -> Any:
        """Ulna's kernel of that name, without options."""
        if self.parameter_names:
            return self.kernel(name)
        return _cached(self.cache, name, lambda: kernels.kernel(self._core, name))

    def kernel(self, name: str, **options: Any) -> Any:
        """A kernel of Ulna.

        Args:
            name: Its name.
            **options: Its options.

        Returns:
            The kernel.
        """
        key = (name, *options.items())
        if not self.parameter_names:
            return _cached(self.cache, key, lambda: kernels.kernel(self._core, name, **options))
        shapes = _cached(self.cache, ("shapes", *key), lambda: self._input_shapes(name, options))
        quantity = kernels.QUANTITIES[name]
        chosen = {**quantity.options, **options}
        return self.compile(key, lambda core: quantity.build(core, **chosen), **shapes)

    def _input_shapes(self, name: str, options: dict[str, Any]) -> dict[str, Any]:
        return {port.name: port.shape for port in kernels.function(self._core, name, **options).inputs}

    def compile(self, key: Any, build: Any, echoed: Any = (), /, **shapes: Any) -> Any:
        """The compiled `build(model)`, a function of arrays of these shapes; compiled once.

        Parameters whose names are in `echoed` are further outputs.

        Args:
            key: Key in the cache.
            build: Makes the function of a model of Ulna.
            echoed: Names of parameters that are further outputs.
            **shapes: Shapes of the arguments.

        Returns:
            The kernel.
        """
        kernel = _cached(self.cache, key, lambda: self._compiled(build, echoed, shapes))
        return ParameterKernel(kernel, self.parameters) if self.parameter_names else kernel

    def _compiled(self, build: Any, echoed: Any, shapes: dict[str, Any], frames: Any = ()) -> Any:
        """A kernel of inputs of these shapes, then parameters, then placements of frames."""
        if not self.parameter_names and not frames:
            return compile_function(build(self._core), **shapes)
        count, blocks = len(shapes), len(self.parameters)

        def with_inputs(*args: Any) -> Any:
            parameters = args[count : count + blocks]
            core = with_parameters(self._core, self._by_name(parameters))
            moved = (placed(frames, np.concatenate(args[count + blocks :])),) if frames else ()
            results = build(core, *moved)(*args[:count])
            copies = self.with_values(parameters).parameters_of(echoed)
            return (*(results if isinstance(results, tuple) else (results,)), *copies) if copies else results

        with_inputs.__name__ = build.__name__
        inputs = (*self.parameters, *(self.source._parameter_blocks("frames") if frames else ()))
        sizes: dict[str, Any] = {f"number{k}": x.shape for k, x in enumerate(inputs)}
        return compile_function(with_inputs, **shapes, **sizes)

    def _block_names(self) -> list[str]:
        """The name of each block of parameters."""
        return [name for name in self.parameter_names for _ in self.source._parameter_blocks(name)]

    def _by_name(self, blocks: tuple[Array, ...]) -> dict[str, Array]:
        parts: dict[str, list[Array]] = {}
        for name, block in zip(self._block_names(), blocks, strict=True):
            parts.setdefault(name, []).append(block)
        return {name: np.concatenate(arrays) for name, arrays in parts.items()}

    def live(self, kernel: Any) -> Any:
        """A kernel compiled here that, once bound, reads the parameters of the Model itself, at every call."""
        if not isinstance(kernel, ParameterKernel):
            return kernel
        blocks = (*self.live_parameters, *self.source._parameter_blocks("frames"))
        return ParameterKernel(kernel.kernel, blocks[: len(kernel.parameters)])

    def snapshot(self) -> CompiledModel:
        """These kernels with a copy of the values of the parameters."""
        return self.with_values(tuple(x.copy() for x in self.parameters)) if self.parameter_names else self

    def parameters_of(self, names: Container[str]) -> list[Floats]:
        """The blocks of parameters of some names."""
        return [x for name, x in zip(self._block_names(), self.parameters, strict=True) if name in names]

    def live_parameters_of(self, names: Container[str]) -> list[Floats]:
        """The blocks of the Model for parameters of some names."""
        return [x for name, x in zip(self._block_names(), self.live_parameters, strict=True) if name in names]

    @cached_property
    def mass_pattern(self) -> bytes:
        """Where the mass matrix may have entries, a byte for each."""
        return joined(self._core).astype(bool).tobytes()

    def compile_at_frames(self, key: Any, build: Any, echoed: Any = (), /, **shapes: Any) -> Any:
        """As `compile`, for a function that depends on frames: compiles `build(model, frames)`.

        Args:
            key: Key in the cache.
            build: Makes the function of a model of Ulna and its frames.
            echoed: Names of parameters that are further outputs.
            **shapes: Shapes of the arguments.

        Returns:
            The kernel.
        """
        current = self._frame_kernels
        current.update(self.source)
        frames, cache = current.frames, current.cache
        if current.as_inputs:
            kernel = _cached(cache, key, lambda: self._compiled(build, echoed, shapes, frames))
            placements = (x.copy() for x in self.source._parameter_blocks("frames"))
            return ParameterKernel(kernel, (*self.parameters, *placements))

        def fixed(core: CoreModel) -> Any:
            return build(core, frames)

        kernel = _cached(cache, key, lambda: self._compiled(fixed, echoed, shapes))
        return ParameterKernel(kernel, self.parameters) if self.parameter_names else kernel


class _FrameKernels:
    """Kernels that depend on frames: with placements as constants or, where these keep changing, as inputs."""

    def __init__(self, before: _FrameKernels | None) -> None:
        self.cache: dict[Any, Any] = {}
        self.frames: tuple[Frame, ...] = ()
        self.as_inputs = False
        self._state: Any = before and before._state
        self._changes = before._changes if before else 0

    def update(self, source: LiveParameters) -> None:
        """Takes the frames as they are now; kernels that were compiled for other frames are dropped."""
        state = source._frame_state()
        if state != self._state:
            moved = self._state is not None and state[0] == self._state[0]
            self._state, self._changes = state, self._changes + 1 if moved else 0
        elif self.frames:
            return
        if self.as_inputs and self._changes > _MAX_FRAME_CHANGES:
            return
        self.as_inputs = self._changes >= _MAX_FRAME_CHANGES
        self.cache = {}
        self.frames = fixed_frames(source)


def fixed_frames(source: LiveParameters) -> tuple[Frame, ...]:
    """Ulna's frames of a Model, where they are now."""
    identity = spatial.SE3.identity()
    return tuple(
        Frame(f"{i}:{f.name}", f.parentJoint - 1, snap_pose(f.placement._pose()), "user", "", identity)
        for i, f in enumerate(source.frames)
    )


def placed(frames: Sequence[Frame], placements: Array) -> tuple[Frame, ...]:
    """Frames at other placements, (n, 4, 4).

    Args:
        frames: The frames.
        placements: Poses (n, 4, 4).

    Returns:
        The frames with these poses.
    """
    return tuple(replace(frame, placement=pose(T)) for frame, T in zip(frames, placements, strict=True))


def _cached(cache: dict[Any, Any], key: Any, make: Callable[[], Any]) -> Any:
    value = cache.get(key)
    if value is None:
        with COMPILING:
            value = cache.get(key)
            if value is None:
                value = cache[key] = make()
    return value
