"""Addresses of compiled functions in an array, for compiled code that Python calls often.

A function passed to compiled code is looked up by its signature at every call, in Python; for the loop's seventeen
functions this costs more than the ticks of a frame. With this module their addresses are looked up once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import lower_builtin, type_callable
from numpy.typing import NDArray

__all__ = ["FUNCTION_WORDS", "functions_at", "pointers_to"]

_MEMBERS = ("c_addr", "py_addr", "jit_addr")
"""Words of a compiled function's machine value."""

FUNCTION_WORDS = len(_MEMBERS)
"""How many each has."""


def pointers_to(functions: Sequence[Any], kind: Any) -> NDArray[np.int64]:
    """Return the machine values of compiled functions, which must outlive the array.

    Args:
        functions: Functions, and tuples of functions.
        kind: Tuple type of the same structure, of `types.FunctionType`.

    Returns:
        Addresses for `functions_at`, shape [3 * functions].
    """
    words: list[int] = []
    for function, its in zip(functions, kind, strict=True):
        if isinstance(its, types.BaseTuple):
            words += pointers_to(function, its).tolist()
        else:
            made = function.get_compile_result(its.signature)
            address = made.library.get_pointer_to_function
            words += (address(made.fndesc.llvm_cfunc_wrapper_name), id(function), address(made.fndesc.llvm_func_name))
    return np.array(words, np.int64)


def functions_at(pointers: NDArray[np.int64], kind: Any) -> Any:
    """Return the functions as a tuple of type `kind`, or the one function of that type; for compiled code only."""
    raise TypeError("functions_at is for compiled code")


@type_callable(functions_at)
def _type_functions_at(context):
    def typer(pointers, kind):
        return kind.instance_type if isinstance(kind, types.TypeRef) else None

    return typer


@lower_builtin(functions_at, types.Array, types.TypeRef)
def _functions_at(context, builder, signature, args):
    array = cgutils.create_struct_proxy(signature.args[0])(context, builder, value=args[0])
    return _load(context, builder, signature.return_type, array.data, 0)[0]


def _load(context, builder, kind, words, at):
    """Return the machine value of a function, or a tuple of them, from the words at index `at`, and the next index."""
    if isinstance(kind, types.BaseTuple):
        kinds: Any = kind
        members = []
        for inner in kinds:
            member, at = _load(context, builder, inner, words, at)
            members.append(member)
        return context.make_tuple(builder, kind, members), at
    model, function = context.data_model_manager[kind], ir.Constant(context.get_value_type(kind), ir.Undefined)
    for name in _MEMBERS:
        word = builder.load(builder.gep(words, [context.get_constant(types.intp, at)]))
        address = builder.inttoptr(word, cgutils.voidptr_t)
        function = builder.insert_value(function, address, model.get_field_position(name))
        at += 1
    return function, at
