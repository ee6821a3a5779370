"""Keys of the developer's overlay, the same in a run and in the viewer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.rendering.visual.overlay.layers import LAYERS, Layer

if TYPE_CHECKING:
    from mimics_app.rendering.visual.renderer import Renderer

__all__ = ["OVERLAY_KEYS", "toggle_overlay"]

OVERLAY_KEYS: dict[str, Layer] = {f"f{number}": layer for number, layer in enumerate(LAYERS, start=1)}
"""Layer of each key: F1 frame graph, F2 wireframe, F3 bounds, F4 lights, F5 forces and contacts, F6 shadow atlas."""


def toggle_overlay(renderer: Renderer, events: Sequence[InputEvent]) -> None:
    """Switch layers by the keys pressed; the overlay is created at the first one."""
    for event in events:
        if event.kind == "key" and event.pressed and not event.repeat and event.name in OVERLAY_KEYS:
            renderer.overlay.toggle(OVERLAY_KEYS[event.name])
