"""Plays the wavy tunnel with the simulated patient through the real loop and task manager, without processes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

import mimics_app as mimics
from mimics_app.app.api.unit_array import Table
from mimics_app.contracts.system.resources import root
from mimics_app.tasks.scene_section import task_of

SCENE = root() / "scenes" / "wavy_tunnel.json"
LONGEST_S = 240.0


@dataclass(frozen=True)
class Travel:
    """One patient, one seed.

    Attributes:
        rows: Trial rows.
        samples: Columns of every tick.
    """

    rows: list[dict[str, Any]]
    samples: Table


def travel(preset: str, seed: int, *, intent: bool = True, seconds: float = LONGEST_S, scene: Path = SCENE) -> Travel:
    """One trial of the tunnel (the last of the list, at normal width)."""
    with mimics.open(scene, seed=seed, record="memory") as session:
        last = task_of(session.scene).trials[-1]
        if "task" in session.scene.sections:
            session.edit("task", trials=[msgspec.structs.replace(last, trials=[last.trials[0]])])
        session.edit("patient", preset=preset, intent=intent)
        session.step_until(lambda s: s.done, seconds)
        return Travel(session.trials, session.haptic)
