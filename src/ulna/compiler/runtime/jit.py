"""From IR text to addresses of machine code, through LLVM; llvmlite is imported here and nowhere else."""

from __future__ import annotations

import contextlib
import itertools
import math
import mmap
import os
import sys
import time
from collections.abc import Callable, Iterator
from enum import Enum
from functools import cache, lru_cache, partial
from typing import Any

from ulna import disk_cache
from ulna.compiler.codegen import copy_rows
from ulna.compiler.codegen.heap_arrays import with_arrays_on_heap
from ulna.compiler.codegen.rare_functions import rare_functions_of, with_rare_functions_apart
from ulna.compiler.codegen.target import Target, arithmetic_of, register_bytes, wide_from
from ulna.compiler.language.function import Function
from ulna.compiler.runtime.interrupt import interruptible
from ulna.compiler.runtime.object_file import is_sound
from ulna.data_classes import dataclass
from ulna.errors import CompileError
from ulna.system import forks, process_end
from ulna.system.collector import paused_collection

# Part of the cache's key: change it with `Passes`, `optimised` and `_machine`.
_RECIPE = "rare functions apart, arrays on heap, inlining, combined if small, level 1 of short loops, codegen 2, 1 or 0"
# How much IR text of one call and of a batch LLVM compiles, about [byte/s].
_SPEED = {"entry": 4e6, "batch": 2e6, "kernel": 2e6, "xla": 2e6, "f.all": 2e6}
_LOOPS_SPEED = 3e5  # the same of procedures, whose loops are optimised [byte/s]
# Compilations that will take longer are announced; tracing took about as long already [s].
_ANNOUNCE_FROM = 0.5
watchers: list[Callable[[str, str], None]] = []
"""Called with what is compiled and about how long it takes, where it is long, and with "" once it is done."""
_SCHEDULED_TWICE = 200_000
"""Characters of IR up to which instructions are scheduled once more, after registers are allocated.

That takes a fifth of LLVM's time. It makes small code up to 1.5 % faster, and large code not."""
_COMBINED = 100_000
"""Characters of straight-line IR up to which LLVM combines instructions; a folded graph has few that it could."""
_SHORT_LOOPS = 110_000
"""Characters of IR with loops up to which LLVM runs all of its level 1.

Longer ones are mostly arithmetic that is folded and shared already: level 1 takes a third of the time, for nothing."""
_LONG_LOOPS = 500_000
"""Characters of IR with loops up to which instructions are combined, which makes single calls 2 % faster."""
_library_numbers = itertools.count()
# What LLVM keeps of an object file that was dropped, 10 kB, goes with the engine; making one takes 1.5 ms.
_GROUP = 16
_lock = forks.lock(forks.COMPILER)  # LLVM's contexts are not safe to share
# Daemon threads may still compile: LLVM must not be torn down under them. Nobody compiles from then on.
process_end.call_at_end(lambda: _lock.acquire(timeout=60.0))


@cache
def llvm_library() -> Any:
    """LLVM's library, which takes longer to load than all of Ulna; who only looks at models never waits for it."""
    with _lock, paused_collection():  # a fork while a module is imported leaves the child without it
        import llvmlite.binding

        inner = getattr(getattr(llvmlite.binding.ffi.lib, "_lock", None), "_lock", None)
        if inner is not None:  # other libraries compile with LLVM, too
            forks.adopt(inner)
        # `atexit` ignores what llvmlite registers where a function called at exit compiles the first kernel.
        is_ending = getattr(getattr(llvmlite.binding, "common", None), "_shutting_down", None)
        if isinstance(is_ending, list) and is_ending == [False]:
            is_ending[0] = _IsFinalizing()
    return llvmlite.binding


class _IsFinalizing:
    """True once modules are taken down: objects of LLVM are left then, for what closes them may be gone."""

    def __bool__(self, is_finalizing: Callable[[], bool] = sys.is_finalizing) -> bool:
        return is_finalizing()


class Passes(Enum):
    """What LLVM does with a module before it selects instructions."""

    INLINING = "functions are inlined where that is asked for"
    COMBINING = "the same, and instructions are combined"
    LEVEL_1 = "all of level 1, which optimises loops"
    QUICK = "functions are inlined where that is asked for, and instructions are selected one by one"


@dataclass(frozen=True)
class Code:
    """Machine code in memory; it stays as long as this object does."""

    engine: Any
    addresses: dict[str, int]
    seconds: float  # how long LLVM worked; 0 when it came from the cache

    def address(self, name: str) -> int:
        """Where function `name` starts."""
        return self.addresses[name]


@cache
def target() -> Target:
    """This machine."""
    llvm = llvm_library()
    with _lock:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        features = llvm.get_host_cpu_features().flatten()
        triple, cpu = llvm.get_process_triple(), llvm.get_host_cpu_name()
        return Target(
            triple=triple,
            cpu=cpu,
            features=features,
            llvm=".".join(map(str, llvm.llvm_version_info)),
            register_bytes=register_bytes(features),
            arithmetic=arithmetic_of(triple, features),
            wide_from=wide_from(cpu, features),
        )


def _new_machine(level: int = 2) -> Any:
    t = target()
    llvm_target = llvm_library().Target.from_triple(t.triple)
    return llvm_target.create_target_machine(
        cpu=t.cpu, features=t.features, opt=level, reloc="pic", codemodel="small", jit=True
    )


_machine_of_level = cache(_new_machine)


def _machine(ir: str, passes: Passes) -> Any:
    """LLVM's target machine for a module: with less effort where that is not missed."""
    if passes is Passes.QUICK:  # elsewhere level 0 has another instruction selector, GlobalISel
        return _machine_of_level(0 if target().triple.startswith("x86_64") else 1)
    return _machine_of_level(1 if passes is not Passes.LEVEL_1 and len(ir) > _SCHEDULED_TWICE else 2)


def load(f: Function, ir: str, names: tuple[str, ...]) -> Code:
    """Machine code of `ir`, which evaluates `f`, from the cache or from LLVM, with the addresses of `names`.

    Args:
        f: The function, for the announcement and the optimisation.
        ir: The text of an LLVM module.
        names: Names of definitions in it.

    Returns:
        The loaded code; it must live as long as it is called.
    """
    return _load(ir, lambda: ir, names, _passes_of(f, ir), partial(_announced, f, names[0]))


def load_text(ir: str, names: tuple[str, ...], has_loops: bool = True, is_rare: bool = False) -> Code:
    """Machine code of `ir`, which belongs to no function and is compiled in a moment.

    Args:
        ir: The text of an LLVM module.
        names: Names of definitions in it.
        has_loops: Whether it has loops that LLVM is to optimise, which takes several times as long.
        is_rare: Whether it is called so rarely that it is not to be optimised, which takes a quarter of the time.

    Returns:
        The loaded code; it must live as long as it is called.
    """
    passes = Passes.QUICK if is_rare else _wanted(passes_for(ir, has_loops))
    return _load(ir, lambda: ir, names, passes, lambda size: contextlib.nullcontext())


def is_stored(ir: str) -> bool:
    """Whether the code of a text is in the cache."""
    return _cached_object(_key(ir, _wanted(Passes.LEVEL_1))) is not None


def load_known(digest: str, text: Callable[[], str], names: tuple[str, ...], title: str) -> Code:
    """Machine code of a text with loops that is only made where the code is not in the cache.

    Args:
        digest: What decides the text, with nothing else, such as its own hash.
        text: Makes the text of the LLVM module.
        names: Names of definitions in it.
        title: What it is, as a long compilation is announced.

    Returns:
        The loaded code; it must live as long as it is called.
    """
    return _load(digest, text, names, _wanted(Passes.LEVEL_1), partial(_announced_text, title))


def _load(
    digest: str,
    text: Callable[[], str],
    names: tuple[str, ...],
    passes: Passes,
    announced: Callable[[int], Any],
) -> Code:
    start = time.perf_counter()
    key = _key(digest, passes)
    content = _cached_object(key)
    is_new = content is None
    if content is None:
        ir = text()
        with announced(
            len(ir)
        ):  # in this thread and without the lock: watchers may do anything, forks included
            content = interruptible(partial(_object, key, ir, passes))
    rare = {name: _rare_function(name, text, passes) for name in rare_functions_of(content)}
    seconds = time.perf_counter() - start if is_new else 0.0
    with _lock:
        code = _linked(content, names, seconds, rare)
    if "time" in os.environ.get("ULNA_DEBUG", ""):
        print(
            f"[ulna] {', '.join(names)}: {1e3 * seconds:.1f} ms {'in LLVM' if is_new else '(from the cache)'}"
        )
    return code


def _key(ir: str, passes: Passes) -> str:
    """The name of the entry in the cache that `ir` becomes on this machine."""
    t = target()
    recipe = f"{_RECIPE}, quick" if passes is Passes.QUICK else _RECIPE
    return disk_cache.key(ir, t.triple, t.cpu, t.features, t.llvm, recipe)


_rare_functions: dict[str, Code] = {}
"""What kernels share, for as long as the process runs."""


def _rare_function(name: str, text: Callable[[], str], passes: Passes) -> int:
    """The address of a function that kernels share.

    Args:
        name: Its name.
        text: Makes the text of a module that defines it, as it was before that was taken apart.
        passes: What is done with that module.

    Returns:
        The address.
    """
    code = _rare_functions.get(name)
    if code is None:
        key = _key(name, passes)  # which has the hash of the text
        content = _cached_object(key)
        if content is None:
            module = with_rare_functions_apart(text())[1][name]
            is_copying = f"@{copy_rows.NAME}." in module  # of batches whose arrays have gaps
            is_quick = not is_copying or passes is Passes.QUICK
            chosen = Passes.QUICK if is_quick else passes_for(module, has_loops=False)
            content = interruptible(partial(_object, key, module, chosen))
        with _lock:
            code = _rare_functions.setdefault(name, _linked(content, (name,), 0.0, {}))
    return code.address(name)


def _linked(content: bytes, names: tuple[str, ...], seconds: float, rare: dict[str, int]) -> Code:
    """An object file in memory, all sections side by side, with the addresses of some of its definitions.

    Args:
        content: The object file.
        names: The names of the definitions.
        seconds: How long LLVM worked.
        rare: The addresses of what it shares with others, by name.

    Returns:
        The loaded code.
    """
    library = llvm_library().JITLibraryBuilder().add_object_img(content).add_current_process()
    for name, address in rare.items():
        library.import_symbol(name, address)
    for name in names:
        library.export_symbol(name)
    number = next(_library_numbers)
    try:
        tracker = library.link(_engine(number // _GROUP), f"ulna.{number}")
    except RuntimeError as error:
        _refuse_without_memory(content)
        raise CompileError(
            f"LLVM cannot load a kernel, which is a bug in Ulna; please report it.\n{error}"
        ) from None
    return Code(tracker, {name: tracker[name] for name in names}, seconds)


def _refuse_without_memory(content: bytes) -> None:
    """Raises where there is no memory for an object file, of which LLVM's error says nothing."""
    sections = llvm_library().ObjectFileRef.from_data(content).sections()
    size = sum(section.size() for section in sections)
    try:
        mmap.mmap(-1, size).close()
    except OSError:
        raise MemoryError(f"A kernel needs {size:,} bytes for its code and its arrays.") from None


@lru_cache(maxsize=1)
def _engine(group: int) -> Any:
    """What the code of a group of object files is linked by; it is freed with the last of them.

    JITLink takes one block of memory for an object file. LLVM's other linker takes one for each section, and ends the
    process where the gaps of the address space leave them more than 2 GB apart, as large libraries do (PyTorch).
    """
    return llvm_library().create_lljit_compiler(_new_machine(), use_jit_link=sys.platform != "win32")


def _cached_object(key: str) -> bytes | None:
    """The object file in the cache, where there is one that is sound."""
    content = disk_cache.read(key)
    return content if content is not None and is_sound(content, target().triple) else None


def _object(key: str, ir: str, passes: Passes) -> bytes:
    """The object file of `ir`, which another thread, or a compilation that was interrupted, may have made by now."""
    with _lock:
        content = _cached_object(key)
        if content is None:
            machine = _machine(ir, passes)
            content = machine.emit_object(_optimised_here(ir, passes, machine))
            disk_cache.write(key, content)
        return content


def passes_for(ir: str, has_loops: bool) -> Passes:
    """What LLVM is to do with a text.

    Args:
        ir: The text of an LLVM module.
        has_loops: Whether it has loops that LLVM is to optimise, however long it is.

    Returns:
        The passes.
    """
    if has_loops:
        return Passes.LEVEL_1
    return Passes.COMBINING if len(ir) <= _COMBINED else Passes.INLINING


def _wanted(passes: Passes) -> Passes:
    """What LLVM is to do where the environment says that compiling is to be quick, else `passes`."""
    return Passes.QUICK if os.environ.get("ULNA_OPTIMISE") == "0" else passes


def _passes_of(f: Function, ir: str) -> Passes:
    """What LLVM is to do with the text of a function; of second forms the graph, and its loops, are not known yet."""
    has_loops = getattr(f, "untraced_operations", None) is None and f.has_loops
    if has_loops and _SHORT_LOOPS < len(ir) <= _LONG_LOOPS:
        return _wanted(Passes.COMBINING)
    return _wanted(passes_for(ir, has_loops and len(ir) <= _LONG_LOOPS))


def _announced(f: Function, what: str, size: int) -> Any:
    """Announces a compilation of so many characters of IR."""
    seconds = size / _SPEED[what]
    form = f.columns
    written = f if form is None or (what == "batch" and not form.serves_batches) else form
    text = (
        f"compiling {f.name} ({written.operations:,} operations), about {math.ceil(seconds)} s; {_storage()}"
    )
    return announced(text, f"Compiling {f.name}", seconds)


def _announced_text(title: str, size: int) -> Any:
    """Announces a compilation of so many characters of IR that belong to no function."""
    seconds = size / _LOOPS_SPEED
    text = f"compiling {title}, about {math.ceil(seconds)} s; {_storage()}"
    return announced(text, f"Compiling {title}", seconds)


def _storage() -> str:
    return "it is stored for next time" if disk_cache.folder() is not None else "the disk cache is off"


@contextlib.contextmanager
def announced(text: str, what: str, seconds: float) -> Iterator[None]:
    """Announces on the error stream, unless ULNA_QUIET is set, and to watchers, work that takes longer than a moment.

    Args:
        text: What is printed to the error stream.
        what: What watchers receive, before and after.
        seconds: How long it will take, about [s].

    Yields:
        Nothing; the work is done inside the `with` statement.
    """
    if seconds < _ANNOUNCE_FROM:
        yield
        return
    if os.environ.get("ULNA_QUIET", "0") in ("", "0") and sys.stderr is not None:
        print(f"ulna: {text}", file=sys.stderr, flush=True)
    observers = tuple(watchers)
    for watcher in observers:
        watcher(what, f"about {math.ceil(seconds)} s")
    try:
        yield
    finally:
        for watcher in observers:
            watcher(what, "")


def optimised(ir: str, passes: Passes, machine: Any) -> Any:
    """The module after its passes.

    Args:
        ir: The text of an LLVM module.
        passes: What is done with it.
        machine: The target machine of LLVM that it is for.

    Returns:
        The module.

    Raises:
        CompileError: If LLVM refuses it.
    """
    llvm = llvm_library()
    try:
        module = llvm.parse_assembly(ir)
        module.verify()
    except RuntimeError as error:
        raise CompileError(
            f"LLVM refused a kernel, which is a bug in Ulna; please report it.\n{error}"
        ) from None
    module.triple = machine.triple
    module.data_layout = str(machine.target_data)
    options = llvm.create_pipeline_tuning_options(speed_level=1)
    options.loop_vectorization = False  # lanes are explicit
    options.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    if passes is not Passes.LEVEL_1:
        _inlining(combines=passes is Passes.COMBINING).run(module, builder)
        return module
    manager = builder.getModulePassManager()  # cannot run twice
    try:
        manager.run(module, builder)
    finally:
        _free(manager)
    return module


def _optimised_here(ir: str, passes: Passes, machine: Any) -> Any:
    """The optimised module for this process, whose large arrays lie on the heap, without what kernels share."""
    return optimised(with_arrays_on_heap(with_rare_functions_apart(ir)[0]), passes, machine)


def _free(passes: Any) -> None:
    """Frees a manager of passes. In llvmlite 0.46 to 0.50 its `close` does nothing: a base class hides `_dispose`."""
    llvm = llvm_library()
    if type(passes)._dispose is llvm.ffi.ObjectRef._dispose:
        llvm.newpassmanagers.NewPassManager._dispose(passes)
        passes.detach()
    else:
        passes.close()


@cache
def _inlining(combines: bool) -> Any:
    """Inlining, also with combined instructions; made once."""
    passes = llvm_library().create_new_module_pass_manager()
    passes.add_always_inliner_pass()
    passes.add_global_dead_code_eliminate_pass()
    if combines:
        passes.add_simplify_cfg_pass()
        passes.add_instruction_combine_pass()
    return passes


def assembly(f: Function, ir: str) -> str:
    """The assembly text that `ir`, which evaluates `f`, becomes on this machine.

    Args:
        f: The function, for the optimisation.
        ir: The text of an LLVM module.

    Returns:
        The text of the assembly.
    """
    with _lock:
        passes = _passes_of(f, ir)
        machine = _machine(ir, passes)
        return machine.emit_assembly(_optimised_here(ir, passes, machine))


@dataclass(frozen=True)
class Examined:
    """Machine code that is looked at, and not run.

    Attributes:
        assembly: Its text.
        size: Its length [byte].
        seconds: How long LLVM took to compile it [s].
        cache: "stored", "not stored" or "off": whether it is in the disk cache.
    """

    assembly: str
    size: int
    seconds: float
    cache: str


def examined(f: Function, ir: str) -> Examined:
    """The machine code that `ir`, which evaluates `f`, becomes on this machine; it is compiled once more.

    Args:
        f: The function, for the optimisation.
        ir: The text of an LLVM module.

    Returns:
        The code.
    """
    start = time.perf_counter()
    text = interruptible(lambda: assembly(f, ir))
    seconds = time.perf_counter() - start
    content = _cached_object(_key(ir, _passes_of(f, ir)))
    state = "off" if disk_cache.folder() is None else "not stored" if content is None else "stored"
    with _lock:
        if content is None:
            passes = _passes_of(f, ir)
            machine = _machine(ir, passes)
            content = machine.emit_object(_optimised_here(ir, passes, machine))
        sections = llvm_library().ObjectFileRef.from_data(content).sections()
        return Examined(text, sum(s.size() for s in sections if s.is_text()), seconds, state)
