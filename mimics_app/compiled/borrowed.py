"""Arrays without reference counts, for compiled code that owns nothing.

Reading an array from a tuple, or passing it to another compiled function, increments and decrements a reference count
with atomic instructions or at least two calls, and passes every array as seven words or more: together this costs more
than a whole contact of a point and a shape in a kernel of a few dozen arrays. The loop borrows arrays that others keep
alive for its whole run: a borrowed array is a type for which numba emits no reference counting, and a borrowed tuple
is passed as one pointer, from which only the arrays in use are read.
"""

from __future__ import annotations

import hashlib
from typing import Any, TypeVar

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.datamodel import models
from numba.core.imputils import lower_cast, lower_getattr_generic
from numba.core.typeconv.castgraph import Conversion
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, lower_builtin, register_model, type_callable, unbox

__all__ = ["borrowed", "borrowed_type"]

T = TypeVar("T")


class _BorrowedArray(types.Array):
    """Type of an array without reference counting; its views have none either."""

    def __init__(self, dtype, ndim, layout, readonly=False, aligned=True):
        plain = types.Array(dtype, ndim, layout, readonly=readonly, aligned=aligned)
        super().__init__(dtype, ndim, layout, readonly=readonly, name=f"borrowed {plain}", aligned=aligned)

    def copy(self, dtype=None, ndim=None, layout=None, readonly=None):
        """Return the type of a view of such an array, as numba requests it."""
        return borrowed_type(super().copy(dtype=dtype, ndim=ndim, layout=layout, readonly=readonly))


class _BorrowedTuple(types.Type):
    """Pointer to a named tuple of arrays and named tuples in the stack frame of the borrowing function."""

    def __init__(self, of):
        self.of = of
        digest = hashlib.sha256(of.name.encode()).hexdigest()[:12]  # the full name is too long for a symbol
        super().__init__(name=f"borrowed {of.instance_class.__name__} {digest}")

    def can_convert_from(self, typingctx, other):
        """Accept the plain tuple as an argument: it is borrowed for the call."""
        return Conversion.safe if isinstance(other, types.BaseNamedTuple) and _counted(other) == self.of else None


def _counted(kind: Any) -> Any:
    """Return the reference-counted type with the same machine value."""
    if isinstance(kind, types.BaseNamedTuple):
        members: Any = kind
        return types.NamedTuple([_counted(inner) for inner in members], members.instance_class)
    if isinstance(kind, _BorrowedArray):
        return types.Array(kind.dtype, kind.ndim, kind.layout, not kind.mutable, aligned=kind.aligned)
    return kind


def borrowed_type(kind: Any) -> Any:
    """Return the type of `borrowed(value)` for a value of this numba type; the same type if nothing is counted."""
    if isinstance(kind, types.BaseNamedTuple):
        return _BorrowedTuple(_counted(kind))
    if isinstance(kind, types.Array) and not isinstance(kind, (_BorrowedArray, types.NestedArray)):
        return _BorrowedArray(kind.dtype, kind.ndim, kind.layout, not kind.mutable, kind.aligned)
    return kind


@register_model(_BorrowedArray)
class _BorrowedArrayModel(models.StructModel):
    """Data model of an array without a member that numba would count."""

    def __init__(self, dmm, fe_type):
        extents = types.UniTuple(types.intp, fe_type.ndim)
        members = [
            ("meminfo", types.voidptr),
            ("parent", types.voidptr),
            ("nitems", types.intp),
            ("itemsize", types.intp),
            ("data", types.CPointer(fe_type.dtype)),
            ("shape", extents),
            ("strides", extents),
        ]
        super().__init__(dmm, fe_type, members)


register_model(_BorrowedTuple)(models.OpaqueModel)


def _without_counts(context, builder, kind, value):
    """Return the machine value of an array, or of a tuple of arrays and tuples, without reference counts."""
    if isinstance(kind, types.Array):
        place = context.data_model_manager[kind].get_field_position("meminfo")
        return builder.insert_value(value, ir.Constant(value.type.elements[place], None), place)
    if isinstance(kind, types.BaseTuple):
        members: Any = kind
        for i, inner in enumerate(members):
            part = _without_counts(context, builder, inner, builder.extract_value(value, i))
            value = builder.insert_value(value, part, i)
    return value


def borrowed(value: T) -> T:
    """Return the same array, or named tuple of arrays and named tuples, without reference counts.

    Do not return a borrowed value: a tuple is in the stack frame of the function that borrowed it.

    Args:
        value: A value that outlives every use of the result.
    """
    return value


@type_callable(borrowed)
def _type_borrowed(context):
    return borrowed_type


def _into_frame(builder, value):
    """Return a pointer to a copy of a machine value in the stack frame of the function being compiled."""
    return builder.bitcast(cgutils.alloca_once_value(builder, value), cgutils.voidptr_t)


@lower_builtin(borrowed, types.Any)
def _borrow(context, builder, signature, args):
    (kind,) = signature.args
    value = _without_counts(context, builder, kind, args[0])
    return _into_frame(builder, value) if isinstance(kind, types.BaseNamedTuple) else value


@lower_cast(types.BaseNamedTuple, _BorrowedTuple)
def _borrow_for_call(context, builder, kind, wanted, value):
    return _into_frame(builder, _without_counts(context, builder, kind, value))


@lower_cast(_BorrowedArray, types.Array)
def _to_plain(context, builder, kind, wanted, value):
    return value


@unbox(_BorrowedTuple)
def _unbox(kind, obj, c):
    """Convert a Python tuple, borrowed for the call."""
    native = c.unbox(kind.of, obj)

    def release():
        if native.cleanup is not None:
            native.cleanup()
        c.context.nrt.decref(c.builder, kind.of, native.value)

    value = _without_counts(c.context, c.builder, kind.of, native.value)
    return NativeValue(_into_frame(c.builder, value), is_error=native.is_error, cleanup=release)


@infer_getattr
class _BorrowedTupleFields(AttributeTemplate):
    """Types of the fields of a borrowed tuple: borrowed themselves."""

    key = _BorrowedTuple

    def generic_resolve(self, value, attr):  # type: ignore[override]
        """Return the type of a field, None for an unknown name."""
        fields = value.of.fields
        return borrowed_type(value.of.types[fields.index(attr)]) if attr in fields else None


@lower_getattr_generic(_BorrowedTuple)
def _field_of_borrowed(context, builder, kind, value, name):
    index = kind.of.fields.index(name)
    where = builder.bitcast(value, context.get_value_type(kind.of).as_pointer())
    field = cgutils.gep_inbounds(builder, where, 0, index)
    if isinstance(kind.of.types[index], types.BaseNamedTuple):
        return builder.bitcast(field, cgutils.voidptr_t)
    return builder.load(field)
