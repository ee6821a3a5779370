"""Impairment of a simulated person: presets, with values of a component in their place."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import require_choice
from mimics_app.contracts.messages.abilities import Abilities
from mimics_app.rendering.haptic.kernels import arm

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Patient

__all__ = ["PRESETS", "Impairment", "impairment_of", "lay_path", "write_arm"]

_BEYOND_END = 0.012
"""Distance by which the intended path extends beyond the last point [m]."""


_FINEST_AIM = 0.002
"""Smallest distance to a target that is corrected [m]."""

_CONTENT_SHARE = 0.4
"""Largest distance to a target that is not corrected, as a share of the aim error."""


@dataclass(frozen=True, slots=True)
class Impairment:
    """Motor parameters and senses of a simulated person.

    Attributes:
        arm_mass: Mass at the hand [kg].
        arm_damping: Damping at the hand [N s/m].
        arm_stiffness: Stiffness at the hand [N/m].
        speed: Peak speed of a voluntary movement [m/s].
        reach: Length of one movement [m].
        aim_error: Standard deviation of a movement's end point per axis [m].
        reaction: Pause before the next movement [s].
        tremor: Amplitude of the tremor force per axis [N].
        tremor_hz: Its frequency [Hz].
        grasp: Mean grasp force [N].
        grasp_variation: Its standard deviation [N].
        corner_cutting: 0: movements follow the bends of the path, 1: straight from start to end.
        strength: Largest grasp force [N].
        release: Time in which the hand opens [s].
        range_of_motion: How far the hand gets from where it rests: to the right, left, up, down, forwards and back [m];
            (): as far as the device.
        ease: Share of that range within which a movement is comfortable.
        hearing_left, hearing_right: Softest audible level at a side [dB, 0 as authored].
        letter: Height of the smallest letter that is read [px of a picture 720 px high].
        mirrored: Whether random movements are those of the mirror image.
    """

    arm_mass: float
    arm_damping: float
    arm_stiffness: float
    speed: float
    reach: float
    aim_error: float
    reaction: float
    tremor: float
    tremor_hz: float
    grasp: float
    grasp_variation: float
    corner_cutting: float
    strength: float
    release: float = 0.5
    range_of_motion: tuple[float, ...] = ()
    ease: float = 0.8
    hearing_left: float = -45.0
    hearing_right: float = -45.0
    letter: float = 12.0
    mirrored: bool = False

    @property
    def abilities(self) -> Abilities:
        """What a calibration of the person should find."""
        return Abilities(
            self.range_of_motion, self.ease, self.strength, self.hearing_left, self.hearing_right, self.letter
        )


PRESETS = {
    "healthy": Impairment(1.5, 25.0, 350.0, 0.17, 0.40, 0.006, 0.0, 0.1, 8.0, 10.0, 0.8, 0.30, 60.0),
    "moderate": Impairment(1.5, 25.0, 420.0, 0.13, 0.060, 0.011, 0.25, 1.2, 6.0, 9.0, 2.0, 0.45, 32.0),
    "severe": Impairment(1.6, 28.0, 450.0, 0.09, 0.035, 0.018, 0.50, 3.0, 5.0, 7.5, 3.0, 0.55, 18.0),
}
"""From healthy to severe: one smooth movement, then more, shorter and less accurate ones (submovements after stroke:
Krebs et al. 1999, Rohrer et al. 2002), a stiffer (spastic) arm, tremor, a weak grasp. Strengths are settings, not
data."""


def impairment_of(patient: Patient) -> Impairment:
    """Return the preset of a component with the component's own values in its place.

    Raises:
        UsageError: Unknown preset; that of a scene is checked before, one in a program is not.
    """
    require_choice(patient.preset, PRESETS, "simulated patient")
    preset = PRESETS[patient.preset]
    values = {f.name: getattr(patient, f.name, None) for f in fields(Impairment)}
    return Impairment(**{name: getattr(preset, name) if value is None else value for name, value in values.items()})


def lay_path(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Return equally spaced points along a path, extended a little beyond its end.

    Args:
        points: Points of a polyline [m], shape [n, 3]; fewer than two distinct ones: no path.

    Returns:
        (points of shape [m, 3], m at most arm.PATH_POINTS, distance between them along the path [m]).
    """
    points = points[np.append(True, np.any(np.diff(points, axis=0) != 0.0, axis=1))] if len(points) else points
    if len(points) < 2:
        return np.zeros((0, 3)), 1.0
    last = points[-1] - points[-2]
    corners = np.vstack([points, points[-1] + _BEYOND_END * last / np.linalg.norm(last)])
    arcs = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    even = np.linspace(0.0, arcs[-1], arm.PATH_POINTS)
    laid = np.stack([np.interp(even, arcs, corners[:, i]) for i in range(3)], axis=1)
    return laid, float(even[1])


def write_arm(memory: NDArray[np.float64], person: Impairment, via_points: NDArray[np.float64], intent: bool) -> None:
    """Fill an arm's memory, shape [arm.ARM_LENGTH]; the caller seeds the random generator."""
    values: dict[int, Any] = {
        arm.ARM_MASS: person.arm_mass,
        arm.ARM_DAMPING: person.arm_damping,
        arm.ARM_STIFFNESS: person.arm_stiffness,
        arm.PEAK_SPEED: person.speed,
        arm.REACH: person.reach,
        arm.AIM_ERROR: person.aim_error,
        arm.REACTION: person.reaction,
        arm.TREMOR: person.tremor,
        arm.TREMOR_HZ: person.tremor_hz,
        arm.GRASP_MEAN: person.grasp,
        arm.GRASP_VARIATION: person.grasp_variation,
        arm.CORNER_CUTTING: person.corner_cutting,
        arm.TOLERANCE: max(_FINEST_AIM, _CONTENT_SHARE * person.aim_error),
        arm.INTENT: float(intent),
        arm.STRENGTH: person.strength,
        arm.OPENING: person.release,
        arm.MIRRORED: float(person.mirrored),
    }
    for place, value in values.items():
        memory[place] = value
    laid, step = lay_path(via_points)
    memory[arm.VIA_POINTS] = laid.shape[0]
    memory[arm.VIA_STEP] = step
    memory[arm.PATH : arm.PATH + laid.size] = laid.ravel()
    if person.range_of_motion:
        right, left, up, down, forwards, back = person.range_of_motion
        memory[arm.LIMITED] = 1.0
        memory[arm.LEAST : arm.LEAST + 3] = (-forwards, -left, -down)
        memory[arm.MOST : arm.MOST + 3] = (back, right, up)
