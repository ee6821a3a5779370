"""The closed region of stable contacts against eigenvalues of the whole sampled loop, written out here in numpy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.signal import butter, lfilter, sosfilt

from mimics_app.contracts.loop.controller_slots import CommandKind, Lead, Slot
from mimics_app.rendering.haptic.kernels.closed_region import (
    contact_share,
    curve_end,
    curve_point,
    region_margin,
    stiffness_limit,
)
from tests.support.regions import region_of

T = 1e-3
SOFT = 1.0
"""Stiffness of a contact that is as good as a damper alone, but has a place [N/m]."""


@dataclass(frozen=True)
class Loop:
    """A device in a sampled contact: mass [kg], damping [N s/m], delay [ticks], filter and servo lag [s]."""

    driven: bool
    mass: float
    damping: float
    delay: int
    filtering: float = 0.0
    lag: float = 0.0
    period: float = T

    def _step(self, K: float, B: float, state: np.ndarray) -> np.ndarray:
        """One tick of x, v, last x, filtered speed, virtual speed, and the commands under way."""
        T, n = self.period, self.delay
        x, v, last, speed, virtual = state[:5]
        share = 1.0 - math.exp(-T / self.filtering) if self.filtering else 1.0
        speed += share * ((x - last) / T - speed)
        force = -K * x - B * speed
        virtual = virtual + T / self.mass * (force - self.damping * virtual) if self.driven else 0.0
        line = [virtual if self.driven else force, *state[5:]]
        acts = line[n]
        if self.driven:
            near = v + (acts - v) * (1.0 - math.exp(-T / self.lag))
            x, v = x + 0.5 * T * (v + near), near
        else:
            keep = math.exp(-self.damping * T / self.mass)
            steady, reach = acts / self.damping, (1.0 - keep) * self.mass / self.damping
            x, v = x + steady * T + (v - steady) * reach, steady + (v - steady) * keep
        return np.array([x, v, state[0], speed, virtual, *line[:n]])

    def radius(self, K: float, B: float) -> float:
        """Largest magnitude of an eigenvalue."""
        rows = [self._step(K, B, unit) for unit in np.eye(5 + self.delay)]
        return float(np.abs(np.linalg.eigvals(np.array(rows).T)).max())

    def share(self, K: float, B: float) -> float:
        """Largest s, up to 1, for which (s K, s B) is stable."""
        low, high = 0.0, 1.0
        if self.radius(K, B) < 1.0:
            return 1.0
        for _ in range(18):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.radius(middle * K, middle * B) < 1.0 - 1e-9 else (low, middle)
        return low

    def region(self, **more: float):
        fields = (
            {"virtual_mass": self.mass, "virtual_damping": self.damping, "device_lag": self.lag}
            if self.driven
            else {"force_driven": 1, "device_mass": self.mass, "device_damping": self.damping}
        )
        delay = self.delay * self.period + (self.lag if self.driven else 0.0)
        return region_of(delay, self.period, device_filter=self.filtering, **fields, **more)


LIGHT = Loop(False, 0.2, 1.5, 1, 1e-3)
ROBOT = Loop(True, 3.0, 5.0, 1, 1e-3, 2.65e-3)
LOOPS = [
    Loop(driven, 0.2 if not driven else 3.0, 1.5 if not driven else 5.0, delay, filtering * T, 2.65e-3, T)
    for driven in (False, True)
    for delay in (0, 1, 3)
    for filtering in (0.0, 2.0, 5.0)
]


@pytest.mark.parametrize("loop", [*LOOPS, Loop(False, 1.2, 3.0, 2, 2e-3, period=5e-4), Loop(False, 0.1, 1.0, 0)])
def test_region_lies_inside_the_stable_one_and_fills_most_of_it(loop: Loop):
    """From the plain spring to the plain damper: what the region allows is stable, and nowhere much less than that."""
    region = loop.region()
    unit_k, unit_b = 0.2 * loop.mass / loop.period**2, 3.0 * loop.mass / loop.period
    found = []
    for angle in np.linspace(0.0, 0.499 * math.pi, 7):
        K, B = unit_k * math.cos(angle), unit_b * math.sin(angle)
        allowed, stable = contact_share(region, K, B, 0.0), loop.share(K, B)
        assert allowed <= 1.001 * stable + 1e-4
        found.append((allowed + 1e-3) / (stable + 1e-3))
    assert min(found) > 0.45 and max(found) > 0.9


@pytest.mark.parametrize("loop", [LIGHT, ROBOT])
def test_no_contact_is_stable_beyond_the_end_of_the_curve(loop: Loop):
    """The old limit (b + B) / (T / 2 + delay) grew with the damping for ever; the loop ends at a finite one."""
    region = loop.region()
    most = float(region["most_damping"])
    assert stiffness_limit(region, 1.05 * most) == 0.0
    assert loop.radius(SOFT, 0.97 * most) < 1.0 < loop.radius(SOFT, 1.03 * most)
    assert region_margin(region, 500.0, 3.0 * most) < -0.5
    assert contact_share(region, 500.0, 3.0 * most, 0.2) == pytest.approx(1.0 / 3.6, rel=0.05)


@pytest.mark.parametrize("loop", [LIGHT, ROBOT])
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_every_point_of_the_curve_is_an_eigenvalue_on_the_unit_circle(loop: Loop, share: float):
    args = (loop.mass, loop.damping, int(loop.driven), T, loop.delay * T + loop.lag * loop.driven, loop.lag, 1e-3)
    theta = share * curve_end(*args)
    K, B = curve_point(theta, *args)
    rows = [loop._step(K, B, unit) for unit in np.eye(5 + loop.delay)]
    near = np.abs(np.linalg.eigvals(np.array(rows).T) - np.exp(1j * theta))
    assert near.min() < 1e-7


RENDERING = {"controller": Slot.PERSON, "leads": Lead.PERSON, "commands": CommandKind.FORCE}
"""Fields of SCENE of a controller by which the drives render the virtual force; the person's is in every slot."""


def test_damping_rendered_with_every_force_is_part_of_the_contacts():
    """40 N s/m of viscosity and 40 of a wall are as near to the end as 80 of a wall; alone it is bounded too."""
    apart = LIGHT.region(virtual_damping=40.0, **RENDERING)
    together = LIGHT.region()
    assert stiffness_limit(apart, 40.0) == pytest.approx(stiffness_limit(together, 80.0), rel=1e-9)
    wild = LIGHT.region(virtual_damping=4000.0, **RENDERING, cap=1, cap_margin=0.2)
    assert LIGHT.radius(SOFT, float(wild["viscosity"])) < 1.0


def test_unknown_mass_leaves_the_linear_condition():
    region = region_of(1e-3, T, force_driven=1, device_damping=2.0)
    assert stiffness_limit(region, 30.0) == pytest.approx(32.0 / 1.5e-3, rel=1e-12)


def _ripple(filtering: float, period: float) -> float:
    """Largest root mean square within 20 to 300 Hz of the velocity of a moving encoder, over all speeds [quanta/T]."""
    keep, ticks = math.exp(-period / filtering) if filtering > 0.0 else 0.0, np.arange(3000)
    band = butter(2, [20.0, 300.0], "band", fs=1.0 / period, output="sos")
    largest = 0.0
    for speed in np.linspace(0.03, 1.0, 80):
        steps = np.diff(np.floor(speed * ticks), prepend=0.0)
        velocity = lfilter([1.0 - keep], [1.0, -keep], steps)
        largest = max(largest, float(np.sqrt(np.mean(sosfilt(band, velocity)[500:] ** 2))))
    return largest


@pytest.mark.parametrize("filtering", [0.0, 0.5 * T, 1.06 * T, 2.0 * T, 5.0 * T])
def test_damping_ends_where_the_steps_of_an_encoder_are_felt(filtering: float):
    """0.5 N at the hand; the loop answers with up to a quarter more. An unknown, or fine, encoder limits nothing."""
    quantum = 1e-4
    region = region_of(T, T, force_driven=1, device_mass=50.0, device_filter=filtering, device_quantum=quantum)
    fine = region_of(T, T, force_driven=1, device_mass=50.0, device_filter=filtering)
    noise = _ripple(filtering, T) * quantum / T
    most = 0.5 / noise
    assert region_margin(region, 100.0, 0.65 * most) > 0.0 > region_margin(region, 100.0, most)
    assert region_margin(fine, 100.0, most) > 0.0
    assert contact_share(region, 100.0, 2.0 * most, 0.0) == pytest.approx(0.4, abs=0.08)
