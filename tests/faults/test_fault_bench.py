"""`mimics bench faults`: each fault ends the force in its time, with a message, in a complete session."""

from __future__ import annotations

import re

import pytest

from mimics_app.app.bench import fault_bench, process_faults
from mimics_app.app.bench.fault_bench import measure_faults
from mimics_app.app.bench.process_faults import OF_TESTS, PROCESS_FAULTS
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import TripCause
from mimics_app.contracts.system.resources import root

SCENE = root() / "scenes" / "wavy_tunnel.json"
OF_DEVICES = ("F01", "F02", "F03", "F04", "F17")


@pytest.mark.fault(id="F03")
def test_every_fault_during_contact_is_handled_as_stated():
    rows = measure_faults(SCENE, 1, lambda _: None, OF_DEVICES)["rows"]
    assert {row["number"] for row in rows} == set(OF_DEVICES)
    failed = [row for row in rows if not row["passed"]]
    assert not failed
    stops = [row for row in rows if row["cause"] != TripCause.NONE.name]
    assert all(row["t_safe_ms"]["max"] <= row["bound_ms"] and row["told"] for row in stops)
    assert all((row["back"], row["jumps"]) == (1, 0) for row in stops), "a reset brings the robot back, smoothly"
    spike = next(row for row in rows if row["fault"].startswith("spike"))
    assert spike["force_max_n"] > 0.0 and "t_safe_ms" not in spike


@pytest.mark.slow
@pytest.mark.parametrize("number", OF_DEVICES)
def test_a_hundred_of_each_fault_of_a_device_are_handled_as_stated(number):
    rows = measure_faults(SCENE, 100, lambda _: None, [number])["rows"]
    assert rows and all(row["passed"] and row["repeat"] == 100 for row in rows), rows
    assert all((row["back"], row["jumps"]) == (100, 0) for row in rows if "back" in row), rows


@pytest.mark.parametrize("number", ["F05", "F10"])
@pytest.mark.parametrize("repeats", [1, pytest.param(100, marks=pytest.mark.slow)])
def test_every_fault_of_a_process_leaves_what_is_promised(number, repeats):
    (row,) = measure_faults(SCENE, repeats, lambda _: None, [number])["rows"]
    assert (row["number"], row["repeat"]) == (number, repeats) and row["passed"], row


@pytest.mark.slow
def test_a_hundred_kills_of_the_application_lose_a_tenth_of_a_second_at_most():
    (row,) = measure_faults(SCENE, 50, lambda _: None, ["F11"])["rows"]  # 50 with and 50 without the recorder
    assert row["repeat"] == 100 and row["passed"], row


def test_every_fault_of_the_page_can_be_repeated(monkeypatch, tmp_path):
    """Those of neither sessions nor processes by their tests: here by a number of them whose test is a moment's."""
    page = (root() / "docs" / "faults.md").read_text("utf-8")
    listed = re.findall(r"^\| (F\d\d) \|", page, re.MULTILINE)
    assert sorted({*OF_DEVICES, *PROCESS_FAULTS, *OF_TESTS}) == listed
    (row,) = measure_faults(SCENE, 2, lambda _: None, ["F16"])["rows"]
    assert (row["number"], row["repeat"], row["failed"], row["passed"]) == ("F16", 2, 0, True)
    monkeypatch.setattr(process_faults, "root", lambda: tmp_path)
    with pytest.raises(UsageError, match="in a checkout"):
        measure_faults(SCENE, 1, lambda _: None, ["F16"])
    monkeypatch.setattr(process_faults, "find_spec", lambda _: None)
    with pytest.raises(UsageError, match="pytest is not installed"):
        measure_faults(SCENE, 1, lambda _: None, ["F16"])


def test_a_fault_that_is_not_known_is_said():
    with pytest.raises(UsageError, match='no fault "F99"'):
        measure_faults(SCENE, 1, lambda _: None, ["F99"])


def test_a_scene_in_which_nothing_is_touched_is_refused(monkeypatch):
    monkeypatch.setattr(fault_bench, "_SEARCHED_S", 0.5)
    with pytest.raises(UsageError, match="touches nothing"):
        measure_faults(root() / "scenes" / "guided_walk.json", 1, lambda _: None, ["F03"])
