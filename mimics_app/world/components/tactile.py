"""Settings of the vibrators of a scene."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, field

from mimics_app.world.components.registry import Component, register_system

__all__ = ["TactileSettings"]


class TactileSettings(Component, frozen=True):
    """Vibrators on a serial line."""

    port: Annotated[str, Meta(max_length=400, description="Serial port; '' for none: taps are only recorded")] = ""
    baud: Annotated[int, Meta(ge=9600, le=1_000_000, description="Baud rate [bit/s]")] = 115200
    vibrators: Annotated[
        dict[str, Annotated[int, Meta(ge=0, le=255)]], Meta(max_length=64, description="Channel by part of the body")
    ] = field(default_factory=lambda: {"stomach": 0, "back": 1})


register_system("tactile", TactileSettings)
