"""Methods of quantities whose kernels are there are called by machine code; see `ulna.compiler.runtime.method_call`."""

from __future__ import annotations

import types

from ulna.quantities.documentation import OF_CALLS
from ulna.quantities.quantity import GENERATED
from ulna.system.later import run_later

THREAD = "ulna method calls"
"""The name of the thread that compiles what all methods share, where it is not in the cache yet."""


def call_directly(kind: type, name: str, kernels_type: type) -> None:
    """Has the method of a quantity, in the class that declares it, called by machine code from now on.

    Where that code is not in the cache yet, another thread compiles it, so that no first call waits for it.

    Args:
        kind: The class of the object whose kernel was made, a `Part`.
        name: The quantity.
        kernels_type: The type of its table of kernels of default options.
    """
    from ulna.compiler.runtime import method_call  # with LLVM, which importing quantities does not need

    if method_call.is_ready():
        _replace(kind, name, kernels_type)
    else:
        run_later(THREAD, _replace, kind, name, kernels_type)


def _replace(kind: type, name: str, kernels_type: type) -> None:
    from ulna.compiler.runtime.method_call import Parameters, Tables, method_call

    tables = Tables("_kernels", kernels_type, "_by_options")
    for owner in kind.__mro__:
        for attribute, function in list(vars(owner).items()):
            if not isinstance(function, types.FunctionType) or function not in GENERATED:
                continue
            if function.quantity.name != name:  # type: ignore[attr-defined]
                continue
            names = function.__code__.co_varnames[1 : function.__code__.co_argcount]
            defaults, has_tables = function.__defaults__ or (), function.has_tables  # type: ignore[attr-defined]
            takes_out = has_tables and OF_CALLS.issubset(names)
            parameters = Parameters(names, len(names) - len(defaults), defaults, takes_out, has_tables)
            made = method_call(function, owner, kind, tables, name, parameters)
            is_unchanged = vars(owner).get(attribute) is function  # compiling takes a moment
            if made is not None and is_unchanged:
                setattr(owner, attribute, made)
