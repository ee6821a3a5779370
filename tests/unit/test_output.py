"""What `--json` writes: finite numbers, plain types, schema and command first."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.terminal.output import applicable, finite, write_object


def test_numbers_that_json_has_not_become_null() -> None:
    assert finite([1.5, float("nan"), float("inf"), -float("inf")]) == [1.5, None, None, None]


def test_numpy_values_become_plain_ones() -> None:
    data = {"a": np.float64("nan"), "b": np.arange(3), "c": np.float32(0.5), "d": np.int64(7), "e": np.bool_(True)}
    assert finite(data) == {"a": None, "b": [0, 1, 2], "c": 0.5, "d": 7, "e": True}


def test_array_with_a_nan_inside() -> None:
    assert finite(np.array([[1.0, np.nan], [np.inf, 2.0]])) == [[1.0, None], [None, 2.0]]


def test_bool_stays_bool_and_path_becomes_text() -> None:
    assert finite({"yes": True, "where": Path("a/b")}) == {"yes": True, "where": "a/b"}


def test_unknown_type_is_refused_rather_than_guessed() -> None:
    with pytest.raises(TypeError, match="object"):
        finite({"x": object()})


def test_figures_that_do_not_apply_are_left_out_and_lists_keep_their_length() -> None:
    data = {"rows": [{"cost": 0.0, "error": float("nan"), "n": None}, {"cost": np.float64("inf")}], "grid": [None, 1]}
    assert applicable(data) == {"rows": [{"cost": 0.0}, {}], "grid": [None, 1]}


def test_schema_and_command_come_first(capsys: pytest.CaptureFixture[str]) -> None:
    write_object("check", {"files": 2}, version=3)
    text = capsys.readouterr().out
    assert text.startswith('{"schema": "mimics.check/3", "command": "check", ')
    assert json.loads(text)["files"] == 2


def test_names_of_files_that_are_no_text_are_written(capsys: pytest.CaptureFixture[str]) -> None:
    write_object("run", {"run_dir": Path("/tmp/\udcff"), "\udc80": ["\udcfe"]})
    answer = json.loads(capsys.readouterr().out)
    assert (answer["run_dir"], answer["\\udc80"]) == ("/tmp/\\udcff", ["\\udcfe"])
