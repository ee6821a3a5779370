"""Modules of the groups of methods; importing a module registers its groups."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from functools import cache
from importlib import import_module

from mimics_app.contracts.errors import UsageError, nearest, short_text
from mimics_app.contracts.methods import Registry, registry
from mimics_app.world.scene.method_plugins import method_plugins

__all__ = ["GROUPS", "all_groups", "load_methods"]

GROUPS = {
    "integrator": "haptic.integrators",
    "rotation update": "haptic.rotation",
    "contact law": "haptic.contact",
    "box face": "haptic.contact",
    "friction": "haptic.friction",
    "colliding bodies": "haptic.bodies",
    "resting bodies": "haptic.bodies",
    "shape cull": "haptic.cull",
    "bounding geometry": "haptic.bounding",
    "effects": "haptic.effect_costs",
    "grip": "haptic.effect_costs",
    "mesh finger": "haptic.mesh",
    "tunnel projection": "haptic.tunnel",
    "tunnel frame": "haptic.tunnel",
    "admittance form": "haptic.admittance",
    "haptic rate": "methods_rate",
    "loop scheduling": "methods_scheduling",
    "spatialiser": "audio.spatialiser",
    "culling": "visual.culling",
    "occlusion": "visual.city",
    "level of detail": "visual.city",
    "sun shadows": "visual.shadows",
    "frame of nodes": "visual.frame",
    "frame of triangles": "visual.frame",
    "anti aliasing": "visual.anti_aliasing",
    "bloom": "visual.post_processing",
    "ambient occlusion": "visual.post_processing",
    "crowd": "visual.people",
    "skinning": "visual.skinning",
    "shading": "visual.shading",
    "joint mixing": "visual.skinning",
    "limb reach": "visual.reach",
    "cord": "visual.cord",
    "head prediction": "visual.head_prediction",
    "lens distortion": "visual.lens_distortion",
    "stereo": "visual.stereo",
    "ripple distance": "visual.ripple",
    "cord frame": "visual.cord_frame",
    "model reading": "methods_reading",
    "haptic tick": "methods_tick",
    "load of the person": "physio.load_methods",
}
"""Module of this package that registers a group, by the group's name."""


def all_groups() -> list[str]:
    """Return the names of the groups, those of installed packages last."""
    return list(dict.fromkeys([*GROUPS, *(plugin.group for plugin in method_plugins())]))


def load_methods(groups: Iterable[str] | None = None) -> Registry:
    """Register the methods of some groups, or of all, and return the registry; other modules are not imported.

    Raises:
        UsageError: There is no such group.
    """
    known = all_groups()
    for group in known if groups is None else groups:
        if group not in known:
            raise UsageError(f'there is no group of methods "{group}"', nearest(group, known))
        if group in GROUPS:
            import_module(f"{__package__}.{GROUPS[group]}")
        _register_plugins(group)
    return registry


@cache
def _register_plugins(group: str) -> None:
    """Register the methods of installed packages in a group, once; report on stderr what cannot be registered."""
    for plugin in method_plugins():
        if plugin.group != group:
            continue
        try:
            registry.take(group, plugin.register)
        except Exception as error:  # noqa: BLE001 a third-party function may raise anything
            why, where = short_text(f"{type(error).__name__}: {error}"), plugin.register.__module__
            sys.stderr.write(f'mimics: the methods of {where} for "{group}" are left out: {why}\n')
