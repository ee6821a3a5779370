"""Card of an earlier session in the launcher; it opens the page of its results."""

from __future__ import annotations

from mimics_app.app.scenes.shipped import find_shipped, thumbnail_of
from mimics_app.contracts.errors import counted
from mimics_app.recording.history import EarlierRun, local_time
from mimics_app.rendering.haptic.devices.device_names import SIMULATED, load_built_in
from mimics_app.rendering.visual.launcher.launcher import ScenarioCard

__all__ = ["recent_card"]


def recent_card(run: EarlierRun) -> ScenarioCard | None:
    """Return the card of a session; None where its scene is not a shipped one."""
    scene = find_shipped(run.scene)
    if scene is None:
        return None
    return ScenarioCard(
        title=scene.title,
        description=_how_it_went(run),
        picture=thumbnail_of(scene.name),
        scene=scene.file,
        group="Recent",
        facts=" · ".join(part for part in (local_time(run.utc), _who(run)) if part),
        badge="" if run.score is None else f"{run.score:.0f} of 100",
        everywhere=False,
        run=run.folder,
    )


def _how_it_went(run: EarlierRun) -> str:
    if run.cut_off:
        return "Cut off: its recording was not closed."
    if not run.trials:
        practised = f"Practice only: {counted(run.practised, 'trials')}." if run.practised else ""
        return practised or "Broken off before a trial came to its end."
    mean = "mean time" if run.trials > 1 else "time"
    words = [f"{run.completed} of {counted(run.trials, 'trials')} finished"]
    words += [f"{mean} {run.time_s:.1f} s"] if run.time_s is not None else []
    return ", ".join(words) + "."


def _who(run: EarlierRun) -> str:
    return run.participant or (load_built_in(SIMULATED).caption if run.simulated else "")
