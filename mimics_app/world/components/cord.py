"""Component type of a cord between two entities."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.bounds import Point, Share
from mimics_app.world.components.checked_scene import CheckedScene
from mimics_app.world.components.registry import Component, component, register_check

__all__ = ["CordComponent"]


@component("cord", limit=16)
class CordComponent(Component, frozen=True):
    """A cord from this entity to another one, which follows both."""

    to: Annotated[str, Meta(description="Id of the entity at its other end")]
    offset: Annotated[Point, Meta(description="Start in this entity's frame [m]")] = (0.0, 0.0, 0.0)
    to_offset: Annotated[Point, Meta(description="End in the other entity's frame [m]")] = (0.0, 0.0, 0.0)
    length: Annotated[
        float, Meta(gt=0.0, le=50.0, description="Length [m]; taut where it is below the distance of the ends")
    ] = 1.4
    radius: Annotated[float, Meta(gt=0.0, le=1.0, description="Radius [m]")] = 0.025
    colour: Annotated[tuple[Share, Share, Share], Meta(description="Linear RGB")] = (0.75, 0.25, 0.2)
    roughness: Annotated[Share, Meta(description="Roughness of the surface; 0: a mirror")] = 0.45
    visible: Annotated[bool, Meta(description="False: it is not drawn")] = True
    wave_speed: Annotated[float, Meta(gt=0.0, le=20.0, description="Speed of ripples [m/s]")] = 0.5
    wavelength: Annotated[float, Meta(gt=1e-3, le=1.0, description="Wavelength of ripples [m]")] = 0.05


def _check(cord: CordComponent, pointer: str, scene: CheckedScene) -> list[Issue]:
    return scene.check_entity(f"{pointer}/to", cord.to)


register_check("cord", _check)
