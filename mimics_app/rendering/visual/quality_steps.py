"""What the picture can give up for time: the steps that it registers with the frame governor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mimics_app.rendering.visual.renderer import Renderer

__all__ = ["PictureStep", "quality_steps"]

_SCALES = (1.0, 0.75, 0.5)


@dataclass(frozen=True, slots=True)
class PictureStep:
    """A `contracts.governor.QualityStep` of the renderer.

    Attributes:
        name: As people read it.
        order: Steps of a lower order are given up first.
        levels: Names of the qualities, the full one first.
        change: Called with a level.
    """

    name: str
    order: int
    levels: tuple[str, ...]
    change: Callable[[int], None]

    def apply(self, level: int) -> None:
        """Go over to a level from the next frame on."""
        self.change(level)


def quality_steps(renderer: Renderer) -> list[PictureStep]:
    """The steps of a renderer, from what is missed least: finer shadow edges, sharpness, shadows at all.

    Each begins at the quality the renderer has now; one that it does without anyway is left out.
    """
    full, scale = renderer.settings.shadow_size, renderer.settings.scale
    sizes = (full, full // 2)
    scales = tuple(scale * share for share in _SCALES if scale * share >= 0.25)
    steps = [
        PictureStep(
            "shadow size", 1, tuple(map(str, sizes)), lambda level: renderer.set_quality(shadow_size=sizes[level])
        ),
        PictureStep(
            "resolution scale",
            2,
            tuple(f"{s:g}" for s in scales),
            lambda level: renderer.set_quality(scale=scales[level]),
        ),
        PictureStep(
            "shadows", 3, ("on", "off"), lambda level: renderer.set_quality(shadow_size=0 if level else sizes[-1])
        ),
    ]
    return [step for step in steps if len(step.levels) > 1 and (full >= 8 or not step.name.startswith("shadow"))]
