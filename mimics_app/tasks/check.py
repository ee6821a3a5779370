"""Checks of a task beyond its types: consistent limits, existing names, finite numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from mimics_app.contracts.errors import Issue, nearest
from mimics_app.contracts.loop.field_ranges import RANGES, Range, range_of, writable_names
from mimics_app.contracts.loop.haptic import LIMIT_NAMES, SCENE
from mimics_app.contracts.loop.object_rows import ROW_DTYPES
from mimics_app.contracts.messages.stage_messages import GAIN
from mimics_app.tasks.actions import TARGET_GROUPS, haptic_target, task_targets
from mimics_app.tasks.kinds.kind import Fault
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import ActionDeed, MapSpec, ParameterSpec, ScoreSpec, TaskSpec
from mimics_app.tasks.trial_specs import BlockSpec
from mimics_app.world.files.reading.json_text import escape

__all__ = ["check_blocks", "check_task", "haptic_targets", "object_of_target"]

_MAX_TRIALS = 10_000


def check_task(spec: TaskSpec, pointer: str = "/task", file: str = "") -> list[Issue]:
    """Return the faults of a task beyond its types.

    Args:
        spec: The task, of the right types already. A trial file it names is checked by `tasks.trial_file`.
        pointer: JSON pointer of the task in its file.
        file: The file, as the user wrote it.
    """
    faults: list[Fault] = []
    for place, parameter in spec.placed_parameters(pointer):
        faults += _check_parameter(parameter, place)
    for i, trigger in enumerate(spec.triggers):
        for j, deed in enumerate(trigger.do):
            if isinstance(deed, ActionDeed):
                faults += _check_values(deed.values, spec.parameters, f"{pointer}/triggers/{i}/do/{j}/values")
    faults += _check_score(spec.score, f"{pointer}/score")
    for name, other in spec.devices.items():
        place = f"{pointer}/devices/{escape(name)}"
        if other.score is not None:
            faults += _check_score(other.score, f"{place}/score")
    for kind in task_kinds():
        faults += kind.check(spec, pointer)
    issues = [Issue(file, place, what, fix) for place, what, fix in faults]
    return issues + ([] if isinstance(spec.trials, str) else check_blocks(spec, spec.trials, f"{pointer}/trials", file))


def check_blocks(spec: TaskSpec, blocks: list[BlockSpec], pointer: str, file: str) -> list[Issue]:
    """Return the faults of a trial list, inline or from its own file, against the task's parameters."""
    faults: list[Fault] = []
    for b, block in enumerate(blocks):
        for t, trial in enumerate(block.trials):
            faults += _check_values(trial.values, spec.parameters, f"{pointer}/{b}/trials/{t}/values")
    if sum(len(block.trials) * block.repetitions for block in blocks) > _MAX_TRIALS:
        faults.append((pointer, f"more than {_MAX_TRIALS} trials in one session", "make fewer repetitions"))
    return [Issue(file, place, what, fix) for place, what, fix in faults]


def object_of_target(name: str) -> str | None:
    """Return the entity of a haptic target such as "bodies.apple.mass"; None for other names and non-scalars."""
    table, *middle = name.split(".")
    field = middle.pop() if middle else ""
    if table not in RANGES or not middle or not _is_scalar_target(table, field):
        return None
    return ".".join(middle)


def haptic_targets() -> set[str]:
    """Return the haptic names that a parameter may change: feel, and scalars of the task's own tunnel.

    Scalars of objects are checked by `object_of_target`. Limits of the loop are never among them.
    """
    own = {f"tunnel.{name}" for name in writable_names("tunnel") if _is_scalar_target("tunnels", name)}
    return own | {name for name in writable_names("") if not SCENE[name].shape}


def _is_scalar_target(table: str, field: str) -> bool:
    return range_of(table, field) is not None and not ROW_DTYPES[table][field].shape


def _range_of_target(name: str) -> Range | None:
    """Return the range of a haptic target; None: a task may not write it."""
    if name not in haptic_targets() and object_of_target(name) is None:
        return None
    return range_of(name.partition(".")[0] if "." in name else "", name.rpartition(".")[2])


def _check_parameter(parameter: ParameterSpec, pointer: str) -> Iterator[Fault]:
    if parameter.max < parameter.min:
        yield f"{pointer}/max", f"{parameter.max:g} is below min, {parameter.min:g}", "exchange the two"
    elif parameter.default is None and not any(haptic_target(target) for target in parameter.maps):
        yield f"{pointer}/default", "is missing, and no haptic field gives one", "write a number from min to max"
    elif parameter.default is not None and not parameter.min <= parameter.default <= parameter.max:
        yield f"{pointer}/default", _outside(parameter.default, parameter), "choose a default inside the limits"
    for i, target in enumerate(parameter.maps):
        yield from _check_map(target, parameter, f"{pointer}/maps/{i}")


def _check_map(target: MapSpec, parameter: ParameterSpec, pointer: str) -> Iterator[Fault]:
    group, _, name = target.to.partition(".")
    if group not in TARGET_GROUPS:
        yield f"{pointer}/to", f'"{target.to}" begins with no known group', nearest(group, TARGET_GROUPS)
    elif not name:
        yield f"{pointer}/to", f'"{target.to}" names nothing', f'write "{group}.NAME"'
    elif group == "haptic" and name in LIMIT_NAMES:
        may = ", ".join(sorted(haptic_targets()))
        what = f'"{name}" is a limit of the haptic loop; no task and no adaptation may change it'
        yield f"{pointer}/to", what, f"set it once in the scene; a parameter may change {may}, and numbers of objects"
    elif group == "haptic" and _range_of_target(name) is None:
        what = f'a task cannot change "{name}" of the haptic scene'
        yield f"{pointer}/to", what, nearest(name, haptic_targets())
    elif group == "audio" and name != GAIN.name:
        yield f"{pointer}/to", f'"{name}" is nothing of the sound that a task can change', f'write "audio.{GAIN.name}"'
    elif group == "task" and name not in task_targets():
        yield f"{pointer}/to", f'"{name}" is nothing a task can change', nearest(name, task_targets())
    words = [entry for entry in target.table or () if isinstance(entry, str)]
    if words and group in ("haptic", "audio", "task"):
        yield f"{pointer}/table", f'"{words[0]}" is a word where a number is needed', "write numbers"
    yield from _check_table(target, parameter, pointer)
    if group == "haptic" and not words:
        yield from _check_reach(target, name, parameter, pointer)


def _check_reach(target: MapSpec, name: str, parameter: ParameterSpec, pointer: str) -> Iterator[Fault]:
    """Check that every value of the parameter gives the target a value within its range."""
    span = _range_of_target(name)
    ends = target.table or [target.offset + target.scale * value for value in (parameter.min, parameter.max)]
    numbers = [float(value) for value in ends]
    if span is not None and not all(span.least <= number <= span.most for number in numbers):
        what = f"sets {name} to {min(numbers):g} to {max(numbers):g}; it must be {span}"
        place = "table" if target.table else "scale"
        yield f"{pointer}/{place}", what, "change the map or the limits of the parameter"


def _check_table(target: MapSpec, parameter: ParameterSpec, pointer: str) -> Iterator[Fault]:
    if target.table is None:
        return
    steps = (parameter.max - parameter.min) / parameter.step if parameter.step > 0.0 else math.nan
    if not target.table:
        yield f"{pointer}/table", "an empty table", "write one entry per step, or leave the table out"
    elif math.isfinite(steps) and len(target.table) != round(steps) + 1:
        what = f"{len(target.table)} entries for {round(steps) + 1} steps from min to max"
        yield f"{pointer}/table", what, "write one entry per step"


def _check_values(values: Mapping[str, float], known: Mapping[str, ParameterSpec], pointer: str) -> Iterator[Fault]:
    for name, value in values.items():
        place = f"{pointer}/{escape(name)}"
        if name not in known:
            hint = nearest(name, known) if known else "the task has no parameters; add them under task/parameters"
            yield place, f'no parameter is called "{name}"', hint
        elif math.isfinite(value) and not known[name].min <= value <= known[name].max:
            yield place, _outside(value, known[name]), "choose a value inside the limits"


def _check_score(score: ScoreSpec, pointer: str) -> Iterator[Fault]:
    parts = {name: score.part(name) for name in ScoreSpec.__struct_fields__}
    for name, part in parts.items():
        if part.best == part.worst:
            yield f"{pointer}/{name}/worst", "is the same as best, so nothing lies between", "set them apart"
    if not sum(part.weight for part in parts.values()) > 0.0:
        yield pointer, "all weights are zero", "give at least one measure a weight"


def _outside(value: float, parameter: ParameterSpec) -> str:
    unit = "" if parameter.unit == "-" else f" {parameter.unit}"
    return f"{value:g}{unit} lies outside {parameter.min:g} to {parameter.max:g}{unit}"
