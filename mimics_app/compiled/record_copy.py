"""Compiled copies of records: of many fields, generated from a list, and of the first bytes; loading ahead of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

__all__ = ["Move", "copy_front", "field_copier", "prefetch_line"]

Move = tuple[int, tuple[str, ...], str]
"""Copy of a field: which of the two source records (0 or 1), path in it, and name of the target field."""


def field_copier(moves: Sequence[Move]) -> Callable[[Any, Any, Any], None]:
    """Return a function for kernels, `copy(state, totals, out)`: `out.NAME = field at PATH`, converted, for each move.

    The machine code is that of one assignment per field, without a list at run time and without type inference.
    """

    @intrinsic
    def copy(typingctx, state, totals, out):  # type: ignore[no-untyped-def]
        places = [(which, _find((state, totals)[which], path), _find(out, (name,))) for which, path, name in moves]

        def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
            for which, source, target in places:
                for k in range(_size(target[1])):
                    value = _load(context, builder, signature.args[which], args[which], source, k)
                    _store(context, builder, out, args[2], target, k, value)
            return context.get_dummy_value()

        return types.void(state, totals, out), codegen

    compiled: Any = copy
    copier: Callable[[Any, Any, Any], None] = compiled
    return copier


@intrinsic
def _copy_front(typingctx, target, source, size):  # type: ignore[no-untyped-def]
    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        cgutils.raw_memcpy(builder, args[0], args[1], args[2], 1)  # type: ignore[no-untyped-call]
        return context.get_dummy_value()

    return types.void(target, source, types.intp), codegen


copy_front = cast("Callable[[Any, Any, int], None]", _copy_front)
"""Copy the first bytes of a record, for kernels: `copy_front(target, source, size)`, both records of one type."""


@intrinsic
def _prefetch_line(typingctx, record, offset):  # type: ignore[no-untyped-def]
    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        word, pointer = ir.IntType(32), ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [pointer, word, word, word])
        prefetch = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0i8")  # type: ignore[no-untyped-call]
        line = builder.gep(builder.bitcast(args[0], pointer), [args[1]])
        builder.call(prefetch, [line, word(1), word(3), word(1)])  # to write, into all levels, of the data cache
        return context.get_dummy_value()

    return types.void(record, types.intp), codegen


prefetch_line = cast("Callable[[Any, int], None]", _prefetch_line)
"""Begin to load the cache line at an offset [bytes] of a record that is written soon, for kernels; returns at once."""


def _find(record: Any, path: Sequence[str]) -> tuple[int, Any]:
    """Return offset [bytes] and type of a field, through nested records."""
    offset, kind = 0, record
    for name in path:
        if not isinstance(kind, types.Record) or name not in kind.fields:
            raise TypeError(f"{record} has no field {'.'.join(path)}: see the sources of the copied fields")
        offset, kind = offset + kind.offset(name), kind.typeof(name)
    return offset, kind


def _size(kind: Any) -> int:
    return int(kind.nitems) if isinstance(kind, types.NestedArray) else 1


def _pointer(context: Any, builder: Any, record: Any, place: tuple[int, Any], k: int) -> tuple[Any, Any]:
    """Return type and address of component k of a field."""
    offset, kind = place
    number = kind.dtype if isinstance(kind, types.NestedArray) else kind
    at = offset + k * number.bitwidth // 8
    return number, cgutils.get_record_member(builder, record, at, context.get_data_type(number))  # type: ignore[no-untyped-call]


def _load(context: Any, builder: Any, kind: Any, record: Any, place: tuple[int, Any], k: int) -> tuple[Any, Any]:
    number, pointer = _pointer(context, builder, record, place, k)
    return number, context.unpack_value(builder, number, pointer, None if kind.aligned else 1)


def _store(
    context: Any, builder: Any, kind: Any, record: Any, place: tuple[int, Any], k: int, value: tuple[Any, Any]
) -> None:
    number, pointer = _pointer(context, builder, record, place, k)
    converted = context.cast(builder, value[1], value[0], number)
    context.pack_value(builder, number, converted, pointer, align=None if kind.aligned else 1)
