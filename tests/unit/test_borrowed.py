"""Borrowed tuples and arrays in compiled code: the same numbers, nothing counted, nothing leaked."""

from __future__ import annotations

import re
import sys
from typing import NamedTuple

import numpy as np
import pytest
from numba import njit, typeof, types
from numba.core.errors import TypingError

from mimics_app.compiled.borrowed import borrowed, borrowed_type


class _Inner(NamedTuple):
    cells: np.ndarray


class _Outer(NamedTuple):
    numbers: np.ndarray
    grid: np.ndarray
    inner: _Inner


def _tables() -> _Outer:
    return _Outer(np.arange(5.0), np.arange(12.0).reshape(3, 4), _Inner(np.array([7, 8])))


@njit
def _use(tables, k):
    row = tables.grid[k]
    row[0] += 1.0
    tables.inner.cells[0] += k
    return tables.numbers[k] + row[1:].sum() + tables.inner.cells[1] + tables.grid.shape[1]


@njit
def _use_borrowed(tables, k):
    return _use(borrowed(tables), k)


_SIGNATURE = types.float64(borrowed_type(typeof(_tables())), types.int64)
_typed = njit(_SIGNATURE)(lambda tables, k: _use(tables, k))


@njit
def _hand_over(function, tables, k):
    return function(tables, k)


@njit
def _swap(tables, k):
    """What numba counts in: names that change hands in a loop."""
    a, b = tables.numbers, tables.grid[0]
    for _ in range(k):
        a, b = b, a
    return a[1]


@njit
def _swap_borrowed(tables, k):
    return _swap(borrowed(tables), k)


@njit
def _plain_or_borrowed(tables, k):
    numbers = tables.numbers
    if k > 0:
        numbers = borrowed(tables).numbers
    return numbers[k]


def _nothing(tables: _Outer, k: int) -> float:
    return tables.numbers[k] + tables.grid[k, 1:].sum() + tables.inner.cells[1] + 4.0


@pytest.mark.parametrize("call", [_use_borrowed, _typed, lambda *args: _hand_over(_typed, *args)])
def test_borrowed_tuple_is_the_same_memory(call):
    """As argument of a plain call, of a typed function, and of a first-class one; writes are seen by the owner."""
    tables = _tables()
    assert call(tables, 2) == _nothing(tables, 2)
    assert tables.grid[2, 0] == 9.0
    assert tables.inner.cells[0] == 9


@pytest.mark.parametrize("call", [_use_borrowed, _typed, lambda *args: _hand_over(_typed, *args)])
def test_no_reference_is_kept_or_lost(call):
    tables = _tables()
    call(tables, 1)
    before = [sys.getrefcount(array) for array in (tables.numbers, tables.grid, tables.inner.cells)]
    for _ in range(50):
        call(tables, 1)
    assert [sys.getrefcount(array) for array in (tables.numbers, tables.grid, tables.inner.cells)] == before


def test_borrowed_array_meets_a_plain_one_in_one_name():
    tables = _tables()
    assert [_plain_or_borrowed(tables, k) for k in range(3)] == [0.0, 1.0, 2.0]
    assert sys.getrefcount(tables.numbers) == sys.getrefcount(_tables().numbers)


def test_nothing_is_counted_in_the_code_of_a_borrowed_tuple():
    """The rival is the same function of the plain tuple, which counts."""
    assert _swap_borrowed(_tables(), 3) == _swap(_tables(), 3) == 1.0
    texts = {str(signature[0]): text for signature, text in _swap.inspect_llvm().items()}
    counted = {name.startswith("borrowed"): _calls(text) for name, text in texts.items()}
    assert counted[True] == 0
    assert counted[False] > 0


def _calls(text: str) -> int:
    """Counting calls in the native function itself, not in the wrappers that take Python's or C's values."""
    native = [part for part in re.split(r"\ndefine ", text) if "@_ZN5tests" in part.partition("{")[0]]
    assert native
    return sum(part.count("call void @NRT_") for part in native)


def test_unknown_field_is_refused_at_compile_time():
    with pytest.raises(TypingError, match="missing"):
        njit(lambda tables: borrowed(tables).missing)(_tables())


def test_a_tuple_of_other_arrays_is_not_taken():
    wrong = _Outer(np.arange(5), np.zeros((3, 4)), _Inner(np.array([7, 8])))
    with pytest.raises(TypeError, match="No matching definition"):
        _typed(wrong, 1)
