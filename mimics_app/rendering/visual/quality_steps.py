"""Steps in which the frame governor lowers the quality of the picture to save time."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mimics_app.rendering.visual.renderer import Renderer
    from mimics_app.rendering.visual.settings import QualityChanges, RenderSettings
    from mimics_app.rendering.visual.view import View

__all__ = ["PictureStep", "lower_to_scale", "quality_steps", "rehearse_steps"]

_SCALES = (1.0, 0.75, 0.5)
"""Factors on the resolution that the governor may use."""

_SCALE = "resolution scale"

_NO_SIDE = 1e-9
"""Length [px] that no side of a triangle is below."""

_UNIFORMS_ONLY = ("mirrors", "level of detail", "shadow size")
"""Steps whose levels need the same shader programs."""

Levels = Mapping[str, "QualityChanges"]
"""Settings of a step's levels by the name of the level, the full quality first."""


@dataclass(frozen=True, slots=True)
class PictureStep:
    """A step of the renderer for the frame governor, which requires `app.picture.governor.QualityStep`.

    Attributes:
        name: Name for people.
        order: Steps of a lower order are lowered first.
        qualities: Its levels.
        renderer: What they apply to.
    """

    name: str
    order: int
    qualities: Levels
    renderer: Renderer

    @property
    def levels(self) -> tuple[str, ...]:
        """Names of the levels, the full quality first."""
        return tuple(self.qualities)

    def apply(self, level: int) -> None:
        """Use a level from the next frame on."""
        self.renderer.set_quality(**self.qualities[self.levels[level]])


def quality_steps(renderer: Renderer) -> list[PictureStep]:
    """Return the steps of a renderer, least noticeable first: bloom first, shadows and plain shading last.

    Each starts at the present quality; an effect that is off already is left out. Shading becomes plain at once: matt
    shading saves only a twentieth of a frame (decision 114).
    """
    now, world, size = renderer.settings, renderer.world, renderer.settings.shadow_size
    lit = any(emitter.lit for emitter in world.effects.emitters.values())
    steps: dict[str, tuple[bool, Levels]] = {
        "bloom": (now.bloom > 0.0, {"on": {"bloom": now.bloom}, "off": {"bloom": 0.0}}),
        "ambient occlusion": (
            now.ambient_occlusion > 0.0,
            {"on": {"ambient_occlusion": now.ambient_occlusion}, "off": {"ambient_occlusion": 0.0}},
        ),
        "mirrors": (
            bool(world.mirrors) and now.mirror_scale == 1.0,
            {"sharp": {"mirror_scale": 1.0}, "soft": {"mirror_scale": 0.5}},
        ),
        "level of detail": (
            len(world.content.levels.column("count")) > 0,
            {"full": {"detail": now.detail}, "nearer by": {"detail": max(0.25, 0.5 * now.detail)}},
        ),
        "particle light": (
            lit and now.particle_light == "pixel",
            {"pixel": {"particle_light": "pixel"}, "vertex": {"particle_light": "vertex"}},
        ),
        "shadow size": (size >= 8, {f"{size}": {"shadow_size": size}, f"{size // 2}": {"shadow_size": size // 2}}),
        "anti-aliasing": (now.msaa > 0 or now.fxaa, _edges(now)),
        _SCALE: (True, {f"{scale:g}": {"scale": scale} for share in _SCALES if (scale := now.scale * share) >= 0.25}),
        "shadows": (size >= 8, {"on": {"shadow_size": size // 2}, "off": {"shadow_size": 0}}),
        "shading": (now.shading != "plain", {now.shading: {"shading": now.shading}, "plain": {"shading": "plain"}}),
    }
    return [
        PictureStep(name, order, levels, renderer)
        for order, (name, (applies, levels)) in enumerate(steps.items())
        if applies
    ]


def _edges(now: RenderSettings) -> Levels:
    """Levels from multisampling to the cheaper filter alone, then to none."""
    full = f"{now.msaa} samples" if now.msaa else "filtered"
    return {
        full: {"msaa": now.msaa, "fxaa": now.fxaa},
        "filtered": {"msaa": 0, "fxaa": True},
        "off": {"msaa": 0, "fxaa": False},
    }


def lower_to_scale(renderer: Renderer, scale: float) -> None:
    """Use the quality at which the governor lowers the resolution to a scale: what is noticed less is lowered already.

    Args:
        renderer: A renderer at full quality.
        scale: One of `_SCALES`.
    """
    for step in quality_steps(renderer):
        if step.name == _SCALE:
            step.apply(_SCALES.index(scale))
            return
        step.apply(len(step.levels) - 1)


def rehearse_steps(renderer: Renderer, views: Sequence[View]) -> None:
    """Compile the shaders of all steps before the first frame, by drawing a frame at each level.

    The order is the governor's, since drivers compile variants for sample count and format of the target too. Compiling
    during a session would freeze a frame for a tenth of a second. First people are drawn lit at each pixel, and lit at
    their vertices.
    """
    steps, limit = quality_steps(renderer), renderer.settings.vertex_light
    for each in (_NO_SIDE, math.inf) if limit > 0.0 else ():
        renderer.set_quality(vertex_light=each)
        renderer.draw_finished(views)
    renderer.set_quality(vertex_light=limit)
    for step in steps:
        for level in range(1, len(step.levels)):
            step.apply(level)
            if step.name not in _UNIFORMS_ONLY:
                renderer.draw_finished(views)
    for step in reversed(steps):
        step.apply(0)
