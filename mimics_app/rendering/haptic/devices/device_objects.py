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


def _properties(item: DeviceObject) -> tuple[str, dict[str, str]]:
    """Return the HapticMaster's name of the kind and the kind's own properties."""
    match item:
        case DeviceBlock():
            return "block", {"size": _vector(item.size)}
        case DeviceSphere():
            return "sphere", {"radius": f"{item.radius:.6g}"}
        case DeviceCylinder():
            return "cylinder", {"radius": f"{item.radius:.6g}", "length": f"{item.length:.6g}"}
        case DevicePlane():
            return "flatplane", {"normal": _vector(item.normal)}
        case DeviceSpring():
            own = {"maxforce": f"{item.largest_force:.6g}"}
            return "spring", own | ({"direction": _vector(item.direction)} if any(item.direction) else {})
        case DeviceDamper():
            return "damper", {"dampcoef": _vector(item.damping)}


def hapticmaster_commands(item: DeviceObject) -> list[str]:
    """Return the commands that create and enable an object on the machine, in order."""
    kind, properties = _properties(item)
    if not isinstance(item, DeviceDamper):
        properties["pos"] = _vector(item.centre)
        properties["stiffness"] = f"{item.stiffness:.6g}"
        properties["dampfactor"] = f"{item.damping_ratio:.6g}"
    if isinstance(item, _Surface) and item.friction > 0.0:
        properties["friction"] = f"{item.friction:.6g}"
    settings = [f"set {item.name} {name} {value}" for name, value in properties.items()]
    return [f"create {kind} {item.name}", *settings, f"set {item.name} enable"]
