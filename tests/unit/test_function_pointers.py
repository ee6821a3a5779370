"""Compiled functions that travel as numbers: which one is called, and what does not fit."""

from __future__ import annotations

import numpy as np
import pytest
from numba import types

from mimics_app.compiled.function_pointers import functions_at, pointers_to
from mimics_app.compiled.kernel import typed_kernel

ONE = types.FunctionType(types.float64(types.float64))
KINDS = types.Tuple((ONE, types.UniTuple(ONE, 2)))


@typed_kernel(types.float64(types.float64))
def _twice(x):
    return 2.0 * x


@typed_kernel(types.float64(types.float64))
def _negative(x):
    return -x


@typed_kernel(types.float64(types.float64))
def _more(x):
    return x + 1.0


@typed_kernel(types.void(types.int64[::1], types.float64, types.float64[::1]))
def _call(pointers, x, out):
    first, others = functions_at(pointers, KINDS)
    out[0], out[1], out[2] = first(x), others[0](x), others[1](x)


@pytest.mark.parametrize("chosen", [(_twice, (_negative, _more)), (_more, (_twice, _negative))])
def test_each_function_is_the_one_at_its_place(chosen):
    out = np.zeros(3)
    _call(pointers_to(chosen, KINDS), 3.0, out)
    first, others = chosen
    assert out.tolist() == [first(3.0), others[0](3.0), others[1](3.0)]


def test_too_few_functions_are_refused():
    with pytest.raises(ValueError, match="argument 2 is longer"):
        pointers_to((_twice, (_more,)), KINDS)


def test_outside_compiled_code_it_says_so():
    with pytest.raises(TypeError, match="compiled code"):
        functions_at(np.zeros(9, np.int64), KINDS)
