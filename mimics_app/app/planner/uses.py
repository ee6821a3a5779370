"""Use of groups of methods by a scene, and the methods that the scene names itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

import msgspec

from mimics_app.contracts.methods import Settings
from mimics_app.world.components.animation import Animation, Avatar
from mimics_app.world.components.haptic_shapes import TouchSurface, surface_of
from mimics_app.world.components.objects import HapticObject, HapticWalls, InteractionPoints
from mimics_app.world.components.robot import Admittance, Robot, Tunnel
from mimics_app.world.components.systems import (
    AudioSettings,
    DisplaySettings,
    HapticSettings,
    Tolerances,
    VisualSettings,
)
from mimics_app.world.components.visible import CameraComponent, LightComponent, MeshComponent, Sound
from mimics_app.world.scene.method_plugins import Use, method_plugins
from mimics_app.world.scene.scene import Scene
from mimics_app.world.scene.spread import ENOUGH, spread_of_casters

__all__ = [
    "BODIES",
    "NOT_PLANNED",
    "TOUCH",
    "USES",
    "WHOLE_TICK",
    "Use",
    "audio_of",
    "grips",
    "points_of",
    "shadow_distance_of",
    "touched_shape",
    "uses",
    "visual_of",
]


def visual_of(scene: Scene) -> VisualSettings:
    """Return the scene's settings of the picture, defaults filled in."""
    return scene.system(VisualSettings) or VisualSettings()


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


def _can_be_touched(scene: Scene) -> bool:
    return scene.has(HapticObject) or scene.has(HapticWalls)


def _has(kind: type[msgspec.Struct]) -> Callable[[Scene], bool]:
    return lambda scene: scene.has(kind)


def _unless_auto(name: str, stated: Callable[[Scene], str]) -> Callable[[Scene], Settings | None]:
    """Return a scene's setting of a method by its registered name; None where the planner chooses."""

    def named(scene: Scene) -> Settings | None:
        return None if stated(scene) == "auto" else {name: stated(scene)}

    return named


def _uses_admittance(scene: Scene) -> bool:
    """Whether there is a robot; one that takes forces instead has no virtual mass, which its driver reports later."""
    return scene.has(Admittance) or scene.has(Robot)


def _may_run_form(scene: Scene, settings: Settings) -> bool:
    """The printed form invents a force on whatever moves and turns: a scene has to request it."""
    return settings.get("form") != "seed"


S = TypeVar("S", bound=msgspec.Struct)


def _all(scene: Scene, kind: type[S]) -> list[S]:
    """Return components of a type without marking them as used."""
    return [one for entity in scene.entities for one in entity.components.values() if isinstance(one, kind)]


def points_of(scene: Scene) -> int:
    """How many points of the hand touch."""
    return sum(len(one.points) for one in _all(scene, InteractionPoints)) or 1


def grips(scene: Scene) -> bool:
    """Whether fingers can hold something."""
    return any(thing.grip for thing in _all(scene, HapticObject))


def touched_shape(scene: Scene) -> str:
    """The scene's word for the first shape that can be touched: what touching is recognised by."""
    for thing in _all(scene, HapticObject):
        if thing.shapes:
            return str(thing.shapes[0].__struct_config__.tag)
    return "cube"


def _surfaces(scene: Scene) -> list[TouchSurface]:
    """Return the material of each touchable surface, defaults filled in."""
    found = [surface_of(walls) for walls in _all(scene, HapticWalls)]
    for thing in _all(scene, HapticObject):
        found += [surface_of(solid, thing) for solid in thing.shapes] or [surface_of(thing)]
    return found


def _named_law(scene: Scene) -> Settings | None:
    """The law is how a surface is to feel, and stands in the scene; of several the first's."""
    first = _surfaces(scene)[0]
    return {"law": first.law} | ({"exponent": first.exponent} if first.law == "hunt_crossley" else {})


def _has_friction(scene: Scene) -> bool:
    return any(surface.friction_static for surface in _surfaces(scene))


def _moving(scene: Scene) -> list[HapticObject]:
    return [thing for thing in _all(scene, HapticObject) if thing.enable_translation or thing.enable_rotation]


def _named_integrator(scene: Scene) -> Settings | None:
    stated = [thing.integrator for thing in _moving(scene) if thing.integrator != "auto"]
    return {"integrator": stated[0]} if len(stated) == len(_moving(scene)) else None


def _named_rest(scene: Scene) -> Settings:
    return {"sleeps": all(thing.sleeps for thing in _moving(scene))}


_TICK_S = 1e-3


def _may_integrate(scene: Scene, settings: Settings) -> bool:
    """Integrators that move a body by its old velocity too keep a contact only with b > k h (chart "integrator")."""
    if settings.get("integrator") == "semi_implicit":
        return True
    return all(
        surface.law == "spring_damper" and (surface.damping or 0.0) > (surface.stiffness or 0.0) * _TICK_S
        for surface in _surfaces(scene)
    )


def audio_of(scene: Scene) -> AudioSettings:
    """Return the scene's settings of sound, defaults filled in."""
    return scene.system(AudioSettings) or AudioSettings()


def _named_spatialiser(scene: Scene) -> Settings | None:
    audio = audio_of(scene)
    if audio.hrtf == "auto" or audio.mixer == "auto":
        return None
    return {"hrtf": audio.hrtf, "mixer": audio.mixer}


_WHOLE_SAMPLES_US = 23.0
"""What a delay between the ears is off where it is of whole samples, as OpenAL's; who needs less states a tolerance."""


def _may_spatialise(scene: Scene, settings: Settings) -> bool:
    """What the scene says of one of the two holds, and the spectral mixer is named or needed.

    It is the cheaper and the more exact one, but takes 2.3 s longer to start (decision 200), which no cost here says.
    """
    audio, itd_us = audio_of(scene), (scene.system(Tolerances) or Tolerances()).itd_us
    only_spectral = audio.sofa is not None or (audio.hrtf is False and audio.speakers != "stereo")
    exact = only_spectral or audio.mixer == "spectral" or (itd_us is not None and itd_us < _WHOLE_SAMPLES_US)
    return (
        (audio.hrtf == "auto" or settings.get("hrtf") == audio.hrtf)
        and (audio.mixer == "auto" or settings.get("mixer") == audio.mixer)
        and (settings.get("mixer") == "spectral") <= exact
        and (not only_spectral or settings.get("mixer") == "spectral")
    )


def _has_sun_shadow(scene: Scene) -> bool:
    if visual_of(scene).shadow_size == 0:
        return False
    lights = (light for _, light, _ in scene.components(LightComponent))
    return any(light.casts_shadow and light.kind == "directional" for light in lights)


_VOLUMES = ("stencil_additive", "stencil_modulative")
"""Kinds of shadow without a map."""


def _named_shadows(scene: Scene) -> Settings | None:
    visual = visual_of(scene)
    if visual.shadows in _VOLUMES:
        return {"shadows": visual.shadows}
    if visual.shadow_size == "auto":
        return None
    return {"cascaded": shadow_distance_of(scene) > 0.0, "shadow_size": visual.shadow_size}


def _may_shadow(scene: Scene, settings: Settings) -> bool:
    """A distance means cascades, a named kind for maps. Darkening the picture is a look: never chosen for speed."""
    if "cascaded" in settings:
        return settings["cascaded"] == (shadow_distance_of(scene) > 0.0)
    may_be_volumes = shadow_distance_of(scene) == 0.0 and visual_of(scene).shadows == "auto"
    return may_be_volumes and settings.get("shadows") == "stencil_additive"


def _named_edges(scene: Scene) -> Settings | None:
    visual = visual_of(scene)
    if visual.anti_aliasing in ("none", "filter"):
        return {"msaa": 0, "fxaa": visual.anti_aliasing == "filter"}
    if visual.anti_aliasing == "auto" and visual.samples == "auto":
        return None
    return {"msaa": 4 if visual.samples == "auto" else visual.samples, "fxaa": visual.anti_aliasing == "both"}


def _bends(scene: Scene) -> bool:
    return scene.has(Animation) or scene.has(Avatar)


_ONE_EYE = ("desktop", "wall", "cave")
"""Kinds of display for one eye, and those whose file says for how many."""


def _display_of(scene: Scene) -> DisplaySettings:
    return scene.system(DisplaySettings) or DisplaySettings()


def _for_two_eyes(scene: Scene) -> bool:
    display = _display_of(scene)
    return display.kind not in _ONE_EYE or display.passes != "auto"


def _shows_models(scene: Scene) -> bool:
    return any(mesh.source for _, mesh, _ in scene.components(MeshComponent))


_PROBE_PX = 640 * 360
"""Picture in which the methods of `lab.visual` are measured [px]."""

WHOLE_TICK, TOUCH, BODIES = "haptic tick", "touching a shape", "bodies, at rest"
"""Parts of `explain` that hold others."""

USES: Mapping[str, Use] = {
    "tunnel projection": Use(
        "closest point of the tunnel's bisector",
        _has(Tunnel),
        _unless_auto("projection", lambda scene: (scene.system(HapticSettings) or HapticSettings()).projection),
        within=WHOLE_TICK,
    ),
    "tunnel frame": Use("frame carried along the bisector", _has(Tunnel), within=WHOLE_TICK),
    "admittance form": Use(
        "motion of the virtual mass",
        _uses_admittance,
        _unless_auto("form", lambda scene: (scene.first(Admittance) or Admittance()).form),
        _may_run_form,
        within=WHOLE_TICK,
    ),
    "contact law": Use("force of a contact", _can_be_touched, _named_law, within=TOUCH),
    "friction": Use("friction of a contact", _has_friction, within=TOUCH),
    "colliding bodies": Use(
        "bodies that move and collide",
        lambda scene: bool(_moving(scene)),
        _named_integrator,
        _may_integrate,
        within=BODIES,
    ),
    "rotation update": Use(
        "turning of bodies", lambda scene: any(thing.enable_rotation for thing in _moving(scene)), within=BODIES
    ),
    "resting bodies": Use(BODIES, lambda scene: bool(_moving(scene)), _named_rest, count=lambda s: len(_moving(s))),
    "spatialiser": Use("direction of sounds", _has(Sound), _named_spatialiser, _may_spatialise),
    "occlusion": Use("bodies hidden behind others", _shows_models),
    "level of detail": Use("coarser forms of far bodies", _shows_models),
    "skinning": Use(
        "bodies that follow joints", _bends, _unless_auto("skinning", lambda scene: visual_of(scene).skinning)
    ),
    "shading": Use(
        "light on surfaces", _has(CameraComponent), _unless_auto("shading", lambda scene: visual_of(scene).shading)
    ),
    "stereo": Use(
        "the two eyes before a picture", _for_two_eyes, _unless_auto("stereo", lambda scene: _display_of(scene).passes)
    ),
    "sun shadows": Use("shadows of the sun", _has_sun_shadow, _named_shadows, _may_shadow, _PROBE_PX),
    "anti aliasing": Use("anti-aliasing", _has(CameraComponent), _named_edges, pixels=_PROBE_PX),
    "ambient occlusion": Use(
        "ambient occlusion", lambda scene: visual_of(scene).ambient_occlusion > 0.0, pixels=_PROBE_PX
    ),
    "bloom": Use("bloom", lambda scene: visual_of(scene).bloom > 0.0, pixels=_PROBE_PX),
}
"""Groups the planner knows, by name; those that share the frame's budget from what is missed most to what least.

Some have one method that the product can run: nothing is chosen there, and `explain` says so beside its cost.
"""


def uses() -> Mapping[str, Use]:
    """Those groups, then those that installed packages bring with a use of their own."""
    brought = {plugin.group: plugin.use for plugin in method_plugins() if plugin.use is not None}
    return {**brought, **USES}


NOT_PLANNED: Mapping[str, str] = {
    "integrator": 'the integrators of bodies on one wall alone; "colliding bodies" chooses among all a body can have',
    "bounding geometry": "what a thing is shaped like is its author's to say",
    "joint mixing": "how a body is to bend is a look: the scene's `animation.skinning` says it",
    "culling": "which is quicker changes with what is in view: the renderer counts the items of each scene",
    "frame of nodes": "culling, measured in whole frames",
    "frame of triangles": "level of detail, measured in whole frames",
    "loop scheduling": "the first recipe that the system grants runs",
    "model reading": "kinds of files, not rivals",
    "haptic tick": "the whole, by the tunnel projection that is chosen",
    "load of the person": "body signals belong to a run, not to a scene: the best of the chart, or what the task names",
}
"""Groups with several methods that the product can run, but nothing for the planner to choose: why."""
