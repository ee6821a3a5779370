"""Recordings of earlier versions, kept as they were written, are read for ever.

Each folder of tests/data/run_* is 0.3 s of a run on the virtual clock: the wavy tunnel before there were objects,
the same with their tables and without what acts on forces, pick and place, and the wavy tunnel as the last version had
it whose blocks held the tunnel themselves. What session.json says of the machine
and its folders was taken out. They are never made anew: a version that changes the format adds one of its own.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.loop.controller_port import places_of
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.recording.older_blocks import current_block
from mimics_app.recording.recover import recover
from mimics_app.recording.replay import compare, gather
from mimics_app.recording.report import page_of, write_report
from mimics_app.recording.run import Run
from mimics_app.recording.verdict import evaluate
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import EDGES
from mimics_app.rendering.haptic.controllers.orthosis_legs import PARAMETERS
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.replay import replay_run
from mimics_app.tasks.kinds.registry import report_sections

FROZEN = sorted((Path(__file__).parents[1] / "data").glob("run_*"))
COLUMNS = {"tick", "state", "hip_world[0]", "hip_world[1]", "hip_world[2]", "f_user_world[0]", "f_meas[0]", "q[0]"}
"""Of every version there ever was."""


def test_there_are_four_and_all_are_small() -> None:
    names = ["run_0_1_0", "run_0_1_0_block", "run_0_1_0_objects", "run_0_1_0_tunnel"]
    assert [folder.name for folder in FROZEN] == names
    for folder in FROZEN:
        assert sum(path.stat().st_size for path in folder.rglob("*")) < 300_000, folder


@pytest.mark.parametrize("folder", FROZEN, ids=lambda folder: folder.name)
def test_frozen_recording_is_whole(folder: Path) -> None:
    run = Run.open(folder)
    assert evaluate(run).whole
    assert "of another version" in " ".join(run.notes())
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
    scene = json.loads((copy / "session.json").read_text())["scene"]["name"].replace("_", " ").lower()
    assert page_of(Run.open(copy), report_sections()).title.lower() == f"report of {scene}"
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
    printed = capsys.readouterr().out
    assert "300 ticks replayed, every output and 7 events equal" in printed and "its task is not compared" in printed
    for folder in FROZEN[1:]:
        if folder.name == "run_0_1_0_block":  # its tunnel stands in the blocks: simulated again below
            continue
        assert main(["replay", str(folder)]) == 6
        assert "recorded with other columns; replay it with the version it names" in capsys.readouterr().err


def test_a_recording_with_the_tunnel_in_its_blocks_is_simulated_again_bit_for_bit() -> None:
    data = gather(Run.open(FROZEN[0].parent / "run_0_1_0_block"))
    assert {len(rows.tunnels) for rows in data.rows.values()} == {1}
    assert {block.dtype for block in data.blocks.values()} == {SCENE}
    statics = None if data.statics is None else ObjectStatics.from_arrays(data.statics.arrays, data.statics.fields)
    replayed = replay_run(data.samples, data.blocks, data.rows, statics).samples
    assert compare(data.samples, replayed, Run.open(FROZEN[0].parent / "run_0_1_0_block").layout.uncompared) is None


@pytest.mark.parametrize(
    ("name", "why"),
    [("run_0_1_0_objects", "other columns"), ("run_0_1_0_tunnel", "other columns")],
)
def test_a_recording_that_lacks_an_input_is_refused_with_the_reason(name: str, why: str) -> None:
    with pytest.raises(PartialDataError, match=why):
        gather(Run.open(FROZEN[0].parent / name))


def test_a_block_with_fewer_parameters_of_controllers_is_one_of_this_version() -> None:
    names = SCENE.names or ()
    fewer = [(name, ("f8", (6, 64)) if name == "controller_parameters" else SCENE[name]) for name in names]
    old = np.zeros(1, np.dtype(fewer, align=True))
    old["controller_parameters"][0, 2, 63], old["virtual_mass"] = 7.0, 3.0
    block = current_block(old, None)
    assert block is not None and block.dtype == SCENE and block["virtual_mass"][0] == 3.0
    assert block["controller_parameters"][0, 2].tolist() == [*[0.0] * 63, 7.0, *[0.0] * 32]


def test_the_orthosis_finds_its_parameters_in_a_recorded_block_where_they_always_were() -> None:
    """What came later stands behind them, where such a block has 0: without play, encoder steps and sensor watch."""
    places = dict(zip((each.name for each in PARAMETERS), places_of(PARAMETERS), strict=True))
    kept = {"as_printed": 0, "bandwidth": 21, "motor_mass": 34, "hip_fixed_arm": 40, "rate": 50, "frozen_torque": 53}
    assert kept.items() <= places.items()
    assert places["outline_z"] == 70 and EDGES == 16
    assert min(places[name] for name in ("backlash", "encoder", "frozen_sensor")) == 86


def test_a_block_that_says_something_else_is_no_block_of_this_version() -> None:
    run = Run.open(FROZEN[0].parent / "run_0_1_0_block")
    number, block = next(iter(run.parameters.items()))
    assert current_block(block, run.rows[number]) is not None
    other = [("virtual_weight" if name == "virtual_mass" else name, block.dtype[name]) for name in block.dtype.names]
    assert current_block(np.zeros(1, np.dtype(other)), run.rows[number]) is None
    assert current_block(block, None) is None
