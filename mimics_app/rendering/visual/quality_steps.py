"""Steps in which the frame governor lowers the quality of the picture to save time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mimics_app.rendering.visual.renderer import Renderer
    from mimics_app.rendering.visual.settings import ParticleLight, Shading
    from mimics_app.rendering.visual.view import View

__all__ = ["PictureStep", "lower_to_scale", "quality_steps", "rehearse_steps"]

_SCALES = (1.0, 0.75, 0.5)
"""Factors on the resolution that the governor may use."""

_SCALE = "resolution scale"


@dataclass(frozen=True, slots=True)
class PictureStep:
    """A step of the renderer for the frame governor, which requires `app.picture.governor.QualityStep`.

    Attributes:
        name: Name for people.
        order: Steps of a lower order are lowered first.
        levels: Names of the qualities, the full one first.
        change: Called with the new level.
        compiles: Whether a level needs other shader programs, and not only other uniforms.
    """

    name: str
    order: int
    levels: tuple[str, ...]
    change: Callable[[int], None]
    compiles: bool = True

    def apply(self, level: int) -> None:
        """Use a level from the next frame on."""
        self.change(level)


def quality_steps(renderer: Renderer) -> list[PictureStep]:
    """Return the steps of a renderer, least noticeable first: bloom first, shadows and plain shading last.

    Each starts at the present quality; an effect that is off already is left out.
    """
    settings = renderer.settings
    steps = [_bloom(renderer)] if settings.bloom else []
    steps += [_ambient(renderer)] if settings.ambient_occlusion else []
    steps += [_mirrors(renderer)] if renderer.world.mirrors and settings.mirror_scale == 1.0 else []
    steps += [_detail(renderer)] if len(renderer.world.content.levels.column("count")) else []
    lit = any(emitter.lit for emitter in renderer.world.effects.emitters.values())
    steps += [_particles(renderer)] if lit and settings.particle_light == "pixel" else []
    steps += _shadow_steps(renderer) if settings.shadow_size >= 8 else []
    steps += [_edges(renderer)] if settings.msaa or settings.fxaa else []
    steps += [_shading(renderer)] if settings.shading != "plain" else []
    return sorted([*steps, _scale(renderer)], key=lambda step: step.order)


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


def _bloom(renderer: Renderer) -> PictureStep:
    full = renderer.settings.bloom
    return PictureStep("bloom", 1, ("on", "off"), lambda level: renderer.set_quality(bloom=0.0 if level else full))


def _ambient(renderer: Renderer) -> PictureStep:
    full = renderer.settings.ambient_occlusion
    return PictureStep(
        "ambient occlusion",
        2,
        ("on", "off"),
        lambda level: renderer.set_quality(ambient_occlusion=0.0 if level else full),
    )


def _mirrors(renderer: Renderer) -> PictureStep:
    return PictureStep(
        "mirrors",
        3,
        ("sharp", "soft"),
        lambda level: renderer.set_quality(mirror_scale=0.5 if level else 1.0),
        compiles=False,
    )


def _detail(renderer: Renderer) -> PictureStep:
    full = renderer.settings.detail
    details = (full, max(0.25, 0.5 * full))
    return PictureStep(
        "level of detail",
        4,
        ("full", "nearer by"),
        lambda level: renderer.set_quality(detail=details[level]),
        compiles=False,
    )


def _particles(renderer: Renderer) -> PictureStep:
    levels: tuple[ParticleLight, ...] = ("pixel", "vertex")
    return PictureStep("particle light", 4, levels, lambda level: renderer.set_quality(particle_light=levels[level]))


def _shadow_steps(renderer: Renderer) -> list[PictureStep]:
    full = renderer.settings.shadow_size
    sizes = (full, full // 2)
    names = tuple(map(str, sizes))
    return [
        PictureStep(
            "shadow size", 5, names, lambda level: renderer.set_quality(shadow_size=sizes[level]), compiles=False
        ),
        PictureStep(
            "shadows", 8, ("on", "off"), lambda level: renderer.set_quality(shadow_size=0 if level else sizes[-1])
        ),
    ]


def _shading(renderer: Renderer) -> PictureStep:
    """Step to the cheapest shading, without shadows; matt shading saves only a twentieth of a frame (decision 128)."""
    full = renderer.settings.shading
    shadings: tuple[Shading, ...] = (full, "plain")
    return PictureStep("shading", 9, shadings, lambda level: renderer.set_quality(shading=shadings[level]))


def _edges(renderer: Renderer) -> PictureStep:
    """Step from multisampling to the cheaper filter alone, then to none."""
    settings = renderer.settings
    kept = [(settings.msaa, settings.fxaa), *([(0, True)] if settings.msaa else []), (0, False)]
    names = tuple(f"{samples} samples" if samples else "filtered" if fxaa else "off" for samples, fxaa in kept)
    return PictureStep(
        "anti-aliasing", 6, names, lambda level: renderer.set_quality(msaa=kept[level][0], fxaa=kept[level][1])
    )


def _scale(renderer: Renderer) -> PictureStep:
    full = renderer.settings.scale
    scales = tuple(full * share for share in _SCALES if full * share >= 0.25)
    names = tuple(f"{scale:g}" for scale in scales)
    return PictureStep(_SCALE, 7, names, lambda level: renderer.set_quality(scale=scales[level]))


def rehearse_steps(renderer: Renderer, views: Sequence[View]) -> None:
    """Compile the shaders of all steps before the first frame, by drawing a frame at each level.

    The order is the governor's, since drivers compile variants for sample count and format of the target too. Compiling
    during a session would freeze a frame for a tenth of a second.
    """
    steps = quality_steps(renderer)
    for step in steps:
        for level in range(1, len(step.levels)):
            step.apply(level)
            if step.compiles:
                renderer.draw_finished(views)
    for step in reversed(steps):
        step.apply(0)
