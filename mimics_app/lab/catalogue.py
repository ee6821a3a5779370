"""Where the methods are: importing a module of this table registers its groups. No list of methods is kept here."""

# ruff: noqa: F401  to import is to register

from __future__ import annotations

from collections.abc import Callable, Iterable

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.methods import Registry, registry

__all__ = ["GROUPS", "load_methods"]


def _tunnel() -> None:
    import mimics_app.lab.haptic.tunnel


def _admittance() -> None:
    import mimics_app.lab.haptic.admittance


def _integrators() -> None:
    import mimics_app.lab.haptic.integrators


def _rotation() -> None:
    import mimics_app.lab.haptic.rotation


def _contact() -> None:
    import mimics_app.lab.haptic.contact


def _bodies() -> None:
    import mimics_app.lab.haptic.bodies


def _friction() -> None:
    import mimics_app.lab.haptic.friction


def _cull() -> None:
    import mimics_app.lab.haptic.cull


def _bounding() -> None:
    import mimics_app.lab.haptic.bounding


def _mesh() -> None:
    import mimics_app.lab.haptic.mesh


def _sound() -> None:
    import mimics_app.lab.audio.spatialiser


def _culling() -> None:
    import mimics_app.lab.visual.culling


def _shadows() -> None:
    import mimics_app.lab.visual.shadows


def _city() -> None:
    import mimics_app.lab.visual.city


def _frame() -> None:
    import mimics_app.lab.visual.frame


def _anti_aliasing() -> None:
    import mimics_app.lab.visual.anti_aliasing


def _effects() -> None:
    import mimics_app.lab.visual.effects


def _tick() -> None:
    import mimics_app.lab.methods_tick


def _rate() -> None:
    import mimics_app.lab.methods_rate


def _scheduling() -> None:
    import mimics_app.lab.methods_scheduling


def _reading() -> None:
    import mimics_app.lab.methods_reading


GROUPS: dict[str, Callable[[], None]] = {
    "integrator": _integrators,
    "rotation update": _rotation,
    "contact law": _contact,
    "box face": _contact,
    "friction": _friction,
    "colliding bodies": _bodies,
    "shape cull": _cull,
    "bounding geometry": _bounding,
    "mesh finger": _mesh,
    "tunnel projection": _tunnel,
    "tunnel frame": _tunnel,
    "admittance form": _admittance,
    "haptic rate": _rate,
    "loop scheduling": _scheduling,
    "spatialiser": _sound,
    "culling": _culling,
    "occlusion": _city,
    "level of detail": _city,
    "sun shadows": _shadows,
    "frame of nodes": _frame,
    "frame of triangles": _frame,
    "anti aliasing": _anti_aliasing,
    "bloom": _effects,
    "ambient occlusion": _effects,
    "model reading": _reading,
    "haptic tick": _tick,
}
"""Group -> what imports the module that registers it."""


def load_methods(groups: Iterable[str] | None = None) -> Registry:
    """Register the methods of some groups, or of all, and return the registry; modules of others stay unimported.

    Raises:
        UsageError: There is no such group.
    """
    for group in GROUPS if groups is None else groups:
        if group not in GROUPS:
            raise UsageError(f'there is no group of methods "{group}"', nearest(group, GROUPS))
        GROUPS[group]()
    return registry
