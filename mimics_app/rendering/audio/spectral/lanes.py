"""SIMD rows of 16 floats, for sound kernels whose loops the compiler does not vectorise.

A numba intrinsic emits LLVM IR when its caller is compiled; these types let it do so in the notation of the formula.
16 floats are one register of AVX-512, two of AVX and four of NEON or SSE, with the same results on all.
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
"""Type of the address of an array's data, see `fourier.address_of`."""

WIDTH = 16
"""Numbers per row."""

BYTES = 4
"""Bytes per number."""

BYTE_POINTER = ir.IntType(8).as_pointer()
"""LLVM type of an untyped pointer."""

_ROW = ir.VectorType(ir.FloatType(), WIDTH)
_ROW_POINTER = _ROW.as_pointer()
_OFFSET = ir.IntType(64)
_FUSED = ir.FunctionType(_ROW, (_ROW, _ROW, _ROW))
Value: TypeAlias = ir.Value
"""A value of the emitted IR."""

_LINE = 64  # bytes per cache line


class Lanes:
    """A row of 16 numbers in the emitted IR."""

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
        """Fused multiply-add: this row times a factor plus a row, rounded once."""
        module, name = self.builder.module, f"llvm.fma.v{WIDTH}f32"
        fused = module.globals.get(name) or ir.Function(module, _FUSED, name)
        return Lanes(self.builder, self.builder.call(fused, (self.value, factor.value, addend.value)))

    def taking(self, other: Lanes, order: Sequence[int]) -> Lanes:
        """Shuffle: select numbers of this row (0 to 15) and of another one (16 to 31)."""
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
        """Multiply-add: this row times a factor plus a row."""
        re = self.re.times_plus(factor.re, (-self.im).times_plus(factor.im, addend.re))
        return Complex(re, self.re.times_plus(factor.im, self.im.times_plus(factor.re, addend.im)))

    def scaled(self, factor: Lanes) -> Complex:
        """Multiply by real numbers."""
        return Complex(self.re * factor, self.im * factor)

    def turned_back(self) -> Complex:
        """Multiply by -i."""
        return Complex(self.im, -self.re)


class Writer:
    """Emits loads and stores of rows; `place` counts numbers from the address of an array.

    Args:
        builder: IR builder of the intrinsic.
    """

    def __init__(self, builder: ir.IRBuilder) -> None:
        self._builder = builder

    def row(self, address: Value, place: int = 0) -> Lanes:
        """Load 16 numbers from a place on."""
        return Lanes(self._builder, self._builder.load(self._pointer(address, place), align=BYTES))

    def rows(self, address: Value, re: int, im: int) -> Complex:
        """Load real and imaginary parts from two places."""
        return Complex(self.row(address, re), self.row(address, im))

    def keep(self, row: Lanes, address: Value, place: int = 0) -> None:
        """Store a row."""
        self._builder.store(row.value, self._pointer(address, place), align=BYTES)

    def same(self, address: Value, place: int = 0) -> Lanes:
        """Broadcast the number at a place."""
        pointer = self._builder.bitcast(self._pointer(address, place), ir.FloatType().as_pointer())
        return self.filled(self._builder.load(pointer, align=BYTES))

    def filled(self, number: Value | float) -> Lanes:
        """Broadcast a number."""
        number = ir.Constant(ir.FloatType(), number) if isinstance(number, float) else number
        first = self._builder.insert_element(ir.Constant(_ROW, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
        same = Lanes(self._builder, first)
        return same.taking(same, [0] * WIDTH)

    def _pointer(self, address: Value, place: int) -> Value:
        at = self._builder.add(address, ir.Constant(_OFFSET, BYTES * place)) if place else address
        return self._builder.inttoptr(at, _ROW_POINTER)


def transposed(rows: Sequence[Lanes]) -> list[Lanes]:
    """Transpose a matrix of 16 rows by exchanging halves, quarters, eighths and neighbours."""
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
    """Return zeros aligned to a cache line, so that no row crosses two lines."""
    count = int(np.prod(shape))
    raw = np.zeros(count + _LINE // BYTES, np.float32)
    first = -raw.ctypes.data % _LINE // BYTES
    return raw[first : first + count].reshape(shape)


def aligned(numbers: ArrayLike) -> NDArray[np.float32]:
    """Return numbers as a flat array aligned to a cache line."""
    values = np.asarray(numbers, np.float32).reshape(-1)
    kept = aligned_zeros(len(values))
    kept[:] = values
    return kept
