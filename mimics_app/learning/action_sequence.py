"""A learning stage that replays adaptations from a file: `--action FILE`.

The file is a JSON list, each entry for a time or for a trial:

    [{"trial": 0, "values": {"radius": 1.2}}, {"t": 12.5, "values": {"stiffness": 800, "assistance": 0.5}}]

`t` is the time since the session's start [s], `trial` counts from 0. `x-` keys are ignored.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, TypeGuard

from mimics_app.contracts.errors import MOST_SOUGHT, Issue, SceneError, nearest
from mimics_app.contracts.messages.action_space import ActionSpace
from mimics_app.contracts.messages.stage_messages import TaskAction, TrialResult, UserState
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.files.reading.json_text import escape, parse_json

__all__ = ["ActionSequence", "TimedAction", "load_action_sequence"]

_MAX_BYTES = 4 << 20
_KEYS = ("t", "trial", "values")


@dataclass(frozen=True, slots=True)
class TimedAction:
    """An action and the time at which it is chosen.

    Attributes:
        at_s: Time since the session's start [s]; 0 for an action that waits for its trial.
        action: The action.
    """

    at_s: float
    action: TaskAction


class ActionSequence:
    """Learning stage that chooses each action of a list at its time, whatever the state of the person.

    Args:
        actions: The actions; none for a task that is not adapted.
    """

    def __init__(self, actions: Sequence[TimedAction] = ()) -> None:
        self._actions = sorted(actions, key=lambda timed: timed.at_s)
        self._next = 0
        self._start_ns: int | None = None

    def choose(
        self, state: UserState, result: TrialResult | None, reward: float | None, now_ns: int
    ) -> TaskAction | None:
        """Return the earliest action that is due and not chosen yet; one per call, so that each is recorded."""
        if self._start_ns is None:
            self._start_ns = now_ns
        if self._next == len(self._actions):
            return None
        timed = self._actions[self._next]
        if (now_ns - self._start_ns) / 1e9 < timed.at_s:
            return None
        self._next += 1
        return timed.action


def load_action_sequence(path: Path, space: ActionSpace) -> ActionSequence:
    """Read an action file against the limits of a scene.

    Raises:
        SceneError: With every fault: no such file, no list, unknown parameters, values outside their limits.
    """
    file = str(path)
    document, issues = parse_json(read_bytes(path, file, _MAX_BYTES), file)
    if not isinstance(document, list):
        fix = 'write [{"t": 0, "values": {...}}, ...]'
        raise SceneError(Issue(file, "", "not a list of actions", fix))
    known = {issue.pointer for issue in issues}
    found = (fault for i, entry in enumerate(document) for fault in _check_entry(entry, f"/{i}", space))
    faults = list(islice(found, MOST_SOUGHT))
    faults = faults or list(islice(_check_trials_differ(document), MOST_SOUGHT))
    issues += [Issue(file, *fault) for fault in faults if fault[0] not in known]
    if issues:
        raise SceneError(issues)
    return ActionSequence([_timed_action(entry) for entry in document])


_Fault = tuple[str, str, str]
"""(pointer, what, fix)"""


def _timed_action(entry: Mapping[str, Any]) -> TimedAction:
    values = {name: float(value) for name, value in entry["values"].items()}
    return TimedAction(float(entry.get("t", 0.0)), TaskAction(values, entry.get("trial")))


def _check_entry(entry: object, pointer: str, space: ActionSpace) -> Iterator[_Fault]:
    if not isinstance(entry, Mapping):
        yield pointer, "not an action", 'write {"t": 0, "values": {...}}'
        return
    for name in entry:
        if name not in _KEYS and not name.startswith("x-"):
            yield f"{pointer}/{escape(name)}", f'unknown key "{name}"', nearest(name, _KEYS)
    yield from _check_moment(entry, pointer)
    values = entry.get("values")
    if not isinstance(values, Mapping) or not values:
        yield f"{pointer}/values", "has no parameter values", 'write {"NAME": number}'
        return
    for name, value in values.items():
        yield from _check_value(name, value, f"{pointer}/values/{escape(name)}", space)


def _check_moment(entry: Mapping[str, Any], pointer: str) -> Iterator[_Fault]:
    if ("t" in entry) == ("trial" in entry):
        yield pointer, "needs either a time or a trial", 'give exactly one of "t" [s] and "trial"'
    elif "t" in entry and not (_is_number(entry["t"]) and entry["t"] >= 0.0):
        yield f"{pointer}/t", f"invalid time {entry['t']!r}", "write seconds, 0 or more"
    elif "trial" in entry and not (
        isinstance(entry["trial"], int) and _is_number(entry["trial"]) and entry["trial"] >= 0
    ):
        yield f"{pointer}/trial", f"invalid trial {entry['trial']!r}", "write a whole number, 0 for the first"


def _check_value(name: str, value: object, pointer: str, space: ActionSpace) -> Iterator[_Fault]:
    if name not in space:
        hint = nearest(name, space.names) if len(space) else "the scene's task has no parameters"
        yield pointer, f'no parameter is called "{name}"', hint
        return
    parameter = space[name]
    unit = "" if parameter.unit == "-" else f" {parameter.unit}"
    if not _is_number(value):
        yield pointer, f"not a number: {value!r}", f"write a number from {parameter.low:g} to {parameter.high:g}{unit}"
    elif not parameter.fits(value):
        what = f"{value:g}{unit} lies outside {parameter.low:g} to {parameter.high:g}{unit}"
        yield pointer, what, "choose a value inside the limits"


def _check_trials_differ(document: Sequence[Mapping[str, Any]]) -> Iterator[_Fault]:
    seen: dict[int, int] = {}
    for i, entry in enumerate(document):
        if "trial" in entry and seen.setdefault(entry["trial"], i) != i:
            yield f"/{i}/trial", f"trial {entry['trial']} has its action at /{seen[entry['trial']]}", "join the two"


def _is_number(value: object) -> TypeGuard[float]:
    """A finite number of a sensible size; whole numbers of JSON have no end."""
    return isinstance(value, int | float) and not isinstance(value, bool) and -1e15 < value < 1e15
