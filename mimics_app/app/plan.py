"""What a scene needs and by which method: the cheapest one whose measured error is inside the profile's tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from mimics_app.app.rehearsal import rehearse
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.methods import Method, registry
from mimics_app.world.components import LightComponent, Sound, SoundEmitter
from mimics_app.world.components_haptic import Tunnel
from mimics_app.world.scene import Scene

__all__ = ["TOLERANCES", "LeftOut", "Part", "choose", "explain_scene", "measured_groups"]

TOLERANCES: dict[str, dict[str, float]] = {
    "draft": {"m": 1e-4, "rad": 2e-2, "N": 0.5},
    "training": {"m": 1e-6, "rad": 1e-3, "N": 0.05},
    "study": {"m": 1e-8, "rad": 1e-4, "N": 0.001},
}
"""Largest error a profile accepts, by unit of the error."""

_PARTS = {
    "tunnel projection": "closest point of the tunnel's bisector",
    "tunnel frame": "frame carried along the bisector",
    "admittance form": "motion of the virtual mass",
}
"""Groups of the registry that a scene with a tunnel uses, and what for."""

_TICKS = 20_000


@dataclass(frozen=True, slots=True)
class Measured:
    """A method with its figures of this machine: cost [us], error in the method's unit."""

    method: Method
    cost_us: float
    error: float


@dataclass(frozen=True, slots=True)
class Part:
    """One thing a scene runs. `next_cheaper` is the rival that was refused, and its error; None where there is none."""

    part: str
    group: str
    method: str
    cost_us: float
    error: float | None
    unit: str
    tolerance: float | None
    next_cheaper: dict[str, Any] | None


@dataclass(frozen=True, slots=True)
class LeftOut:
    """One thing a scene does not run, why, and what that saves [us per tick or frame]; None: not measured."""

    part: str
    why: str
    saved_us: float | None


def measure(method: Method) -> Measured:
    """Run both probes of a method."""
    return Measured(method, method.cost(), method.error())


def choose(rivals: Sequence[Measured], tolerance: float) -> tuple[Measured, Measured | None]:
    """The cheapest rival inside the tolerance (the most accurate where none is), and the next cheaper one refused."""
    inside = [rival for rival in rivals if rival.error <= tolerance]
    best = min(inside, key=lambda r: r.cost_us) if inside else min(rivals, key=lambda r: r.error)
    cheaper = [rival for rival in rivals if rival.cost_us < best.cost_us]
    return best, max(cheaper, key=lambda r: r.cost_us, default=None)


def measured_groups() -> dict[str, list[dict[str, Any]]]:
    """Every registered method with cost and error on this machine."""
    _register_methods()
    return {
        group: [
            {"method": m.method.name, "cost_us": m.cost_us, "error": m.error, "unit": m.method.unit}
            for m in map(measure, registry.rivals(group))
        ]
        for group in registry.groups()
    }


def explain_scene(scene: Scene, profile: str) -> dict[str, Any]:
    """The object of `mimics explain --json`: what runs, by which method, and what is left out."""
    _register_methods()
    parts = [_tick_part(scene)]
    if scene.components(Tunnel):
        parts += [_method_part(group, TOLERANCES[profile]) for group in _PARTS if group in registry.groups()]
    return {
        "profile": profile,
        "parts": [asdict(part) for part in parts],
        "left_out": [asdict(left) for left in _left_out(scene)],
    }


def _register_methods() -> None:
    """Stages register their methods when their `methods` modules are imported."""
    import mimics_app.rendering.audio.methods
    import mimics_app.rendering.haptic.methods_admittance
    import mimics_app.rendering.haptic.methods_tunnel  # noqa: F401


def _method_part(group: str, tolerances: dict[str, float]) -> Part:
    rivals = [measure(method) for method in registry.rivals(group)]
    tolerance = tolerances[rivals[0].method.unit]
    best, refused = choose(rivals, tolerance)
    next_cheaper = None if refused is None else {"method": refused.method.name, "error": refused.error}
    return Part(
        _PARTS[group], group, best.method.name, best.cost_us, best.error, best.method.unit, tolerance, next_cheaper
    )


def _tick_part(scene: Scene) -> Part:
    """The whole haptic tick of this scene, simulated robot and patient included."""
    rehearsal, clock = rehearse(scene, ticks=2000), MonotonicClock()
    shortest = 1 << 62
    for _ in range(_TICKS // 4000):
        started = clock.now_ns()
        rehearsal.advance(4000)
        shortest = min(shortest, clock.now_ns() - started)
    return Part("haptic tick, all of it", "tick", "one compiled call", shortest / 4000 * 1e-3, None, "", None, None)


def _left_out(scene: Scene) -> list[LeftOut]:
    """Parts of the product this scene does not use."""
    left: list[LeftOut] = []
    if not scene.components(Sound):
        left.append(LeftOut("sound process", "no entity has a sound", None))
    if not scene.components(SoundEmitter):
        left.append(LeftOut("sound emitters", "no entity has a sound_emitter", None))
    if not any(light.casts_shadow for _, light, _ in scene.components(LightComponent)):
        left.append(LeftOut("shadow pass", "no light casts a shadow", None))
    tunnel = scene.components(Tunnel)
    if not tunnel:
        left.append(LeftOut("tunnel force", "no entity has a tunnel", None))
    left.append(LeftOut("rigid bodies", "nothing but the ball moves", 0.0))
    left.append(LeftOut("body signals, estimation, learning", "no recorder of body signals is in the scene", 0.0))
    return left
