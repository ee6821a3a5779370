"""Arrays without their reference counts, for compiled code that owns nothing.

Taking an array out of a tuple, or handing it to another compiled function, counts a reference up and down with atomic
instructions: some 10 ns each time, more than a whole contact of a point and a shape in a kernel of a few dozen arrays.
The loop borrows what others keep alive for its whole run, so it need not count.
"""

from __future__ import annotations

from typing import Any, TypeVar

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

__all__ = ["borrowed"]

T = TypeVar("T")


def _without_counts(context, builder, kind, value):
    """The machine value of an array, or of a tuple of arrays and tuples, that counts no references."""
    if isinstance(kind, types.Array):
        array = cgutils.create_struct_proxy(kind)(context, builder, value=value)
        array.meminfo = ir.Constant(array.meminfo.type, None)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        members: Any = kind
        for i, inner in enumerate(members):
            part = _without_counts(context, builder, inner, builder.extract_value(value, i))
            value = builder.insert_value(value, part, i)
    return value


@intrinsic
def _borrowed(typingctx, value):
    def codegen(context, builder, signature, args):
        return _without_counts(context, builder, signature.args[0], args[0])

    return value(value), codegen


def borrowed(value: T) -> T:
    """The same array, or tuple of arrays and tuples, without reference counts.

    Args:
        value: What somebody else keeps alive for as long as the result is used.
    """
    return value


@overload(borrowed)
def _overload_borrowed(value):
    return lambda value: _borrowed(value)
