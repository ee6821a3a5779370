"""What the loop cannot simulate is reported: pairs beyond its room, force fields that give no number."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.app.session.frame import LossWatch
from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.loop.loop_ports import FIELD
from mimics_app.rendering.haptic import force_fields
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from tests.support.object_scenes import thing, written

BALLS = 60
ROOM = 24 * BALLS
"""Pairs there is room for; all balls in one place make 60 * 59 / 2."""


@typed_kernel(FIELD)
def _ends(parameters: Any, p: Any, v: Any, t: float, out: Any) -> None:
    """No number after so many seconds."""
    out[0] = math.sqrt(parameters[0] - t)


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> dict[str, Any]:
    """A run of a scene with more neighbours than there is room for, and two fields that end in the same tick."""
    folder: Path = tmp_path_factory.mktemp("losses")
    force_fields.add_field("ends", _ends)
    ball = {"shapes": [{"shape": "sphere", "radius": 0.02}], "stiffness": 10.0, "damping": 0.1, "mass": 1.0}
    things = [thing(f"ball_{i}", haptic_object=ball) for i in range(BALLS)]
    fields = [thing(name, force_field={"function": "ends", "parameters": [0.2]}) for name in ("gust", "pull")]
    file = written(folder, thing("robot", robot={}), thing("patient", patient={}), *things, *fields)
    return {"file": file, "runs": folder}


@pytest.mark.fault(id="F04")
def test_losses_are_reported_once_counted_and_in_the_report(run, capsys):
    words = ["run", str(run["file"]), "--headless", "--seconds", "0.5", "--pictures", "0", "--sound", "off", "--json"]
    assert main([*words, "--runs", str(run["runs"])]) == 0
    printed = capsys.readouterr()
    answer = json.loads(printed.out)
    assert answer["losses"] == {
        "pairs_left_out": BALLS * (BALLS - 1) // 2 - ROOM,
        "fields_disabled": ["gust", "pull"],
    }
    lines = printed.err.splitlines()
    assert sum("do not collide" in line for line in lines) == 1
    for name in ("gust", "pull"):
        assert sum(f'the force field of "{name}" gave a number that is not finite' in line for line in lines) == 1
    report = Path(answer["report"]).read_text(encoding="utf-8")
    assert "330 pairs of shapes near each other, for lack of capacity" in report
    assert "the force field of effect 2" in report
    assert main(["replay", answer["run_dir"]]) == 0


def test_most_pairs_at_once_are_counted_and_only_the_first_are_reported(capsys):
    watch = LossWatch(("gust",))
    events = np.zeros(4, EVENT)
    events["kind"] = [EventKind.LEFT_OUT, EventKind.LEFT_OUT, EventKind.IMPACT, EventKind.QUARANTINE]
    events["force"] = [1, 7, 3, 0]
    watch.see(events)
    assert watch.summary() == {"pairs_left_out": 7, "fields_disabled": ["gust"]}
    assert capsys.readouterr().err.count("\n") == 2


def test_a_recording_whose_field_is_not_installed_is_one_line():
    statics = ObjectStatics.from_arrays({}, ["gone_with_its_plug_in"])
    with pytest.raises(UsageError, match="gone_with_its_plug_in"):
        statics.functions()
