"""What a scene runs and by which methods, with their cost and error; what it leaves out because it needs it not."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.rehearsal import rehearse
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.kernel import cache_folder
from mimics_app.contracts.methods import registry
from mimics_app.world.components import LightComponent, Sound, SoundEmitter
from mimics_app.world.components_haptic import Admittance, Tunnel
from mimics_app.world.components_systems import AudioSettings, HapticSettings
from mimics_app.world.scene import Scene

__all__ = ["TOLERANCES", "Figures", "choose", "explain_scene", "measure_groups", "save_figures", "saved_plan"]

_DELAY = "us of interaural delay"

TOLERANCES: dict[str, dict[str, float]] = {
    "draft": {"m": 1e-3, "rad": 2e-2, "N": 0.5, _DELAY: 700.0},
    "training": {"m": 1e-6, "rad": 1e-3, "N": 0.05, _DELAY: 40.0},
    "study": {"m": 1e-8, "rad": 1e-4, "N": 0.001, _DELAY: 30.0},
}
"""Largest error a profile accepts, by unit of the error."""

_FIGURES = "methods.json"
_TICKS = 4000
_REPEATS = 5


@dataclass(frozen=True, slots=True)
class Figures:
    """One method's figures on this machine: cost [us per call], error in `unit`."""

    method: str
    cost_us: float
    error: float
    unit: str


Groups = dict[str, list[Figures]]


@dataclass(frozen=True, slots=True)
class _Use:
    """What a group of methods is for: in words, the component a scene needs it for, and the method the scene names."""

    what: str
    needs: type[msgspec.Struct]
    named: Callable[[Scene], str]


def _named_projection(scene: Scene) -> str:
    haptic = scene.systems.get("haptic")
    return haptic.projection if isinstance(haptic, HapticSettings) else HapticSettings().projection


def _named_form(scene: Scene) -> str:
    found = scene.components(Admittance)
    return found[0][1].form if found else Admittance().form


def _named_spatialiser(scene: Scene) -> str:
    audio = scene.systems.get("audio")
    hrtf = audio.hrtf if isinstance(audio, AudioSettings) else AudioSettings().hrtf
    return "hrtf" if hrtf else "stereo"


_USES = {
    "tunnel projection": _Use("closest point of the tunnel's bisector", Tunnel, _named_projection),
    "tunnel frame": _Use("frame carried along the bisector", Tunnel, lambda _: "double reflection"),
    "admittance form": _Use("motion of the virtual mass", Tunnel, _named_form),
    "spatialiser": _Use("direction of sounds", Sound, _named_spatialiser),
}
"""Groups of the registry and what a scene uses them for."""


@dataclass(frozen=True, slots=True)
class Part:
    """One thing a scene runs.

    Attributes:
        part: What it is for.
        group: Of the registry.
        method: The one that runs.
        cost_us: [us per call].
        error: In `unit`; None where it has none.
        unit: Of error and tolerance.
        tolerance: What the profile accepts.
        next_cheaper: The nearest cheaper rival outside the tolerance, {"method", "error"}; None where there is none.
        planner: What the planner would take, where the scene names another; else "".
    """

    part: str
    group: str
    method: str
    cost_us: float
    error: float | None
    unit: str
    tolerance: float | None
    next_cheaper: dict[str, Any] | None
    planner: str = ""


@dataclass(frozen=True, slots=True)
class LeftOut:
    """One thing a scene does not run, why, and what that saves [us per tick or frame]; None: not measured."""

    part: str
    why: str
    saved_us: float | None


def choose(rivals: Sequence[Figures], tolerance: float) -> tuple[Figures, Figures | None]:
    """The cheapest rival inside the tolerance, and the next cheaper one that is outside.

    Where none is inside, the most accurate.
    """
    inside = [rival for rival in rivals if rival.error <= tolerance]
    best = min(inside, key=lambda r: r.cost_us) if inside else min(rivals, key=lambda r: r.error)
    return best, _next_cheaper(rivals, best, tolerance)


def _next_cheaper(rivals: Sequence[Figures], taken: Figures, tolerance: float) -> Figures | None:
    refused = [r for r in rivals if r.cost_us < taken.cost_us and r.error > tolerance]
    return max(refused, key=lambda r: r.cost_us, default=None)


def measure_groups(*, sound: bool = True) -> Groups:
    """Every registered method with cost and error, measured now; without `sound` that stage is not imported."""
    import mimics_app.rendering.haptic.methods_admittance
    import mimics_app.rendering.haptic.methods_tunnel

    if sound:
        import mimics_app.rendering.audio.methods  # noqa: F401
    return {
        group: [Figures(m.name, m.cost(), m.error(), m.unit) for m in registry.rivals(group)]
        for group in registry.groups()
    }


def explain_scene(scene: Scene, profile: str) -> dict[str, Any]:
    """The object of `mimics explain --json`: what runs, by which method, measured now, and what is left out."""
    groups = measure_groups(sound=bool(scene.components(Sound)))
    return _plan(scene, profile, groups, [_tick_part(scene)])


def save_figures() -> Path | None:
    """Measure every method and keep the figures beside the compiled kernels; None where nothing can be kept."""
    if cache_folder is None:
        return None
    file = cache_folder / _FIGURES
    rows = {group: [asdict(figures) for figures in rivals] for group, rivals in measure_groups().items()}
    file.write_text(json.dumps(rows), encoding="utf-8")
    return file


def saved_plan(scene: Scene, profile: str) -> dict[str, Any]:
    """The plan by the figures that `mimics warmup` saved for these kernels; {} where there are none."""
    if cache_folder is None or not (cache_folder / _FIGURES).is_file():
        return {}
    saved = json.loads((cache_folder / _FIGURES).read_text(encoding="utf-8"))
    groups = {group: [Figures(**row) for row in rows] for group, rows in saved.items()}
    return _plan(scene, profile, groups, [])


def _plan(scene: Scene, profile: str, groups: Groups, parts: list[Part]) -> dict[str, Any]:
    for group, rivals in groups.items():
        if group in _USES and scene.components(_USES[group].needs):
            parts.append(_method_part(scene, group, rivals, TOLERANCES[profile]))
    return {
        "profile": profile,
        "parts": [asdict(part) for part in parts],
        "left_out": [asdict(left) for left in _left_out(scene)],
    }


def _method_part(scene: Scene, group: str, rivals: list[Figures], tolerances: Mapping[str, float]) -> Part:
    """The method that runs, beside what the planner would take."""
    use = _USES[group]
    tolerance = tolerances[rivals[0].unit]
    best, _ = choose(rivals, tolerance)
    runs = next(rival for rival in rivals if rival.method == use.named(scene))
    refused = _next_cheaper(rivals, runs, tolerance)
    return Part(
        part=use.what,
        group=group,
        method=runs.method,
        cost_us=runs.cost_us,
        error=runs.error,
        unit=runs.unit,
        tolerance=tolerance,
        next_cheaper=None if refused is None else {"method": refused.method, "error": refused.error},
        planner="" if best.method == runs.method else best.method,
    )


def _tick_part(scene: Scene) -> Part:
    """The whole haptic tick of this scene, simulated robot and patient included."""
    rehearsal, clock = rehearse(scene, ticks=_TICKS), MonotonicClock()
    shortest = 1 << 62
    for _ in range(_REPEATS):
        started = clock.now_ns()
        rehearsal.advance(_TICKS)
        shortest = min(shortest, clock.now_ns() - started)
    return Part("haptic tick, all of it", "tick", "one compiled call", shortest / _TICKS * 1e-3, None, "", None, None)


def _left_out(scene: Scene) -> list[LeftOut]:
    """Parts of the product this scene does not use."""
    absent: list[tuple[type[msgspec.Struct], str, str]] = [
        (Sound, "sound process", "no entity has a sound"),
        (SoundEmitter, "sound emitters", "no entity has a sound_emitter"),
        (Tunnel, "tunnel force", "no entity has a tunnel"),
    ]
    left = [LeftOut(part, why, None) for component, part, why in absent if not scene.components(component)]
    if not any(light.casts_shadow for _, light, _ in scene.components(LightComponent)):
        left.append(LeftOut("shadow pass", "no light casts a shadow", None))
    left.append(LeftOut("rigid bodies", "nothing but the ball moves", None))
    left.append(LeftOut("body signals, estimation, learning", "no recorder of body signals is in the scene", None))
    return left
