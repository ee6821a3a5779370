"""Conformance kit of kinds of task: what manager, score, board and journal take for granted of one.

`python -m tests.support.task_kind_kit NAME SCENE` runs it on a kind of an installed package.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.tasks.cards import CARDS
from mimics_app.tasks.kinds.kind import KindPlay, TaskKind
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.scene_section import task_of
from tests.support.core_play import CorePlay

SEED = 5


def check_task_kind(name: str, file: Path, seconds: float = 3.0) -> None:
    """Play a scene of the kind twice, frame by frame; raises AssertionError, or the error that would end the run."""
    (kind,) = (each for each in task_kinds() if each.name == name)
    _check_statements(kind)
    scene = load_checked_scene(file)
    spec = task_of(scene)
    assert not list(kind.check(spec, "/task")) and not kind.check_scene(spec, scene), "its own scene has no faults"
    one, other = (_play(kind, file, seconds) for _ in range(2))
    assert one == other, "the seed alone decides how a task goes"


def _check_statements(kind: TaskKind) -> None:
    """What the schema, the trial table and the report are made of."""
    assert kind.name.isidentifier(), "a name is a key of the task block"
    columns, parts = [m.column for m in kind.measures], [m.part for m in kind.measures]
    assert len(set(columns)) == len(columns) and len(set(parts)) == len(parts), "each measure has names of its own"
    for measure in kind.measures:
        assert measure.what.endswith("."), f"{measure.column} is described in a sentence, for the schema"
        part = measure.default
        assert part.weight >= 0.0 and part.best != part.worst, (
            f"{measure.part}: full marks and none are different values"
        )
    assert not set(kind.cards) & set(CARDS), "a card has a name that no card of every task has"
    for struct in (*kind.goals, *kind.conditions):
        assert struct.__struct_config__.tag_field == "kind", f"{struct.__name__} is told apart by its kind"


def _play(kind: TaskKind, file: Path, seconds: float) -> list[Any]:
    """Return everything the kind says in a session, for comparison."""
    play = CorePlay.of(load_checked_scene(file), SEED)
    tasks = play.core.tasks
    assert kind.name in tasks._plays, "it takes the task of its own scene"
    own = tasks._plays[kind.name]
    journal = _listen(own)
    said: list[Any] = []
    try:
        for _ in range(round(seconds * 60)):
            play.step()
            said.append(_frame_of(kind, own, tasks))
            assert 0.0 <= play.frames.orders.view.progress <= 1.0, "progress is a share"
        tasks.end_session(play.core.clock.now_ns())
    finally:
        play.core.stop()
    assert {what for what, _ in journal} <= set(kind.journals), "a replay compares the journal lines that it names"
    rows = json.loads(json.dumps(tasks.rows, allow_nan=False))
    assert all({m.column for m in kind.measures} <= row.keys() for row in rows), "each measure is a column"
    return [said, json.loads(json.dumps(journal, allow_nan=False)), rows]


def _listen(play: KindPlay) -> list[tuple[str, Any]]:
    """Keep the journal lines that a play gives to the manager."""
    kept: list[tuple[str, Any]] = []
    take = play.take_events

    def take_and_keep() -> Any:
        lines = take()
        kept.extend(lines)
        return lines

    play.take_events = take_and_keep  # type: ignore[method-assign]
    return kept


def _frame_of(kind: TaskKind, play: KindPlay, tasks: Any) -> tuple[Any, ...]:
    words, orders = dict(play.words), dict(play.orders)
    line = play.prompt.format(**words)
    assert repr(orders) == repr(dict(play.orders)), "what is ordered does not change by asking"
    measures = dict(play.measures)
    assert measures.keys() <= {m.column for m in kind.measures}, "it measures what it has declared"
    assert all(value is None or math.isfinite(value) for value in measures.values()), "a measure is finite, or None"
    cards = play.cards(tasks._seen, 0) if tasks._seen is not None else {}
    assert cards.keys() <= set(kind.cards), "it shows the cards that it has declared"
    return line, words, repr(orders), measures, {name: card.text for name, card in cards.items()}


if __name__ == "__main__":
    check_task_kind(sys.argv[1], Path(sys.argv[2]))
