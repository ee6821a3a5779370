"""Several sampled, delayed contacts of one device, simulated and exact, for S16.

As `wall_loop` in three directions: each contact's law gives a force along its normal from depth and differenced depth,
and their sum acts, held, n ticks later.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.lab.stability.growth import dies_away, note_peak
from mimics_app.lab.stability.linear import find_limit, spectral_radius
from mimics_app.lab.stability.wall_loop import (
    APART,
    DEPTH,
    LARGE,
    LONGEST,
    PRECISION,
    SHORTEST,
    SOFT,
    delayed_loop,
)
from mimics_app.rendering.haptic.kernels.closed_region import REGION, find_region
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.directions import SPAN, add_contact, begin_span, span_share
from mimics_app.rendering.haptic.kernels.integrators import step_free

__all__ = [
    "Contact",
    "Device",
    "exact_limit",
    "exact_matrix",
    "region_of",
    "rule_limit",
    "rule_share",
    "simulated_limit",
    "span_of",
    "sum_limit",
]


_HARD = 1e6
"""Upper end of the search for a limit [N/m]."""

_SLOW = 1e-9
"""Distance of a spectral radius from 1 within rounding: the slow mode of a soft contact decays faster per tick."""


@dataclass(frozen=True, slots=True)
class Contact:
    """One contact.

    Attributes:
        angle: Angle of its normal to that of the first [rad], in the plane of the first two axes.
        stiffness: Stiffness K [N/m].
        damping: Damping B [N s/m].
        lift: Elevation of its normal out of that plane [rad].
    """

    angle: float
    stiffness: float
    damping: float
    lift: float = 0.0

    @property
    def normal(self) -> Vec:
        """Unit normal, shape [3]."""
        flat = np.cos(self.lift)
        return np.array([flat * np.cos(self.angle), flat * np.sin(self.angle), np.sin(self.lift)])


@dataclass(frozen=True, slots=True)
class Device:
    """The device.

    Attributes:
        mass: Mass [kg].
        damping: Damping b: its own, virtual, and that of the arm [N s/m].
        rate: Ticks per second [Hz].
        delay: Whole ticks between sampling and acting.
    """

    mass: float = 3.0
    damping: float = 8.0
    rate: float = 1000.0
    delay: int = 4

    @property
    def lag(self) -> float:
        """Delay of the force, T / 2 + n T [s]."""
        return (0.5 + self.delay) / self.rate


Contacts = tuple[Contact, ...]


class Pressed(NamedTuple):
    """Contacts as the kernel has them.

    Attributes:
        normals: Shape [n, 3].
        k: Stiffnesses [N/m], shape [n].
        B: Dampings [N s/m], shape [n].
    """

    normals: Mat
    k: Vec
    B: Vec


def _stiffer(contacts: Contacts, first: float) -> Contacts:
    """Return the contacts with another stiffness of the first [N/m]."""
    one = contacts[0]
    return (Contact(one.angle, first, one.damping, one.lift), *contacts[1:])


@kernel
def _contact_force(normals: Mat, k: Vec, B: Vec, x: Vec, last: Vec, dt: float, force: Vec) -> None:
    """Compute the force of all contacts on the device, less the force at rest at DEPTH in each [N]."""
    force[:] = 0.0
    for c in range(k.shape[0]):
        depth, rate = DEPTH, 0.0
        for i in range(3):
            depth -= normals[c, i] * x[i]
            rate -= normals[c, i] * (x[i] - last[i]) / dt
        push = spring_damper(depth, rate, k[c], B[c]) - k[c] * DEPTH
        for i in range(3):
            force[i] += push * normals[c, i]


@kernel
def _press_contacts(
    pressed: Pressed, m: float, b: float, dt: float, delay: int, ticks: int, line: Mat, peaks: Vec
) -> None:
    """Simulate the device in the contacts, released at a distance from rest.

    Args:
        pressed: The contacts.
        m: Mass of the device [kg].
        b: Its own damping [N s/m].
        dt: Tick [s].
        delay: Ticks between sampling and acting.
        ticks: Length of the run [ticks].
        line: Delay line of the forces, zeros, shape [at least delay + 1, 3].
        peaks: Receives the peaks of the distance from rest by quarter of the run [m], shape [4], see `note_peak`.
    """
    normals, k, B = pressed
    x, last, v = np.zeros(3), np.zeros(3), np.zeros(3)
    for c in range(k.shape[0]):
        for j in range(3):
            x[j] += APART * normals[c, j]
            last[j] = x[j]
    peaks[:] = 0.0
    for i in range(ticks):
        _contact_force(normals, k, B, x, last, dt, line[i % (delay + 1)])
        size = 0.0
        for j in range(3):
            last[j] = x[j]
            x[j], v[j] = step_free(x[j], v[j], line[(i + 1) % (delay + 1), j], m, b, dt)
            size += x[j] * x[j]
        if note_peak(np.sqrt(size), i, ticks, LARGE, peaks):
            return


def _is_stable(device: Device, contacts: Contacts) -> bool:
    """Whether the device in the contacts is stable, by simulation."""
    pressed = Pressed(
        np.array([contact.normal for contact in contacts]),
        np.array([contact.stiffness for contact in contacts]),
        np.array([contact.damping for contact in contacts]),
    )

    def run(ticks: int) -> Vec:
        peaks = np.zeros(4)
        line = np.zeros((device.delay + 1, 3))
        _press_contacts(pressed, device.mass, device.damping, 1.0 / device.rate, device.delay, ticks, line, peaks)
        return peaks

    return dies_away(run, SHORTEST, LONGEST)


def simulated_limit(device: Device, contacts: Contacts) -> float:
    """Return the largest stable stiffness of the first contact beside the others, by simulation [N/m]."""
    return find_limit(lambda first: _is_stable(device, _stiffer(contacts, first)), SOFT, _HARD, PRECISION)


def exact_matrix(device: Device, contacts: Contacts) -> Mat:
    """Return one tick of the loop as a matrix, see `delayed_loop`, in the directions with any stiffness."""
    normals = np.array([contact.normal for contact in contacts])
    _, sizes, span = np.linalg.svd(normals)
    normals = normals @ span[: int((sizes > 1e-9).sum())].T
    K = sum(c.stiffness * np.outer(u, u) for c, u in zip(contacts, normals, strict=True))
    B = sum(c.damping * np.outer(u, u) for c, u in zip(contacts, normals, strict=True))
    return delayed_loop(np.asarray(K), np.asarray(B), device.mass, device.damping, 1.0 / device.rate, device.delay)


def exact_limit(device: Device, contacts: Contacts) -> float:
    """Return the largest stable stiffness of the first contact beside the others, by eigenvalues [N/m]."""

    def is_contracting(first: float) -> bool:
        return spectral_radius(exact_matrix(device, _stiffer(contacts, first))) < 1.0 - _SLOW

    return find_limit(is_contracting, SOFT, _HARD)


def span_of(contacts: Contacts) -> NDArray[np.void]:
    """Return the sum of all contacts as the live loop has it, a SPAN record, shape [1]."""
    span = np.zeros(1, SPAN)
    begin_span(span[0], 0.0, 0.0)
    for contact in contacts:
        add_contact(span[0], contact.normal, contact.stiffness, contact.damping, 0.0, 0.0)
    return span


def region_of(device: Device) -> NDArray[np.void]:
    """Return the region of the live loop for a device that takes forces, a REGION record, shape [1]."""
    scene, region = np.zeros(1, SCENE), np.zeros(1, REGION)
    scene[0]["force_driven"], scene[0]["device_mass"] = 1, device.mass
    scene[0]["device_damping"] = device.damping
    find_region(scene[0], device.delay / device.rate, 1.0 / device.rate, region[0])
    return region


def rule_share(device: Device, contacts: Contacts, margin: float = 0.0) -> float:
    """Return the share of all contacts that gives a margin in every direction, as in the stiffness cap, 0-1."""
    return float(span_share(span_of(contacts)[0], region_of(device)[0], margin))


def rule_limit(device: Device, contacts: Contacts) -> float:
    """Return the largest stiffness of the first contact by the worst direction, the rule of the loop [N/m]."""
    return find_limit(lambda first: rule_share(device, _stiffer(contacts, first)) >= 1.0, SOFT, _HARD)


def sum_limit(device: Device, contacts: Contacts) -> float:
    """Return the same from sums over all contacts regardless of their direction [N/m]."""
    damping = device.damping + sum(contact.damping for contact in contacts)
    return damping / device.lag - sum(contact.stiffness for contact in contacts[1:])
