"""Result of a run, under the documented keys of `mimics run --json`."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from mimics_app.app.session.core import SessionCore
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.contracts.ports.audio_port import AudioReport
from mimics_app.rendering.haptic.histogram import LatenessReport

__all__ = ["summarise", "summarise_play"]


def summarise(session: Session, frames: Frames, sound: AudioReport | None, wall_s: float) -> dict[str, Any]:
    """Return the part of the object of `mimics run --json` that is known before the recording is closed."""
    return {
        "seed": session.settings.seed,
        **summarise_play(session, frames, wall_s),
        "run_dir": str(session.folder),
        **({} if session.governor is None else {"governor": session.governor.summary()}),
        "audio": {"device": "none", "sink": "off"} if sound is None else sound.summary(),
    }


def summarise_play(session: SessionCore, frames: Frames, wall_s: float) -> dict[str, Any]:
    """Return the part of it that a session without recorder, sound and picture has, too."""
    late = session.haptics.histogram()
    stability = session.haptics.stability()
    frames.safety.see(session.haptics.events())
    return {
        "simulated_s": late.ticks / 1000.0,
        "wall_s": wall_s,
        "ticks": late.ticks,
        "frames": frames.number,
        "scene_hash": session.scene.hash,
        "task": session.tasks.result(),
        "device_life": str(session.haptics.life),
        "safety": frames.safety.summary(session.haptics.snapshot().state, late),
        **(_punctuality(late) if session.live else {}),  # on a virtual clock no tick can be late
        **({} if (link := session.haptics.link()) is None else {"link": asdict(link)}),
        "stability": stability.as_dict() | {"contacts": stability.contacts(session.side.shape_entities)},
        "losses": frames.losses.summary(),
        "recipe": late.recipe,
        "unread": session.scene.unread,
    }


def _punctuality(late: LatenessReport) -> dict[str, Any]:
    return {
        "lateness_us": {"p50": late.p50, "p99": late.p99, "p99_9": late.p99_9, "max": late.max},
        "lateness": late.as_dict(),
        "missed": late.missed,
    }
