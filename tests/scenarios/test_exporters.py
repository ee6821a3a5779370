"""Exporters of recordings: the built-in one, and one of another package, which changes no file of the product."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import OutputError, UsageError
from mimics_app.contracts.system.resources import root
from mimics_app.recording.exporter_kinds import export_run, exporter_names, find_exporter
from mimics_app.recording.run import Run
from tests.support.command import mimics, mimics_with
from tests.support.exporter_kit import check_exporter
from tests.support.plugin_site import write_package

RUN = root() / "tests" / "data" / "run_0_1_0"


LIBRARIES = {"edf": "edfio", "mcap": "mcap", "nwb": "pynwb"}
"""What an exporter needs besides the packages of the product."""


@pytest.mark.parametrize("name", exporter_names())
def test_every_exporter_passes_the_kit(tmp_path: Path, name: str) -> None:
    if name in LIBRARIES:
        pytest.importorskip(LIBRARIES[name], reason=f"{LIBRARIES[name]} is not installed: extra export")
    check_exporter(find_exporter(name), tmp_path)


@pytest.mark.parametrize("name", LIBRARIES)
def test_a_missing_library_is_named_with_its_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    for module in (LIBRARIES[name], f"{LIBRARIES[name]}.writer"):
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.delitem(sys.modules, "mimics_app.recording.exporters._mcap_file", raising=False)
    with pytest.raises(UsageError, match=r"mimics_app\[export\]"):
        export_run(Run.open(RUN), name, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_tables_have_the_numbers_of_the_recording(tmp_path: Path) -> None:
    files = {file.name: file for file in export_run(Run.open(RUN), "csv", tmp_path / "out")}
    run = Run.open(RUN)
    with files["haptic.csv"].open() as file:
        names, *rows = csv.reader(file)
    table = np.array(rows, float)
    np.testing.assert_array_equal(table[:, names.index("f_user_world[1] [N]")], run.haptic["f_user_world"][:, 1])
    assert len(table) == len(run.haptic)
    with files["events_loop_state.csv"].open() as file:
        states = list(csv.DictReader(file))
    lines = run.lines_of("loop", "state")
    assert [int(row["tick"]) for row in states] == [line["tick"] for line in lines]
    assert [json.loads(row["position_world"]) for row in states] == [line["position_world"] for line in lines]
    assert float(states[0]["t_s"]) == pytest.approx((lines[0]["t_ns"] - run.start_ns) * 1e-9)


def test_nothing_is_overwritten_and_names_are_checked(tmp_path: Path) -> None:
    (tmp_path / "there").write_text("mine")
    with pytest.raises(OutputError, match="not empty"):
        export_run(Run.open(RUN), "csv", tmp_path)
    with pytest.raises(UsageError, match='no exporter "cvs"; did you mean "csv"'):
        export_run(Run.open(RUN), "cvs", tmp_path / "new")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["there"]


def test_an_exporter_of_another_package(tmp_path: Path) -> None:
    source = """
class Counts:
    about = "number of ticks"

    def open(self, run, folder):
        (folder / "ticks.txt").write_text(str(len(run.haptic)))
        return [folder / "ticks.txt"]

class Broken(Counts):
    def open(self, run, folder):
        raise KeyError("no such column")

COUNTS, BROKEN = Counts(), Broken()
"""
    (tmp_path / "site").mkdir()
    points = "[mimics_app.exporters]\ncounts = lab_of_formats:COUNTS\nbroken = lab_of_formats:BROKEN\n"
    site = write_package(tmp_path / "site", "lab_of_formats", source, points)
    export = ("record", "export", RUN, "--to")
    done, broken = mimics_with(
        site,
        (*export, "counts", "--output", tmp_path / "out", "--json"),
        (*export, "broken", "--output", tmp_path / "other"),
    )
    assert done.returncode == 0, done.stderr
    (file,) = json.loads(done.stdout)["files"]
    assert Path(file).read_text() == str(len(Run.open(RUN).haptic))
    assert broken.returncode == 2 and "no such column" in broken.stderr
    assert mimics(*export, "counts", "--output", tmp_path / "x").returncode == 2, "it is not installed here"
