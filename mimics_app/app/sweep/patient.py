"""Sweep experiment: a simulated patient plays a trial of a scene with the haptic loop and the task manager.

Every point is one trial, the last one of the scene's list, on the virtual clock, without processes, picture and sound.
The loop is imported when the first trial is played, so that a list of experiments does not wait for it.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.settings import PATIENTS, PROFILES, Profile, RunSettings
from mimics_app.contracts.clock import FRAMES_PER_SECOND
from mimics_app.contracts.errors import Issue, MimicsError, nearest
from mimics_app.contracts.messages.stage_messages import TaskAction
from mimics_app.lab.sweep.quantity import Columns, Quantity, SweepExperiment
from mimics_app.learning.action_sequence import ActionSequence, TimedAction
from mimics_app.tasks.actions import build_action_space
from mimics_app.tasks.task import MEASURES, TaskSpec
from mimics_app.tasks.trial_specs import BlockSpec
from mimics_app.world.files.scene.scene import Scene

__all__ = ["EXPERIMENT", "travel"]

_ACTION = "action."


@lru_cache(maxsize=8)
def _load(file: Path) -> Scene:
    return load_checked_scene(file)


def _scene_file(name: str, folder: Path) -> Path:
    """Return a scene file beside the sweep file, else the one that every command finds by the name."""
    beside = folder / name
    return beside.resolve() if os.path.isfile(beside) else find_scene(Path(name))


def _last_trial(task: TaskSpec) -> TaskSpec:
    """Return a task, whose trial file has been read, with its last trial alone."""
    blocks = [block for block in task.trials if isinstance(block, BlockSpec)]
    if not blocks:
        return task
    return msgspec.structs.replace(task, trials=[msgspec.structs.replace(blocks[-1], trials=blocks[-1].trials[-1:])])


def travel(
    scene: Scene, preset: str, seed: int, action: Mapping[str, float], *, profile: Profile, seconds: float
) -> dict[str, Any]:
    """Let a simulated patient play one trial of a scene.

    Args:
        scene: The checked scene.
        preset: Preset of the patient; "" keeps the scene's.
        seed: Seed of patient, sensor noise and trial order.
        action: Values of the task's parameters from the beginning of the trial on.
        profile: Profile whose tolerances hold.
        seconds: Longest simulated time [s].

    Returns:
        The row of the trial: `outcome`, `time_s`, `path_error_rms_m`, `contacts`, `smoothness`, `score` ...; {} where
        it did not end in time.
    """
    from mimics_app.app.session.body import Body
    from mimics_app.app.session.core import open_core
    from mimics_app.app.session.frame import Frames
    from mimics_app.app.session.preparation import prepare_scene

    settings = RunSettings(scene.path, seed=seed, profile=profile, patient=preset)
    chosen = [TimedAction(0.0, TaskAction(dict(action), at_trial=0))] if action else []
    parts = prepare_scene(scene, settings)
    with open_core(replace(parts, task=_last_trial(parts.task), body=Body(learning=ActionSequence(chosen)))) as core:
        frames = Frames(core)
        for _ in range(round(seconds * FRAMES_PER_SECOND)):
            if frames.advance_frame().finished:
                break
        rows = core.tasks.rows
    return dict(rows[-1]) if rows else {}


def _run(values: Columns, folder: Path) -> Columns:
    names = [name for name in values if name.startswith(_ACTION)]
    columns: dict[str, list[Any]] = {name: [] for name in EXPERIMENT.results}
    for i in range(len(values["scene"])):
        row = travel(
            _load(_scene_file(values["scene"][i], folder)),
            values["preset"][i],
            values["seed"][i],
            {name.removeprefix(_ACTION): values[name][i] for name in names},
            profile=values["profile"][i],
            seconds=values["seconds"][i],
        )
        for name, value in _results(row).items():
            columns[name].append(value)
    return columns


def _results(row: Mapping[str, Any]) -> dict[str, Any]:
    measured = {measure.total or measure.column: row.get(measure.column) for measure in MEASURES}
    return {"outcome": str(row.get("outcome", "unfinished")), "score": row.get("score"), **measured}


def _check(values: Columns, file: Path) -> tuple[list[Issue], str]:
    """Check every scene and its actions; return the faults, and the digest of the scenes."""
    issues, digest = list[Issue](), hashlib.sha256()
    for i, name in enumerate(values["scene"]):
        try:
            scene = _load(_scene_file(name, file.parent))
        except MimicsError as error:
            issues.append(Issue(str(file), f"/parameters/scene/{i}", f'"{name}" cannot be played: {error}'))
            continue
        digest.update(scene.hash.encode())
        issues += _action_faults(scene, values, str(file))
    return issues, digest.hexdigest()


def _action_faults(scene: Scene, values: Columns, file: str) -> list[Issue]:
    from mimics_app.app.session.preparation import prepare_scene

    parts = prepare_scene(scene, RunSettings(scene.path))
    parts.plugin.close()
    space = build_action_space(parts.task)
    issues = []
    for name in (name for name in values if name.startswith(_ACTION)):
        pointer, key = f"/parameters/{name}", name.removeprefix(_ACTION)
        if key not in space:
            issues.append(Issue(file, pointer, f'the task of "{scene.name}" has no "{key}"', nearest(key, space.names)))
            continue
        parameter = space[key]
        issues += [
            Issue(file, pointer, f"{value:g} is outside {parameter.low:g} to {parameter.high:g} {parameter.unit}")
            for value in values[name]
            if not parameter.fits(value)
        ]
    return issues


EXPERIMENT = SweepExperiment(
    name="patient",
    what="one trial of a scene by a simulated patient, through the real loop and task manager",
    parameters={
        "scene": Quantity("text", "", "scenes/wavy_tunnel.json"),
        "preset": Quantity("text", "", "", choices=("", *PATIENTS)),
        "seed": Quantity("int", "", 1, 0, 2**31 - 1),
        "profile": Quantity("text", "", "training", choices=PROFILES),
        "seconds": Quantity("float", "s", 240.0, 1.0, 3600.0),
    },
    results={
        "outcome": "text",
        "score": "float",
        **{measure.total or measure.column: "int" if measure.sums else "float" for measure in MEASURES},
    },
    chunk=1,
    run=_run,
    open_prefix=_ACTION,
    check=_check,
)
