"""What a scene uses groups of methods for, and which methods it names itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import msgspec

from mimics_app.world.components.robot import Admittance, Tunnel
from mimics_app.world.components.systems import AudioSettings, HapticSettings, VisualSettings
from mimics_app.world.components.visible import CameraComponent, LightComponent, MeshComponent, Sound
from mimics_app.world.scene.scene import Scene
from mimics_app.world.scene.spread import ENOUGH, spread_of_casters

__all__ = ["USES", "Use", "shadow_distance_of", "visual_of"]


def _anything(scene: Scene, method: str) -> bool:
    return True


def _nothing_named(scene: Scene) -> str:
    return ""


@dataclass(frozen=True, slots=True)
class Use:
    """What a scene uses a group of methods for.

    Attributes:
        what: In words.
        used: Whether a scene has a use for it.
        named: The method a scene names; "" where it leaves the choice to the planner.
        allowed: Whether a method is one the planner may take for a scene that names none.
        pixels: Of the frame its costs were measured at [px], where they grow with the picture and are borne by the
            frame's budget; 0 where they are not.
    """

    what: str
    used: Callable[[Scene], bool]
    named: Callable[[Scene], str] = _nothing_named
    allowed: Callable[[Scene, str], bool] = _anything
    pixels: int = 0


def visual_of(scene: Scene) -> VisualSettings:
    """What the scene says of its picture; what it leaves out is as in a scene that says nothing."""
    wanted = scene.systems.get("visual")
    return wanted if isinstance(wanted, VisualSettings) else VisualSettings()


_ONE_MAP = 8.0
"""Spread of bodies up to which one map holds them all [m]: of 2,048 texels each is 8 mm wide, a pixel of 720 rows 7 m
away."""


def shadow_distance_of(scene: Scene) -> float:
    """How far from the eyes the sun's shadows are seen, in cascades [m]; 0: everywhere, in one map.

    What `systems.visual.shadow_distance` says; of a scene that leaves it open one map where that is enough, else the
    way across its bodies, but 100 m at most: beyond, the shadow of a person's height is a dozen pixels high.
    """
    stated = visual_of(scene).shadow_distance
    if stated != "auto":
        return stated
    spread = spread_of_casters(scene)
    return 0.0 if spread <= _ONE_MAP else 2.0 * min(spread, ENOUGH)


def _has(kind: type[msgspec.Struct]) -> Callable[[Scene], bool]:
    return lambda scene: scene.has(kind)


def _named_projection(scene: Scene) -> str:
    haptic = scene.systems.get("haptic")
    return haptic.projection if isinstance(haptic, HapticSettings) and haptic.projection != "auto" else ""


def _named_form(scene: Scene) -> str:
    found = scene.components(Admittance)
    return found[0][1].form if found else Admittance().form


def _named_spatialiser(scene: Scene) -> str:
    audio = scene.systems.get("audio")
    if not isinstance(audio, AudioSettings) or audio.hrtf == "auto":
        return ""
    return "hrtf" if audio.hrtf else "stereo"


def _has_sun_shadow(scene: Scene) -> bool:
    if visual_of(scene).shadow_size == 0:
        return False
    lights = (light for _, light, _ in scene.components(LightComponent))
    return any(light.casts_shadow and light.kind == "directional" for light in lights)


def _named_shadows(scene: Scene) -> str:
    visual = visual_of(scene)
    if visual.shadows.startswith("stencil"):
        return visual.shadows.replace("_", " ")
    if visual.shadow_size == "auto":
        return ""
    return f"{'cascades' if shadow_distance_of(scene) else 'map'} {visual.shadow_size}"


def _may_shadow(scene: Scene, method: str) -> bool:
    """A distance asks for cascades, a named kind for maps. Darkening the picture is a look: never chosen for speed."""
    visual, kind = visual_of(scene), method.split()[0]
    if shadow_distance_of(scene):
        return kind == "cascades"
    return kind == "map" or (visual.shadows == "auto" and method == "stencil additive")


def _named_edges(scene: Scene) -> str:
    visual = visual_of(scene)
    if visual.anti_aliasing in ("none", "filter"):
        return str(visual.anti_aliasing)
    if visual.anti_aliasing == "auto" and visual.samples == "auto":
        return ""
    samples = 4 if visual.samples == "auto" else visual.samples
    words = [f"{samples} samples"] if samples else []
    words += ["filter"] if visual.anti_aliasing == "both" else []
    return ", ".join(words) or "none"


def _shows_models(scene: Scene) -> bool:
    return any(mesh.source for _, mesh, _ in scene.components(MeshComponent))


_PROBE_PX = 640 * 360
"""Picture in which the methods of `lab.visual` are measured [px]."""

USES: Mapping[str, Use] = {
    "tunnel projection": Use("closest point of the tunnel's bisector", _has(Tunnel), _named_projection),
    "tunnel frame": Use("frame carried along the bisector", _has(Tunnel), lambda _: "double reflection"),
    "admittance form": Use("motion of the virtual mass", _has(Tunnel), _named_form),
    "spatialiser": Use("direction of sounds", _has(Sound), _named_spatialiser),
    "occlusion": Use("bodies hidden behind others", _shows_models),
    "level of detail": Use("coarser forms of far bodies", _shows_models),
    "sun shadows": Use("shadows of the sun", _has_sun_shadow, _named_shadows, _may_shadow, _PROBE_PX),
    "anti aliasing": Use("smooth edges", _has(CameraComponent), _named_edges, pixels=_PROBE_PX),
    "ambient occlusion": Use(
        "darker corners", lambda scene: visual_of(scene).ambient_occlusion > 0.0, pixels=_PROBE_PX
    ),
    "bloom": Use("glow", lambda scene: visual_of(scene).bloom > 0.0, pixels=_PROBE_PX),
}
"""Groups the planner knows, by name; those that share the frame's budget from what is missed most to what least.

A method named for every scene alike is one the compiled tick has no rival of.
"""
