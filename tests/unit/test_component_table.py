"""Sparse-set tables against a dictionary, under any order of additions and removals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.world.graph.table import ComponentTable


@settings(max_examples=100)
@given(st.lists(st.tuples(st.booleans(), st.integers(0, 40), st.integers(0, 99)), max_size=120))
def test_a_table_holds_what_a_dictionary_would(edits):
    table, model = ComponentTable(value=(np.int64, ()), pair=(np.float64, (2,))), {}
    for add, index, value in edits:
        if add and index not in model:
            table.add(index, value=value, pair=(value, -value))
            model[index] = value
        elif not add:
            table.remove(index)
            model.pop(index, None)
    assert len(table) == len(model)
    assert sorted(table.entities.tolist()) == sorted(model)
    for index, value in model.items():
        assert table.column("value")[table.row(index)] == value
        assert table.column("pair")[table.row(index)].tolist() == [value, -value]


def test_adding_twice_asking_for_nothing_and_moving_onto_another_are_refused():
    table = ComponentTable(value=(np.int64, ()))
    table.add(3, value=1)
    table.add(4, value=2)
    with pytest.raises(ValueError, match="already"):
        table.add(3)
    with pytest.raises(ValueError, match="already"):
        table.move(3, 4)
    with pytest.raises(KeyError):
        table.row(5)
    with pytest.raises(KeyError, match='no column "valu"; did you mean "value"'):
        table.add(5, valu=1)
    table.move(3, 1000)
    assert table.column("value")[table.row(1000)] == 1
    assert 3 not in table
