"""What a run came to, under the keys that scripts rely on."""

from __future__ import annotations

from typing import Any

from mimics_app.app.play.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.contracts.audio_port import AudioReport

__all__ = ["summarise"]


def summarise(session: Session, frames: Frames, sound: AudioReport | None, wall_s: float) -> dict[str, Any]:
    """Everything of the `mimics run --json` object that is known before the recording is sealed; the loop has ended."""
    late = session.haptics.histogram()
    frames.safety.see(session.haptics.events())
    return {
        "seed": session.settings.seed,
        "simulated_s": late.ticks / 1000.0,
        "wall_s": wall_s,
        "ticks": late.ticks,
        "frames": frames.number,
        "scene_hash": session.scene.hash,
        "run_dir": str(session.folder),
        "task": session.tasks.result(),
        "safety": frames.safety.summary(session.haptics.snapshot().state, late),
        "lateness_us": {"p50": late.p50, "p99": late.p99, "p99_9": late.p99_9, "max": late.max},
        "lateness": late.as_dict(),
        "stability": session.haptics.stability().as_dict(),
        "losses": frames.losses.summary(),
        "missed": late.missed,
        **({} if session.governor is None else {"governor": session.governor.summary()}),
        "recipe": late.recipe,
        "audio": {"device": "none", "sink": "off"} if sound is None else sound.summary(),
        "unread": _unread(session),
    }


_READ = frozenset(
    "admittance ball billboard camera connections environment force_field grasping_hand haptic_effect haptic_object "
    "haptic_path haptic_walls hud impedance interaction_points joint_pd light mesh particles patient projector robot "
    "safety sound sound_emitter tunnel tunnel_view world_pd".split()
)
"""Component types that a run makes use of."""


def _unread(session: Session) -> list[str]:
    """Component types of the scene that nothing in this run looked at."""
    return sorted({name for entity in session.scene.entities for name in entity.components} - _READ)
