"""Recordings of earlier versions, kept as they were written, are read for ever.

Each folder of tests/data/run_* is 0.3 s of a run on the virtual clock: the wavy tunnel before there were objects,
the same with their tables and without what acts on forces, and pick and place. What session.json says of the machine
and its folders was taken out. They are never made anew: a version that changes the format adds one of its own.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.recording.recover import recover
from mimics_app.recording.report import page_of, write_report
from mimics_app.recording.run import Run
from mimics_app.recording.verdict import judge
from mimics_app.tasks.kinds.registry import report_sections

FROZEN = sorted((Path(__file__).parents[1] / "data").glob("run_*"))
COLUMNS = {"tick", "state", "hip_world[0]", "hip_world[1]", "hip_world[2]", "f_user_world[0]", "f_meas[0]", "q[0]"}
"""Of every version there ever was."""


def test_there_are_three_and_all_are_small() -> None:
    assert [folder.name for folder in FROZEN] == ["run_0_1_0", "run_0_1_0_objects", "run_0_1_0_tunnel"]
    for folder in FROZEN:
        assert sum(path.stat().st_size for path in folder.rglob("*")) < 300_000, folder


@pytest.mark.parametrize("folder", FROZEN, ids=lambda folder: folder.name)
def test_frozen_recording_is_whole(folder: Path) -> None:
    run = Run.open(folder)
    assert judge(run).whole
    assert ("of another version" in " ".join(run.notes())) == (folder.name != "run_0_1_0")
    assert run.status == "clean" and not COLUMNS & set(run.layout.absent)
    assert np.array_equal(run.haptic["tick"], np.arange(300)) and run.haptic["t"][-1] == pytest.approx(0.299)
    assert len(run.events) == run.manifest.events > 0 and len(run.trials) == 1
    states = [int(event["force"]) for event in run.events if event["kind"] == 3]
    assert [int(state) for state in np.unique(run.haptic["state"])] == sorted({*states} - {0})
    assert len(run.parameters) == run.manifest.parameters > 0
    assert all(int(block["sequence"][0]) == number for number, block in run.parameters.items())
    assert run.session["scene"]["document"]["entities"]


@pytest.mark.parametrize("folder", FROZEN, ids=lambda folder: folder.name)
def test_frozen_recording_is_reported_and_recovered(folder: Path, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(folder, tmp_path / "run"))
    scene = json.loads((copy / "session.json").read_text())["scene"]["name"].replace("_", " ")
    assert page_of(Run.open(copy), report_sections()).title == f"Report of {scene}"
    heading = "Carrying" if scene == "pick and place" else "Movement through the tunnel"
    assert f"<h2>{heading}</h2>" in write_report(copy, report_sections()).read_text()
    before = Run.open(copy).haptic.tobytes()
    (copy / "manifest.json").unlink()
    assert recover(copy).verdict.status == "recovered"
    again = Run.open(copy)
    assert again.haptic.tobytes() == before and again.losses() == Run.open(folder).losses()
    assert json.loads((copy / "session.json").read_text()) == json.loads((folder / "session.json").read_text())


def test_frozen_recording_is_replayed_where_its_inputs_suffice(capsys: pytest.CaptureFixture[str]) -> None:
    """The newest of the three: what it does not know yet is as it was without. The others say what they lack."""
    assert main(["replay", str(FROZEN[0])]) == 0
    told = capsys.readouterr().out
    assert "300 ticks replayed, every output and 7 events equal" in told and "its task is not compared" in told
    for folder in FROZEN[1:]:
        assert main(["replay", str(folder)]) == 6
        assert "recorded with other columns; replay it with the version it names" in capsys.readouterr().err
