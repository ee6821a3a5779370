"""Points of contact of the device that a scene names."""

from __future__ import annotations

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.world.components.robot import Robot
from mimics_app.world.files.scene.scene import Scene

__all__ = ["contact_number", "contacts_of"]


def contacts_of(scene: Scene) -> tuple[str, ...]:
    """Return the names of the device's points of contact; of an unknown device, reported elsewhere, one hand."""
    try:
        return descriptor_of((scene.first(Robot) or Robot()).device).contacts
    except DeviceError:
        return HAPTICMASTER.contacts


def contact_number(scene: Scene, name: str | None) -> int:
    """Return the number of a named point of contact, from 0; of None, and of one that `check` reports, the first."""
    if name is None:
        return 0
    contacts = contacts_of(scene)
    return contacts.index(name) if name in contacts else 0
