"""Stable contacts of the sampled loop: a closed region in the plane of stiffness K and damping B.

Device and law are one loop: 1 + G(z) (K + B V(z)) = 0, with G from force to position, force held for a period T and
late by the delay, and V the velocity estimate. On z = e^{i theta} that is one point of the plane for each frequency
(D-decomposition, Neimark 1948):

    B = Im(-1/G) / Im V,    K = Re(-1/G) - B Re V

From (0, -b) at theta = 0 the curve rises along the linear condition K = (b + B) / (T/2 + delay) (`stability`), has a
peak, and returns to K = 0 at a finite damping: beyond it no contact is stable, however soft.

    takes forces      G: a mass m with friction b, exactly held
    takes velocities  G: the virtual mass m with damping b (semi-implicit), then servo and integration
    both              V: backward difference, then the first-order filter of the velocity

The device is alone or has a limp hand with damping b: that is the worst hand but for the end of the region, where an
arm takes less than the margin of the cap (lab/stability, S17). The region is kept as half-planes a K + c B <= d: the
first is the linear condition, the others join points of the curve, which is concave: the polygon lies inside.

The last one is no limit of stability: a damper multiplies the steps of an encoder by B / T, which is felt as noise.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels.controller_slot import renders_force
from mimics_app.rendering.haptic.kernels.stability import LARGEST_MARGIN, margin_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import RegionRecord, SceneRecord

__all__ = [
    "REGION",
    "SIDES",
    "contact_share",
    "curve_end",
    "curve_point",
    "find_region",
    "region_margin",
    "side_margin",
    "stiffness_limit",
]

_PLACES = (0.03, 0.07, 0.15, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0)
"""Corners of the polygon, as shares of the frequency at which the curve ends."""

SIDES = len(_PLACES) + 1
"""Half-planes of a region: the linear condition, one less than corners, and the noise of the encoders."""

_RIPPLE = 0.4
"""Largest root mean square, within 20 to 300 Hz and over all speeds, of the velocity of a moving encoder, in quanta per
period and shares of them that the filter closes in one: 0.32 alone, and a quarter for what the loop answers [-]."""

_PERCEIVED = 0.5
"""Root mean square of a force that nobody minds [N]."""

REGION = np.dtype(
    [
        ("known", "i8"),  # 1 once the numbers below are valid
        ("period", "f8"),  # they are for: period [s],
        ("delay", "f8"),  # delay [s],
        ("mass", "f8"),  # mass [kg],
        ("damping", "f8"),  # damping b [N s/m],
        ("quantum", "f8"),  # resolution of its position [m]
        ("driven", "i8"),  # and kind of device: 1 takes velocities
        ("most_damping", "f8"),  # B at which the curve ends [N s/m]
        ("best_damping", "f8"),  # B at its peak [N s/m]
        ("viscosity", "f8"),  # damping rendered with every force [N s/m], part of every B
        ("stiffness_factor", "f8", (SIDES,)),  # a
        ("damping_factor", "f8", (SIDES,)),  # c
        ("bound", "f8", (SIDES,)),  # d, less the part of `viscosity`
        ("edge", "f8", (SIDES,)),  # d of the curve
    ],
    align=True,
)
"""Region of one device at present; zeros are the initial state."""

_CHANGE = 2e-3
"""Relative change of period or delay from which the curve is followed again [-]."""

_HALVINGS = 20
_GROWTH = 1.25
_SURELY = 1.3
"""Factor below the angle at which the lags alone, each as long as possible, turn the curve back."""

_NOTHING = 1e-15
"""Factor of a side that limits no stiffness below its reciprocal [m/N]."""

_SMALL = 1e-3
"""Product b T / m below which the exact plant is taken from its series [-]."""

_FIRST, _SECOND = (1.0 / 2.0, -1.0 / 6.0, 1.0 / 24.0), (1.0 / 2.0, -1.0 / 3.0, 1.0 / 8.0)
"""Series of (1 - (1 - e^-h) / h) / h and of ((1 - e^-h) / h - e^-h) / h in powers of h."""


@kernel
def _pole(time: float, period: float) -> float:
    """Share of a first-order lag [s] that one period closes, 0-1; 1 without a lag."""
    return 1.0 - math.exp(-period / time) if time > 0.0 else 1.0


@kernel
def _mass_inverse(z: complex, mass: float, damping: float, T: float) -> complex:
    """1/G of a mass with friction under a force held for a period."""
    h = damping * T / mass
    keep = math.exp(-h)
    if h < _SMALL:
        first = _FIRST[0] + h * (_FIRST[1] + h * _FIRST[2])
        second = _SECOND[0] + h * (_SECOND[1] + h * _SECOND[2])
    else:
        lost = (1.0 - keep) / h
        first, second = (1.0 - lost) / h, (lost - keep) / h
    return mass / (T * T) * (z - 1.0) * (z - keep) / (first * z + second)


@kernel
def _servo_inverse(z: complex, mass: float, damping: float, lag: float, T: float) -> complex:
    """1/G of a virtual mass whose velocity a servo with a lag follows."""
    speed = mass / T * (1.0 - (1.0 - damping * T / mass) / z)
    if lag <= 0.0:
        return speed * (z - 1.0) / T
    share = _pole(lag, T)
    return speed * (z - 1.0) * (z - 1.0 + share) / (share * 0.5 * T * (z + 1.0))


@kernel
def curve_point(
    theta: float, mass: float, damping: float, driven: int, T: float, delay: float, lag: float, filtering: float
) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] at which an eigenvalue of the loop is e^{i theta}.

    Args:
        theta: Angle of a period, 0 < theta < pi [rad].
        mass: Mass of the device, or its virtual mass [kg].
        damping: Damping b of that mass [N s/m].
        driven: 1: the device takes velocities, 0: forces.
        T: Period [s].
        delay: From a command to its motion, with the servo's lag [s].
        lag: Part of it that is a first-order lag of a servo [s].
        filtering: Time constant of the filter of the measured velocity [s].
    """
    z = complex(math.cos(theta), math.sin(theta))
    if driven == 1:
        inverse = _servo_inverse(z, mass, damping, lag, T)
        late = max(0.0, delay - lag) if lag > 0.0 else delay + 0.5 * T  # a servo without lag is unknown, not ideal
    else:
        inverse, late = _mass_inverse(z, mass, damping, T), delay
    turned = theta * late / T
    inverse *= complex(math.cos(turned), math.sin(turned))
    share = _pole(filtering, T)
    speed = (1.0 - 1.0 / z) / T * share / (1.0 - (1.0 - share) / z)
    B = -inverse.imag / speed.imag
    return -inverse.real - B * speed.real, B


@kernel
def curve_end(mass: float, damping: float, driven: int, T: float, delay: float, lag: float, filtering: float) -> float:
    """Angle at which the curve returns to K = 0 [rad]; arguments as of `curve_point`."""
    low = 0.0
    high = 0.5 * math.pi / (_SURELY * (1.0 + (delay + filtering) / T))
    while high < math.pi and curve_point(high, mass, damping, driven, T, delay, lag, filtering)[0] > 0.0:
        low, high = high, high * _GROWTH
    high = min(high, math.pi)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if curve_point(middle, mass, damping, driven, T, delay, lag, filtering)[0] > 0.0:
            low = middle
        else:
            high = middle
    return low


@kernel
def _follow_curve(region: RegionRecord, lag: float, filtering: float) -> None:
    """Set the sides of the polygon behind the first, `most_damping` and `best_damping`."""
    m, b, driven, T, delay = region.mass, region.damping, region.driven, region.period, region.delay
    end = curve_end(m, b, driven, T, delay, lag, filtering)
    K, B = curve_point(_PLACES[0] * end, m, b, driven, T, delay, lag, filtering)
    peak = 0.0
    for i in range(1, len(_PLACES)):
        k, damping = curve_point(_PLACES[i] * end, m, b, driven, T, delay, lag, filtering)
        turns_back = damping <= B  # where much own damping makes the linear condition the stricter one
        region.stiffness_factor[i] = _NOTHING if turns_back else damping - B
        region.damping_factor[i] = 0.0 if turns_back else K - k
        region.edge[i] = 1.0 if turns_back else K * (damping - B) + B * (K - k)
        if k > peak:
            peak = k
            region.best_damping = max(0.0, damping)
        K, B = k, damping
    region.most_damping = max(0.0, B)


@kernel
def _bound_noise(region: RegionRecord, filtering: float) -> None:
    """Set the last side: the damping at which the steps of the encoder are felt."""
    noise = _RIPPLE * _pole(filtering, region.period) * region.quantum / region.period  # [m/s]
    region.stiffness_factor[SIDES - 1] = _NOTHING
    region.damping_factor[SIDES - 1] = 1.0 if noise > 0.0 else 0.0
    region.edge[SIDES - 1] = _PERCEIVED / noise if noise > 0.0 else 1.0


@kernel
def _has_changed(last: float, now: float) -> bool:
    return abs(now - last) > _CHANGE * last


@kernel
def find_region(scene: SceneRecord, delay: float, period: float, region: RegionRecord) -> None:
    """Set the region for the present parameters, period and delay; the curve is followed only where they changed.

    A device that takes forces and whose mass is not known (0) has the linear condition alone, and so has one whose
    lag is below 0: that of an older recording.

    Args:
        scene: SCENE record.
        delay: From a command to its motion [s].
        period: Measured period [s] > 0.
        region: REGION record, updated.
    """
    driven = 0 if scene.force_driven == 1 else 1
    mass = scene.virtual_mass if driven == 1 else scene.device_mass
    if scene.device_lag < 0.0:  # a recording from before the region: nothing but the delay is known
        mass = 0.0
    rendered = scene.virtual_damping if renders_force(scene) else 0.0
    own = scene.virtual_damping + scene.device_damping + scene.arm_damping
    same = region.known == 1 and region.mass == mass and region.damping == own - rendered and region.driven == driven
    same = same and region.quantum == scene.device_quantum
    changed = not same or _has_changed(region.period, period) or _has_changed(region.delay, delay)
    if changed:
        region.known, region.period, region.delay = 1, period, delay
        region.mass, region.damping, region.driven = mass, own - rendered, driven
        region.quantum = scene.device_quantum
        region.most_damping = region.best_damping = math.inf
        if mass > 0.0:
            _follow_curve(region, scene.device_lag, scene.device_filter)
            _bound_noise(region, scene.device_filter)
    last, region.viscosity = region.viscosity, rendered
    if scene.cap == 1:
        region.viscosity = min(rendered, region.most_damping / (1.0 + scene.cap_margin))
    region.stiffness_factor[0] = 0.5 * period + delay
    region.damping_factor[0] = -1.0
    region.bound[0] = own - (rendered - region.viscosity)
    if not changed and region.viscosity == last:
        return
    for i in range(1, SIDES):
        region.bound[i] = region.edge[i] - region.damping_factor[i] * region.viscosity


@kernel
def sides_of(region: RegionRecord) -> int:
    """Number of half-planes: one while the mass is not known."""
    return SIDES if region.mass > 0.0 else 1


@kernel
def stiffness_limit(region: RegionRecord, damping: float) -> float:
    """Largest stable stiffness [N/m] of a contact with a damping [N s/m]; 0: none is stable."""
    limit = math.inf
    for i in range(sides_of(region)):
        limit = min(limit, (region.bound[i] - region.damping_factor[i] * damping) / region.stiffness_factor[i])
    return max(0.0, limit)


@kernel
def contact_share(region: RegionRecord, stiffness: float, damping: float, margin: float) -> float:
    """Largest share s, 0-1, of a contact, spring and damper alike, that keeps a margin to every side of the region.

    From s (a K (1 + margin) + c B) <= d, where the margin counts for B too if more damping is unfavourable.

    Args:
        region: REGION record.
        stiffness: K [N/m].
        damping: B [N s/m].
        margin: Stability margin to keep [-].
    """
    share = 1.0
    for i in range(sides_of(region)):
        more = damping * (1.0 + margin) if region.damping_factor[i] > 0.0 else damping
        need = stiffness * region.stiffness_factor[i] * (1.0 + margin) + region.damping_factor[i] * more
        share = min(share, share_of(need, region.bound[i]))
    return share


@kernel
def share_of(need: float, bound: float) -> float:
    """Share 0-1 of what needs more than its bound."""
    return max(0.0, bound) / need if need > bound and need > 0.0 else 1.0


@kernel
def side_margin(a: float, c: float, bound: float, stiffness: float, damping: float) -> float:
    """Margin [-] to one half-plane: the share by which the stiffness, or all that is unfavourable, may grow."""
    if c > 0.0:
        return margin_of(bound, a * stiffness + c * damping)
    return margin_of((bound - c * damping) / a, stiffness)


@kernel
def region_margin(region: RegionRecord, stiffness: float, damping: float) -> float:
    """Stability margin [-] of a contact, the smallest of all sides, at most LARGEST_MARGIN; below 0: outside."""
    margin = LARGEST_MARGIN
    for i in range(sides_of(region)):
        a, c, d = region.stiffness_factor[i], region.damping_factor[i], region.bound[i]
        margin = min(margin, side_margin(a, c, d, stiffness, damping))
    return margin
