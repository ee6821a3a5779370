"""How impaired a simulated person is: presets, and a component's own values over them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.rendering.haptic.kernels import arm

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Patient

__all__ = ["PRESETS", "Impairment", "impairment_of", "lay_path", "write_arm"]

_BEYOND_END = 0.012
"""The person means to pass the last point by this much [m], as one walks through a finish."""


_FINEST_AIM = 0.002
"""Nobody corrects less than this [m]."""

_CONTENT_SHARE = 0.4
"""A hand this share of its own aim error away from a target is left there."""


@dataclass(frozen=True, slots=True)
class Impairment:
    """One kind of person.

    Attributes:
        arm_mass: At the hand [kg].
        arm_damping: At the hand [N s/m].
        arm_stiffness: At the hand [N/m].
        speed: Peak speed of a voluntary movement [m/s].
        reach: Length of one movement [m].
        aim_error: Standard deviation of a movement's end point per axis [m].
        reaction: Pause before the next movement [s].
        tremor: Amplitude of the tremor force per axis [N].
        tremor_hz: Its frequency [Hz].
        grasp: Mean grasp force [N].
        grasp_variation: Its standard deviation [N].
        corner_cutting: 0 follows the bends of the way, 1 goes straight from end to end of a movement.
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


PRESETS = {
    "healthy": Impairment(1.5, 25.0, 350.0, 0.17, 0.40, 0.006, 0.0, 0.1, 8.0, 10.0, 0.8, 0.30),
    "moderate": Impairment(1.5, 25.0, 420.0, 0.13, 0.060, 0.011, 0.25, 1.2, 6.0, 9.0, 2.0, 0.45),
    "severe": Impairment(1.6, 28.0, 450.0, 0.09, 0.035, 0.018, 0.50, 3.0, 5.0, 7.5, 3.0, 0.55),
}
"""From mild to heavy: one flowing movement, then ever more, shorter and less exact ones (submovements after stroke:
Krebs et al. 1999, Rohrer et al. 2002), a stiffer (spastic) arm, tremor, a weak grasp."""


def impairment_of(patient: Patient) -> Impairment:
    """The preset of a component with the component's own values over it.

    Raises:
        UsageError: there is no such preset; a scene's is checked, a setting of a program may be anything.
    """
    if patient.preset not in PRESETS:
        raise UsageError(f'there is no simulated patient "{patient.preset}"', nearest(patient.preset, PRESETS))
    preset = PRESETS[patient.preset]
    values = {f.name: getattr(patient, f.name, None) for f in fields(Impairment)}
    return Impairment(**{name: getattr(preset, name) if value is None else value for name, value in values.items()})


def lay_path(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Equally spaced points along a way, led a little beyond its end.

    Args:
        points: Corner points, shape [n, 3], [m]; fewer than two different ones: no way.

    Returns:
        (points of shape [m, 3], m at most arm.PATH_POINTS, distance between them along the way [m]).
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
    """Fill an arm's memory, shape [arm.ARM_LENGTH]; the generator is seeded by the caller."""
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
    }
    for place, value in values.items():
        memory[place] = value
    laid, step = lay_path(via_points)
    memory[arm.VIA_POINTS] = laid.shape[0]
    memory[arm.VIA_STEP] = step
    memory[arm.PATH : arm.PATH + laid.size] = laid.ravel()
