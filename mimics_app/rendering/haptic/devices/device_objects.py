"""Objects that a robot renders itself, independent of the robot, and their commands for the HapticMaster.

Positions are in the robot frame (x radial, y lateral, z up) [m]; boxes and cylinders are upright in it.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "DEFAULT_INERTIA",
    "DeviceBlock",
    "DeviceCylinder",
    "DeviceDamper",
    "DeviceObject",
    "DevicePlane",
    "DeviceSphere",
    "DeviceSpring",
    "Point",
    "hapticmaster_commands",
]

Point = tuple[float, float, float]

DEFAULT_INERTIA = 3.0
"""Default virtual mass of a robot [kg]."""


@dataclass(frozen=True, slots=True)
class _Surface:
    """Object with a surface.

    Attributes:
        name: Unique name of letters, digits and underscores.
        centre: Centre [m]; for a plane any point of it.
        stiffness: Stiffness of the surface [N/m].
        damping_ratio: Damping as a share of the critical damping with the virtual mass [-].
        friction: Coefficient of friction [-].
    """

    name: str
    centre: Point
    stiffness: float = 2000.0
    damping_ratio: float = 0.1
    friction: float = 0.0


@dataclass(frozen=True, slots=True)
class DeviceBlock(_Surface):
    """A box; `size` are its edge lengths [m]."""

    size: Point = (0.1, 0.1, 0.1)


@dataclass(frozen=True, slots=True)
class DeviceSphere(_Surface):
    """A sphere."""

    radius: float = 0.05


@dataclass(frozen=True, slots=True)
class DeviceCylinder(_Surface):
    """An upright cylinder."""

    radius: float = 0.05
    length: float = 0.1


@dataclass(frozen=True, slots=True)
class DevicePlane(_Surface):
    """Half-space behind a plane; `normal` points to the free side."""

    normal: Point = (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class DeviceSpring:
    """A spring to a point, along `direction`; zero: in all directions."""

    name: str
    centre: Point
    stiffness: float = 200.0
    damping_ratio: float = 0.7
    largest_force: float = 20.0
    direction: Point = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class DeviceDamper:
    """Viscous damping everywhere, per axis [N s/m]."""

    name: str
    damping: Point = (10.0, 10.0, 10.0)


DeviceObject = DeviceBlock | DeviceSphere | DeviceCylinder | DevicePlane | DeviceSpring | DeviceDamper


def _vector(values: Point) -> str:
    return "[" + ",".join(f"{value:.6g}" for value in values) + "]"


def _properties(thing: DeviceObject) -> tuple[str, dict[str, str]]:
    """Return the HapticMaster's name of the kind and the kind's own properties."""
    match thing:
        case DeviceBlock():
            return "block", {"size": _vector(thing.size)}
        case DeviceSphere():
            return "sphere", {"radius": f"{thing.radius:.6g}"}
        case DeviceCylinder():
            return "cylinder", {"radius": f"{thing.radius:.6g}", "length": f"{thing.length:.6g}"}
        case DevicePlane():
            return "flatplane", {"normal": _vector(thing.normal)}
        case DeviceSpring():
            own = {"maxforce": f"{thing.largest_force:.6g}"}
            return "spring", own | ({"direction": _vector(thing.direction)} if any(thing.direction) else {})
        case DeviceDamper():
            return "damper", {"dampcoef": _vector(thing.damping)}


def hapticmaster_commands(thing: DeviceObject) -> list[str]:
    """Return the commands that create and enable an object on the machine, in order."""
    kind, properties = _properties(thing)
    if not isinstance(thing, DeviceDamper):
        properties["pos"] = _vector(thing.centre)
        properties["stiffness"] = f"{thing.stiffness:.6g}"
        properties["dampfactor"] = f"{thing.damping_ratio:.6g}"
    if isinstance(thing, _Surface) and thing.friction > 0.0:
        properties["friction"] = f"{thing.friction:.6g}"
    settings = [f"set {thing.name} {name} {value}" for name, value in properties.items()]
    return [f"create {kind} {thing.name}", *settings, f"set {thing.name} enable"]
