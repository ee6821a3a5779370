"""The foot of the simulated orthosis on a wall, at any rate of its control, simulated and exact, for S18.

The simulation is the device's plug-in and the control of the loop, tick by tick, without backlash, dry friction and
noise, and with encoders that resolve everything, so that small motions are linear. The pose of rest is that of
`leg_model`; the leg is released close to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec
from mimics_app.lab.haptic.lokomat_rig import COMBINED, IMPEDANCE, Person, Rest, Rig
from mimics_app.lab.stability.growth import dies_away
from mimics_app.lab.stability.leg_model import (
    Leg,
    Press,
    combined_loop,
    impedance_loop,
    is_stable_but_for_a_neutral_way,
    leader_of_press,
    object_stiffness,
    rest_in_combined,
    rest_in_impedance,
)
from mimics_app.lab.stability.linear import find_limit
from mimics_app.rendering.haptic.control.lokomat.constrained_shafts import SurfaceFriction, place_shafts
from mimics_app.rendering.haptic.control.lokomat.foot_constraint import find_surface
from mimics_app.rendering.haptic.control.lokomat.leg_control import LEG_STATE
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import wall_outline
from mimics_app.rendering.haptic.devices.simulated_lokomat import SETTINGS
from mimics_app.rendering.haptic.kernels import two_link
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive, linkage, orthosis

__all__ = ["LegBench"]

_MACHINE = {
    "static_friction": 0.0, "coulomb_friction": 0.0, "backlash": 0.0, "rod_noise": 0.0, "rod_quantum": 0.0,
    "encoder": 0.0,
}  # fmt: skip
"""Settings of the device that make small motions linear."""

_ENDS = {IMPEDANCE: (1000.0, 1e6), COMBINED: (10.0, 1000.0)}
"""Ends of the search: stiffness of the wall [N/m]; bandwidth of the servo [rad/s]."""

_FALL = 1.5
"""Factor from one try to the next, softer one: the first stable one lies below the limit by no more."""

_APART, _LARGE = 1e-8, 1e-5
"""Distance from rest at the start [rad], and that from which a foot does not return [m]."""

_SHORTEST, _LONGEST = 2.0, 40.0
"""Lengths of the first and of the last simulation [s]."""

_PRECISION, _EXACT = 4e-3, 1e-3
"""Relative precision of a simulated and of an exact limit."""


@dataclass(frozen=True, slots=True)
class LegBench:
    """A pressed foot at one rate: the rig, and the numbers of it that `leg_model` needs."""

    rig: Rig
    leg: Leg
    press: Press

    @classmethod
    def at(cls, rate: int) -> LegBench:
        """Return a bench whose control runs at a rate [Hz], with the machine and the control of the product."""
        rig, press = Rig(dict(_MACHINE), rate), Press(rate=rate)
        leg = _numbers_of(rig)
        rig.settings["outline"] = wall_outline((float(leg.foot(np.array(press.pose))[0]), 0.0), (-1.0, 0.0))
        rig.settings["load"]["friction"], rig.settings["foot"]["damping"] = press.compensation, press.damping
        rig.settings["shafts"]["mass"], rig.settings["shafts"]["damping"] = press.virtual_mass, press.virtual_damping
        rig.settings["shafts"]["friction"] = 0.0
        rig.settings["surface"]["friction"], rig.settings["surface"]["mu"] = SurfaceFriction.COULOMB, 1.0
        rig.settings["surface"]["anchor"] = press.anchor
        return cls(rig, leg, press)

    def stiffness(self, kind: int, value: float) -> float:
        """Stiffness of the wall [N/m] by what is searched, see `_ENDS`."""
        return value if kind == IMPEDANCE else object_stiffness(self.leg, self.press, value)

    def exact_limit(self, kind: int) -> float:
        """Return the limit of what is searched under a control, see `_ENDS`, by eigenvalues; 0: none."""
        loop = impedance_loop if kind == IMPEDANCE else combined_loop
        return _limit(kind, lambda v: is_stable_but_for_a_neutral_way(loop(self.leg, self.press, v)), _EXACT)

    def simulated_limit(self, kind: int) -> float:
        """Return the same by simulation."""
        return _limit(kind, lambda value: self.is_stable(kind, value), _PRECISION)

    def is_stable(self, kind: int, value: float) -> bool:
        """Whether the foot comes to rest, by simulation."""
        rig, leg, press = self.rig, self.leg, self.press
        state = np.zeros(1, LEG_STATE)
        if kind == IMPEDANCE:
            rig.settings["foot"]["stiffness"] = value
            q, tau = rest_in_impedance(leg, press, value)
        else:
            rig.settings["position"]["bandwidth"] = value
            q, tau, drag = rest_in_combined(leg, press, value)
            _place_virtual(state, rig, press, leader_of_press(leg, press), drag)
        place = float(leg.foot(q)[0])
        person = Person(force=(press.force, 0.0), damping=leg.person)
        start, rest = (float(q[0]) + _APART, float(q[1])), Rest((float(tau[0]), float(tau[1])), state)

        def run(ticks: int) -> Vec:
            away = np.abs(rig.run(kind, person, ticks / rig.rate, start, rest)["x_real"] - place)
            peaks = np.array([quarter.max() for quarter in np.array_split(away, 4)])
            beyond = ~(np.maximum.accumulate(peaks) < _LARGE)
            peaks[beyond] = np.inf
            return peaks

        return dies_away(run, round(_SHORTEST * rig.rate), round(_LONGEST * rig.rate))


def _limit(kind: int, is_stable: Callable[[float], bool], precision: float) -> float:
    """Return the largest stable value of what is searched; 0: none."""
    softest, unstable = _ENDS[kind]
    while not is_stable(tried := unstable / _FALL):
        unstable = tried
        if unstable < softest:
            return 0.0
    return find_limit(is_stable, tried, unstable, precision)


def _place_virtual(state: NDArray[Any], rig: Rig, press: Press, leader: int, drag: float) -> None:
    """Put the virtual leg at the border of the wall, at rest, held along it by friction."""
    shafts = state["shafts"][0]
    frame = rig.settings["frame"][0]
    eta = np.array([linkage.eta_of(frame["links"][joint], press.pose[joint]) for joint in range(2)])
    state["started"] = 1
    place_shafts(shafts, frame, eta)
    find_surface(frame, rig.settings["outline"][0], shafts["theta"], shafts["surface"])
    shafts["touching"], shafts["leader"], shafts["normal_force"] = 1, leader, press.force
    shafts["way"], shafts["anchor"]["touching"] = -drag / press.anchor, 1


def _numbers_of(rig: Rig) -> Leg:
    """Return the numbers of a rig's leg, and of the person in it."""
    own, links, worn = rig.leg, rig.leg[: two_link.LINKS], rig.settings["load"]["links"][0]
    drives = [own[orthosis.DRIVES + joint * linear_drive.DRIVE :][: linear_drive.DRIVE] for joint in range(2)]

    def of_drives(place: int) -> Vec:
        return np.array([drive[place] for drive in drives])

    def of_links(thigh: int, shank: int) -> Vec:
        return np.array([links[thigh], links[shank]])

    masses = of_links(two_link.THIGH_MASS, two_link.SHANK_MASS)
    return Leg(
        lengths=np.array(rig.settings["frame"]["geometry"][0, 1:4]),
        masses=masses,
        coms=of_links(two_link.THIGH_COM, two_link.SHANK_COM),
        inertias=of_links(two_link.THIGH_INERTIA, two_link.SHANK_INERTIA),
        worn=np.array([worn[two_link.THIGH_MASS], worn[two_link.SHANK_MASS]]) / masses,
        fixed=of_drives(linkage.FIXED_ARM),
        moved=of_drives(linkage.MOVED_ARM),
        offset=of_drives(linkage.OFFSET),
        spindle=of_drives(linear_drive.MASS),
        viscous=of_drives(linear_drive.VISCOUS),
        rod=np.array([of_drives(linear_drive.ROD_STIFFNESS), of_drives(linear_drive.ROD_DAMPING)]),
        bearing=SETTINGS["bearing_damping"],
        person=Person().damping,
    )
