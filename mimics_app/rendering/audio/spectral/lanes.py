"""Sixteen numbers side by side: what kernels of sound are written in where the compiler's own loops do not become wide.

An intrinsic of numba writes machine instructions when its caller is compiled; with these types it does so in the terms
of the formula. 16 floats are one register of AVX-512, two of AVX and four of NEON or SSE: the same results on all.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from llvmlite import ir
from numba import types
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "ADDRESS",
    "BYTES",
    "BYTE_POINTER",
    "WIDTH",
    "Complex",
    "Lanes",
    "Value",
    "Writer",
    "aligned",
    "aligned_zeros",
    "transposed",
]

ADDRESS = types.uintp
"""Of an array's first number, see `fourier.address_of`."""

WIDTH = 16
"""Numbers of a row."""

BYTES = 4
"""Of a number."""

BYTE_POINTER = ir.IntType(8).as_pointer()
"""To memory of any kind."""

_ROW = ir.VectorType(ir.FloatType(), WIDTH)
_ROW_POINTER = _ROW.as_pointer()
_OFFSET = ir.IntType(64)
_FUSED = ir.FunctionType(_ROW, (_ROW, _ROW, _ROW))
Value: TypeAlias = ir.Value
"""A value of the machine code that is being written."""

_LINE = 64  # bytes of a cache's line


class Lanes:
    """A row while a kernel is made."""

    def __init__(self, builder: ir.IRBuilder, value: Value) -> None:
        self.builder = builder
        self.value = value

    def __add__(self, other: Lanes) -> Lanes:
        return Lanes(self.builder, self.builder.fadd(self.value, other.value))

    def __sub__(self, other: Lanes) -> Lanes:
        return Lanes(self.builder, self.builder.fsub(self.value, other.value))

    def __mul__(self, other: Lanes) -> Lanes:
        return Lanes(self.builder, self.builder.fmul(self.value, other.value))

    def __neg__(self) -> Lanes:
        return Lanes(self.builder, self.builder.fneg(self.value))

    def times_plus(self, factor: Lanes, addend: Lanes) -> Lanes:
        """This row times a factor plus a row, rounded once on every processor."""
        module, name = self.builder.module, f"llvm.fma.v{WIDTH}f32"
        fused = module.globals.get(name) or ir.Function(module, _FUSED, name)
        return Lanes(self.builder, self.builder.call(fused, (self.value, factor.value, addend.value)))

    def taking(self, other: Lanes, order: Sequence[int]) -> Lanes:
        """Numbers of this row (0 to 15) and of another one (16 to 31) in an order."""
        mask = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), list(order))
        return Lanes(self.builder, self.builder.shuffle_vector(self.value, other.value, mask))


class Complex:
    """A row of complex numbers."""

    def __init__(self, re: Lanes, im: Lanes) -> None:
        self.re, self.im = re, im

    def __add__(self, other: Complex) -> Complex:
        return Complex(self.re + other.re, self.im + other.im)

    def __sub__(self, other: Complex) -> Complex:
        return Complex(self.re - other.re, self.im - other.im)

    def __mul__(self, other: Complex) -> Complex:
        re = self.re.times_plus(other.re, -(self.im * other.im))
        return Complex(re, self.re.times_plus(other.im, self.im * other.re))

    def times_plus(self, factor: Complex, addend: Complex) -> Complex:
        """This row times a factor plus a row."""
        re = self.re.times_plus(factor.re, (-self.im).times_plus(factor.im, addend.re))
        return Complex(re, self.re.times_plus(factor.im, self.im.times_plus(factor.re, addend.im)))

    def scaled(self, factor: Lanes) -> Complex:
        """Times real numbers."""
        return Complex(self.re * factor, self.im * factor)

    def turned_back(self) -> Complex:
        """Times -i."""
        return Complex(self.im, -self.re)


class Writer:
    """Rows from memory and back. An address is that of an array, a place counts numbers from there.

    Args:
        builder: Of the intrinsic.
    """

    def __init__(self, builder: ir.IRBuilder) -> None:
        self._builder = builder

    def row(self, address: Value, place: int = 0) -> Lanes:
        """16 numbers from a place on."""
        return Lanes(self._builder, self._builder.load(self._pointer(address, place), align=BYTES))

    def rows(self, address: Value, re: int, im: int) -> Complex:
        """Real and imaginary parts from two places."""
        return Complex(self.row(address, re), self.row(address, im))

    def keep(self, row: Lanes, address: Value, place: int = 0) -> None:
        """Write a row."""
        self._builder.store(row.value, self._pointer(address, place), align=BYTES)

    def same(self, address: Value, place: int = 0) -> Lanes:
        """The number at a place 16 times."""
        pointer = self._builder.bitcast(self._pointer(address, place), ir.FloatType().as_pointer())
        return self.filled(self._builder.load(pointer, align=BYTES))

    def filled(self, number: Value | float) -> Lanes:
        """One number 16 times."""
        number = ir.Constant(ir.FloatType(), number) if isinstance(number, float) else number
        first = self._builder.insert_element(ir.Constant(_ROW, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
        same = Lanes(self._builder, first)
        return same.taking(same, [0] * WIDTH)

    def _pointer(self, address: Value, place: int) -> Value:
        at = self._builder.add(address, ir.Constant(_OFFSET, BYTES * place)) if place else address
        return self._builder.inttoptr(at, _ROW_POINTER)


def transposed(rows: Sequence[Lanes]) -> list[Lanes]:
    """A square of 16 rows, its columns as rows: halves, quarters, eighths and neighbours change places."""
    square = list(rows)
    for step in (8, 4, 2, 1):
        low = [lane if not lane & step else WIDTH + lane - step for lane in range(WIDTH)]
        high = [lane + step if not lane & step else WIDTH + lane for lane in range(WIDTH)]
        for i in range(WIDTH):
            if not i & step:
                one, other = square[i], square[i + step]
                square[i], square[i + step] = one.taking(other, low), one.taking(other, high)
    return square


def aligned_zeros(*shape: int) -> NDArray[np.float32]:
    """Zeros that begin where a line of the processor's cache does, so that no row lies across two."""
    count = int(np.prod(shape))
    raw = np.zeros(count + _LINE // BYTES, np.float32)
    first = -raw.ctypes.data % _LINE // BYTES
    return raw[first : first + count].reshape(shape)


def aligned(numbers: ArrayLike) -> NDArray[np.float32]:
    """Numbers as such an array, one row."""
    values = np.asarray(numbers, np.float32).reshape(-1)
    kept = aligned_zeros(len(values))
    kept[:] = values
    return kept
