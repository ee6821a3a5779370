"""The table of numbers out of the loop: it is complete, everything is made from it, and one more costs two files."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import POINT_SNAPSHOT, SAMPLE, SNAPSHOT
from mimics_app.contracts.loop.loop_fields import (
    LOOP_FIELDS,
    MAX_CONTACTS,
    HapticSnapshot,
    LoopField,
    Per,
    PointSnapshot,
    Replay,
    check_snapshot,
    moves_of,
    point_rows,
)
from mimics_app.contracts.loop.loop_ports import DATA_FORCE, DATA_GRASP, DATA_LENGTH
from mimics_app.contracts.loop.object_rows import ROW_DTYPES, ObjectCapacities
from mimics_app.contracts.shared_memory.session_memory import SHARED_ARRAYS, Capacities, SessionMemory
from mimics_app.rendering.haptic.channels import CHANNELS, Channels
from mimics_app.rendering.haptic.kernels.objects.totals import TOTALS
from mimics_app.rendering.haptic.kernels.rows import write_inputs, write_outputs, write_snapshot
from mimics_app.rendering.haptic.kernels.state import STATE

PACKAGE = Path(__file__).parents[2] / "mimics_app"
TABLE = "contracts/loop/loop_fields.py"
KERNEL = "rendering/haptic/kernels/sensing.py"


# the table


@pytest.mark.parametrize("field", [field for field in LOOP_FIELDS if field.reader], ids=lambda field: field.name)
def test_every_number_in_the_snapshot_is_read_where_the_table_says(field: LoopField) -> None:
    use = re.compile(rf'\b(snapshot|point)(\.{field.name}\b|\["{field.name}"\])')
    room = PACKAGE.joinpath(*field.reader.split("."))
    assert any(use.search(file.read_text()) for file in room.rglob("*.py")), f"nothing in {field.reader} reads it"


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (("x", ""), "not have one unit"),
        (("x", ("m", "rad")), "not have one unit for each of 3"),
        (("x", ("m", "", "m")), "not have one unit for each of 3"),
    ],
)
def test_a_row_without_a_unit_is_refused(arguments: tuple[Any, ...], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        LoopField(*arguments, Replay.OUTPUT, size=3)
    with pytest.raises(TypeError, match="unit"):
        LoopField("x", replay=Replay.OUTPUT)  # type: ignore[call-arg]


@pytest.mark.parametrize(
    "wrong", [{"source": "scene.kp"}, {"kind": "f4"}, {"replay": Replay.ABSENT}], ids=["source", "kind", "nobody"]
)
def test_a_row_that_goes_nowhere_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"^x\b"):
        LoopField(**({"name": "x", "unit": "m", "replay": Replay.OUTPUT} | wrong))


def test_the_typed_message_has_the_rows_that_are_read_and_their_types() -> None:
    assert {field.name for field in fields(HapticSnapshot)} == {*(SNAPSHOT.names or ()), "poses"}
    assert {field.name for field in fields(PointSnapshot)} == {*(POINT_SNAPSHOT.names or ())}
    check_snapshot(LOOP_FIELDS)
    unread = [field for field in LOOP_FIELDS if field.name != "margin"]
    with pytest.raises(TypeError, match="margin"):
        check_snapshot(unread)
    with pytest.raises(TypeError, match="margin"):
        check_snapshot([*unread, LoopField("margin", "1", Replay.OUTPUT, kind="i8", reader="app")])
    with pytest.raises(TypeError, match="push"):
        check_snapshot([*LOOP_FIELDS, LoopField("push", "N", Replay.OUTPUT, reader="app")])


# the writers


def _numbered(dtype: np.dtype[Any], start: int) -> np.ndarray:
    """One record, every number of it another one."""
    record = np.zeros(1, dtype)
    count = start

    def fill(part: Any) -> None:
        nonlocal count
        for name in part.dtype.names:
            for inner in part[name].reshape(-1) if part[name].dtype.names else []:
                fill(inner)
            if not part[name].dtype.names:
                size = part[name].size
                part[name] = np.arange(count, count + size).reshape(part[name].shape)
                count += size

    fill(record[0])
    return record


def test_writers_fill_every_number_from_where_the_table_says() -> None:
    states = np.concatenate([_numbered(STATE, 1 + 10_000 * c) for c in range(MAX_CONTACTS)])
    states["contacts"] = MAX_CONTACTS
    all_totals = np.concatenate([_numbered(TOTALS, 5000 + 10_000 * c) for c in range(MAX_CONTACTS)])
    data = 0.5 + np.arange(DATA_LENGTH)
    row, snapshot = np.zeros(1, SAMPLE), np.zeros(1, SNAPSHOT)
    row.view(np.float64)[:] = np.nan
    snapshot.view(np.int64)[:] = -77
    write_inputs(data, 1, 2, 3, 0.25, states[0], 1e-3, row[0])
    write_outputs(MAX_CONTACTS, states, all_totals, row[0])
    write_snapshot(MAX_CONTACTS, states, all_totals, 123, snapshot[0])
    of_each_point = [field for field in LOOP_FIELDS if field.per is Per.POINT]
    for recorded, out in ((True, row), (False, snapshot)):
        for c in range(MAX_CONTACTS):
            rows, written = (of_each_point, point_rows(out, c)) if c else (LOOP_FIELDS, out)
            for which, path, name in moves_of(rows, recorded=recorded):
                value = (states, all_totals)[which][c]
                for part in path:
                    value = value[part]
                assert np.array_equal(written[0][name], value), (c, name)
    assert point_rows(row, 2)["grasp"][0] == data[DATA_GRASP + 2]
    assert list(point_rows(row, 2)["f_meas"][0]) == list(data[DATA_FORCE + 6 : DATA_FORCE + 9])
    for field in LOOP_FIELDS:
        if field.replay not in (Replay.ABSENT, Replay.TIMING):
            assert np.isfinite(row[0][field.name]).all(), f"{field.name} is not written"
        if field.reader:
            assert not np.array_equal(snapshot[field.name].view("i8"), np.full(field.size, -77)), field.name


# the shared memory


def test_one_list_makes_the_shared_memory_and_what_the_loop_sees_of_it() -> None:
    capacities = Capacities(ObjectCapacities(bodies=0, shapes=3), samples=8, events=4)
    memory = SessionMemory(capacities)
    for name, shared in SHARED_ARRAYS.items():
        array = getattr(memory, name)
        assert array.dtype == np.dtype(shared.dtype) and array.shape == shared.sizes(capacities), name
    assert (memory.poses.shape, memory.shapes.shape, memory.samples.shape) == ((3, 0, 7), (3, 3), (8,))
    of_commands = {"commands", "command_words", "answers", "answer_words"}  # the loop sees their stop words only
    assert {*SHARED_ARRAYS} - {*Channels._fields} == {*ROW_DTYPES} | of_commands
    assert len(CHANNELS) == len(Channels._fields)


# one more


ROW = '    LoopField("squeeze", "N/m", Replay.OUTPUT, kind="f8", reader="app"),\n'
EDITS = {
    TABLE: [
        ('    LoopField("lateness_ns"', ROW + '    LoopField("lateness_ns"'),
        ("    poses: Vec\n", "    squeeze: float\n    poses: Vec\n"),
    ],
    KERNEL: [
        (
            "    last = state.ball_radius\n",
            "    state.squeeze = 1.0 + 2.0 * state.grasp\n    last = state.ball_radius\n",
        )
    ],
}

USE = """
import json, sys
from pathlib import Path
import numpy as np
from mimics_app.contracts.loop.haptic import SAMPLE, SCENE, SNAPSHOT
from mimics_app.contracts.messages.stage_messages import HapticSnapshot
from mimics_app.recording.run import Run
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.streams import SampleStream
from mimics_app.rendering.haptic.kernels.objects.totals import TOTALS
from mimics_app.rendering.haptic.kernels.rows import write_outputs, write_snapshot
from mimics_app.rendering.haptic.kernels.sensing import size_ball
from mimics_app.rendering.haptic.kernels.state import STATE

folder = Path(sys.argv[1])
scene, state, totals = np.zeros(1, SCENE), np.zeros(1, STATE), np.zeros(1, TOTALS)
row, snapshot = np.zeros(1, SAMPLE), np.zeros(1, SNAPSHOT)
state["grasp"] = 3.5
size_ball(scene[0], state[0], 1e-3)
write_outputs(1, state, totals, row[0])
write_snapshot(1, state, totals, 0, snapshot[0])
names = [name for name in snapshot.dtype.names if name != "further"]
message = HapticSnapshot(**{name: snapshot[0][name] for name in names}, poses=np.zeros((0, 7)))
hashed = StateHash()
stream = SampleStream(folder, hashed)
stream.append(row, 0)
stream.sync()
run = Run.open(folder)
columns, units = (json.loads(run.layout.schema.metadata[key]) for key in (b"columns", b"units"))
unit = dict(zip(columns, units))["squeeze"]
print(json.dumps([float(message.squeeze), float(run.haptic["squeeze"][0]), unit, hashed.hexdigest()]))
"""

LOOP = """
import json
from tests.support.haptic_bench import patient_bench

bench = patient_bench()
samples = bench.advance(400)
snapshot = bench.engine.snapshot()
again = bench.replay(samples)
same = snapshot.squeeze == 1.0 + 2.0 * snapshot.grasp
kept = bool((samples["squeeze"] == 1.0 + 2.0 * samples["grasp"]).all())
print(json.dumps([same, kept, bool((samples["squeeze"] == again["squeeze"]).all())]))
"""


@pytest.fixture
def product(tmp_path: Path) -> Path:
    """A folder with a copy of the product in which the table and one kernel were edited, and nothing else."""
    shutil.copytree(PACKAGE, tmp_path / "mimics_app", ignore=shutil.ignore_patterns("__pycache__"))
    for file, edits in EDITS.items():
        text = (tmp_path / "mimics_app" / file).read_text()
        for before, after in edits:
            assert text.count(before) == 1, before
            text = text.replace(before, after)
        (tmp_path / "mimics_app" / file).write_text(text)
    return tmp_path


def _answer(product: Path, code: str, *arguments: str) -> Any:
    environment = os.environ | {"PYTHONPATH": str(product), "NUMBA_CACHE_DIR": str(product / "cache")}
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, cwd=product, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.seconds
def test_a_new_number_out_of_the_loop_is_two_files(product: Path) -> None:
    """Its row and the kernel that computes it bring it into snapshot, sample and recording, with its unit."""
    (product / "run").mkdir()
    published, recorded, unit, state_hash = _answer(product, USE, str(product / "run"))
    assert (published, recorded, unit) == (8.0, 8.0, "N/m") and len(state_hash) == 64


@pytest.mark.slow
def test_a_new_number_comes_out_of_the_whole_loop_and_is_replayed(product: Path) -> None:
    """Compiles the loop once more, for a number in it changes every record."""
    shutil.copytree(PACKAGE.parent / "tests" / "support", product / "tests" / "support")
    assert _answer(product, LOOP) == [True, True, True]
