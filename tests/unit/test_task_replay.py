"""A task played again from what a recording says it was given: the same events and rows, and any change is named."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest

from mimics_app.app.session.replay import RecordedTask, TaskFrame, play_again
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.messages.stage_messages import TaskAction
from mimics_app.contracts.ports.scenario_port import Home, TaskContext
from mimics_app.recording.task_lines import TASK_KINDS, compare_lines, compare_rows, gather_task
from mimics_app.recording.trial_table import as_read
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.tasks.task_record import task_of_record, task_record
from tests.support.task_play import START, Player, make_events, make_snapshot

SPEC = {
    "parameters": {"radius": {"default": 1.0, "min": 0.5, "max": 2.0, "maps": [{"to": "visual.radius"}]}},
    "goals": [{"kind": "progress", "at_least": 0.9}],
    "triggers": [{"when": {"kind": "key", "key": "m"}, "do": [{"kind": "action", "values": {"radius": 1.75}}]}],
    "trials": [{"trials": [{"label": "a"}, {"label": "b"}], "order": "shuffled"}],
    "rest_s": 0.1,
    "messages": {"approach": "table"},
}
CONTEXT = TaskContext(
    START, Home(START), places={"table": (1.0, 2.0, 3.0), "lamp": (4.0, 5.0, 6.0)},
    offers=frozenset({"tunnel"}),
)  # fmt: skip


class Kept:
    """One session of a paper robot and all that is kept of it: a key and a pause in trial 0, an action for trial 1."""

    def __init__(self) -> None:
        self.frames: list[TaskFrame] = []
        self.rows: list[Any] = []
        self.lines: list[Any] = []
        spec = msgspec.convert(SPEC, TaskSpec)
        self.record = json.loads(json.dumps(task_record(spec, CONTEXT)))
        manager = TaskManager(
            spec, CONTEXT, 5, self.rows.append, lambda kind, data: self.lines.append({"kind": kind, **data})
        )
        player = Player(manager)
        real = manager.step

        def step(vr: Any, action: Any, snapshot: Any, events: Any, now_ns: int) -> Any:
            self.frames.append(TaskFrame(vr.pressed, vr.commands, action, snapshot, events, now_ns))
            return real(vr, action, snapshot, events, now_ns)

        manager.step = step  # type: ignore[method-assign]
        player.step(action=TaskAction({"radius": 9.0}, at_trial=1))
        player.until("travel")
        player.step((player.now_ns, EventKind.CONTACT_BEGIN, 2.0), pressed=("m",))
        for pressed in (("p",), (), (), ("p",)):
            player.step(pressed=pressed)
        player.until("done")
        self.end_ns = player.now_ns
        manager.end_session(self.end_ns)

    def again(self, frames: list[TaskFrame] | None = None, seed: int = 5) -> Any:
        return play_again(RecordedTask(*task_of_record(self.record), seed), frames or self.frames, self.end_ns)

    def differing(self, again: Any) -> str:
        plain = [json.loads(json.dumps({"source": "app", **line})) for line in self.lines]
        rows = [as_read(row) for row in self.rows]
        return str(compare_lines(plain, again.lines) or compare_rows(rows, again.rows, whole=True))


@pytest.fixture(scope="module")
def kept() -> Kept:
    return Kept()


def test_the_task_is_kept_with_the_places_it_names_and_no_others(kept: Kept) -> None:
    spec, context = task_of_record(kept.record)
    assert spec == msgspec.convert(SPEC, TaskSpec)
    assert dict(context.places) == {"table": (1.0, 2.0, 3.0)}
    assert (context.start_joints, context.home, context.offers) == (
        START, CONTEXT.home, CONTEXT.offers
    )  # fmt: skip


def test_kinds_that_do_not_play_leave_nothing_in_the_record(kept: Kept) -> None:
    """A run that was recorded beside a plug-in's kind of task is replayed where that is not installed."""
    spec, written = kept.record["spec"], msgspec.to_builtins(msgspec.convert(SPEC, TaskSpec))
    idle = [kind for kind in task_kinds() if kind.section is not None and written[kind.name] is None]
    assert idle
    for kind in idle:
        assert kind.name not in spec
        assert not {measure.part for measure in kind.measures} & spec["score"].keys()


def test_the_same_frames_give_the_same_events_and_rows(kept: Kept) -> None:
    assert {line["kind"] for line in kept.lines} == set(TASK_KINDS)
    assert [row["parameter.radius"] for row in kept.rows] == [1.0, 2.0]
    assert kept.differing(kept.again()) == "None"


def test_a_recording_of_before_there_were_commands_is_steered_by_its_keys(kept: Kept) -> None:
    older = [replace(frame, commands=None) for frame in kept.frames]
    assert kept.differing(kept.again(older)) == "None"
    assert "pause" in kept.differing(kept.again([replace(frame, commands=()) for frame in kept.frames]))


def _changed(kept: Kept, number: int, **values: Any) -> list[TaskFrame]:
    frames = list(kept.frames)
    old = frames[number]
    fields = {name: getattr(old, name) for name in TaskFrame.__slots__}
    frames[number] = TaskFrame(**{**fields, **values})
    return frames


def _key_frame(kept: Kept) -> int:
    return next(i for i, frame in enumerate(kept.frames) if frame.pressed)


@pytest.mark.seconds
def test_each_input_of_a_frame_counts(kept: Kept) -> None:
    key = _key_frame(kept)
    now_ns = kept.frames[key].now_ns
    pushed = np.array([0.0, 7.0, 0.0])
    harder = make_snapshot(now_ns, progress=kept.frames[key].snapshot.progress, f_user_world=pushed)
    cases = {
        "at_trial": _changed(kept, 0, action=TaskAction({"radius": 9.0}, at_trial=0)),
        "task event": _changed(kept, key, pressed=()),
        "row 0, contacts": _changed(kept, key, events=make_events()),
        "row 0, force_mean_n": _changed(kept, key, snapshot=harder),
        "(action), t_ns": _changed(kept, 0, now_ns=1),
    }
    for named, frames in cases.items():
        assert named in kept.differing(kept.again(frames)), named
    assert "row 0, label" in {kept.differing(kept.again(seed=seed)).partition(":")[0][11:] for seed in range(6, 20)}


def test_a_flipped_figure_or_event_is_named(kept: Kept) -> None:
    again = kept.again()
    rows = [as_read(row) for row in kept.rows]
    for name in rows[0]:
        spoilt = [{**rows[0], name: "another"}, *rows[1:]]
        assert f"trials.csv row 0, {name}: recorded 'another'" in str(compare_rows(spoilt, again.rows, whole=True))
    lines = [json.loads(json.dumps({"source": "app", **line})) for line in kept.lines]
    spoilt = [*lines[:2], {**lines[2], "state": "rest"}, *lines[3:]]
    assert "task event 2 (state), state: recorded 'rest'" in str(compare_lines(spoilt, again.lines))
    assert "number of task events" in str(compare_lines(lines[:-1], again.lines))
    assert "number of trial rows" in str(compare_rows(rows[:-1], again.rows, whole=True))
    assert compare_rows(rows[:-1], again.rows, whole=False) is None, "a run that was cut off"


def _run(lines: list[dict[str, Any]], status: str = "clean", end: int = 1000) -> Any:
    return SimpleNamespace(folder=Path("run"), status=status, end_of_ticks=end, lines=lines, trials=[])


def _line(kind: str, **data: Any) -> dict[str, Any]:
    return {"source": "app", "kind": kind, **data}


def test_a_run_that_was_cut_off_is_compared_up_to_its_last_frame() -> None:
    lines = [
        _line("state", state="approach"), _line("frame", frame=0, tick=16, t_ns=17),
        _line("state", state="ready"), _line("frame", frame=1, tick=33, t_ns=34, pressed=["m"], events=2),
        _line("state", state="travel"),
    ]  # fmt: skip
    cut = gather_task(_run(lines, "interrupted", end=30))
    assert [frame.frame for frame in cut.frames] == [0] and [line["state"] for line in cut.lines] == ["approach"]
    whole = gather_task(_run(lines))
    assert [line["state"] for line in whole.lines] == ["approach", "ready", "travel"] and whole.end_ns is None
    assert (whole.frames[1].pressed, whole.frames[1].events) == (("m",), 2)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (_line("frame", frame=1, tick=0, t_ns=0), "frame 0 is missing"),
        (_line("frame", frame=0, tick=0, t_ns=0, action={"values": "x"}), "frame 0 is damaged"),
    ],
)
def test_frames_that_are_not_there_are_reported(line: dict[str, Any], said: str) -> None:
    with pytest.raises(PartialDataError, match=said):
        gather_task(_run([line]))
