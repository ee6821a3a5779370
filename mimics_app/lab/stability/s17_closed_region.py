"""S17: the region of stable contacts in the plane of stiffness and damping, closed on both sides.

For a light device that takes forces (0.2 kg) and a virtual mass of 3 kg behind a servo, at 500, 1000 and 2000 Hz, with
three filters of the velocity and delays of 0 to 3 ticks. More damping raises the largest stable stiffness only up to
a peak, and beyond a finite damping no stiffness is stable: (b + B) / (T/2 + delay), the common rule, grows for ever.
An arm makes the region larger where it is stiff, by up to four times, and smaller by less than the cap's margin near
its end: the live limit assumes a limp hand.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.lab.experiment import Experiment, Outcome, Points, Row, curves_of, points_of
from mimics_app.lab.stability.region_loop import Hand, Loop, exact_limit, is_stable, simulated_limit
from mimics_app.rendering.haptic.kernels.closed_region import (
    REGION,
    curve_end,
    curve_point,
    find_region,
    stiffness_limit,
)

__all__ = ["EXPERIMENT", "compare", "damping_at_end", "live_limit"]

_RATES = (500.0, 1000.0, 2000.0)
_FILTERS = (0.0, 1.0, 3.0)
"""Time constants of the velocity filter [ticks]."""

_DELAYS = (0, 1, 2, 3)
_DEVICES = (Loop(0.2, 1.5), Loop(3.0, 5.0, driven=True))
_DRAWN = Loop(0.2, 1.5, filtering=1e-3)
_ARM = Hand(1.5, 20.0, 400.0)
_CAPPED = 1.2
"""Largest stable stiffness over that which the cap leaves [-]."""

_NEAR = 0.5, 2.0
"""Shares of the curve's stiffness that are stable and not."""


def _arguments(loop: Loop) -> tuple[float, float, int, float, float, float, float]:
    lag = loop.lag if loop.driven else 0.0
    period = 1.0 / loop.rate
    return loop.mass, loop.damping, int(loop.driven), period, loop.delay * period + lag, lag, loop.filtering


def damping_at_end(loop: Loop) -> float:
    """Return the damping at which the region ends [N s/m]."""
    return float(curve_point(curve_end(*_arguments(loop)), *_arguments(loop))[1])


def _curve(loop: Loop, damping: float) -> float:
    """Return the stiffness of the curve at a damping >= 0 [N/m], by bisection along it."""
    args = _arguments(loop)
    low, high = 0.0, curve_end(*args)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if curve_point(middle, *args)[1] < damping else (low, middle)
    return float(curve_point(high, *args)[0])


def live_limit(loop: Loop, damping: float) -> float:
    """Return the largest stiffness that the loop of the product allows at a damping [N/m]."""
    scene, region = np.zeros(1, SCENE)[0], np.zeros(1, REGION)[0]
    mass, own, driven, period, delay, lag, filtering = _arguments(loop)
    scene["force_driven"], scene["device_lag"], scene["device_filter"] = 1 - driven, lag, filtering
    scene["virtual_mass" if driven else "device_mass"] = mass
    scene["virtual_damping" if driven else "device_damping"] = own
    find_region(scene, delay, period, region)
    return float(stiffness_limit(region, damping))


def compare(loop: Loop, share: float) -> Row:
    """Return a row: limits at a share of the damping at which the region ends [N/m]."""
    damping = share * damping_at_end(loop)
    near = _curve(loop, damping)
    soft, hard = _NEAR[0] * near, _NEAR[1] * near
    simulated, exact = simulated_limit(loop, damping, soft, hard), exact_limit(loop, damping, soft, hard)
    return {
        "device": "takes velocities" if loop.driven else "takes forces",
        "mass_kg": loop.mass,
        "rate_hz": loop.rate,
        "filter_ticks": loop.filtering * loop.rate,
        "delay_ticks": loop.delay,
        "wall_damping_ns_m": damping,
        "simulated_n_m": simulated,
        "exact_n_m": exact,
        "live_n_m": live_limit(loop, damping),
        "difference": abs(simulated / exact - 1.0),
    }


def _loops(points: int) -> Iterator[Loop]:
    """The grid; with few points one rate, filter and delay after the other instead of all of them together."""
    grid = [(rate, ticks, n) for rate in _RATES for ticks in _FILTERS for n in _DELAYS]
    chosen = grid if points > 2 else grid[:: max(1, len(grid) // 5)]
    for device in _DEVICES:
        for rate, ticks, delay in chosen:
            yield replace(device, rate=rate, filtering=ticks / rate, delay=delay)


def _holds_with_an_arm(loop: Loop) -> bool:
    """Whether what the cap leaves of contacts of a limp hand is stable with an arm, too."""
    held = replace(loop, hand=_ARM)
    dampings = [share * damping_at_end(loop) for share in (0.1, 0.4, 0.7, 0.9)]
    return all(is_stable(held, _curve(loop, B) / _CAPPED, B / _CAPPED) for B in dampings)


def _simulate_grid(points: int) -> Outcome:
    rows = [compare(loop, float(s)) for loop in _loops(points) for s in np.linspace(0.05, 0.9, max(2, points // 2))]
    drawn = [compare(replace(_DRAWN, delay=n), float(s)) for n in _DELAYS for s in np.linspace(0.02, 0.97, points + 4)]
    simulated, exact = curves_of(drawn, "wall_damping_ns_m", "simulated_n_m", "exact_n_m")
    below = all(row["live_n_m"] <= 1.002 * row["exact_n_m"] for row in rows + drawn)
    held = all(_holds_with_an_arm(replace(device, filtering=1e-3)) for device in _DEVICES)
    return Outcome(
        rows + drawn,
        simulated,
        exact,
        rules={**_rules(), **_live(drawn)},
        holds=below and held,
        note="0.2 kg, 1.5 N s/m, 1 kHz, filter of 1 ms; delays of 0 to 3 ticks from the largest region to the "
        f"smallest, which ends at {damping_at_end(replace(_DRAWN, delay=3)):.0f} N s/m. The table has both kinds of "
        "device at three rates, with three filters. What the cap leaves is stable with an arm of 1.5 kg, too.",
    )


def _rules() -> dict[str, Points]:
    top = max(_curve(replace(_DRAWN, delay=1), B) for B in np.linspace(0.0, damping_at_end(_DRAWN), 30)[:-1])
    line = [(0.0, _rule(0.0)), (top * 1.5e-3 - _DRAWN.damping, top)]
    return {"(b + B)/(T/2 + nT), n = 1": line}


def _rule(damping: float) -> float:
    return (_DRAWN.damping + damping) * _DRAWN.rate / 1.5


def _live(drawn: list[Row]) -> dict[str, Points]:
    return {
        "live limit, n = 1": points_of(
            (row for row in drawn if row["delay_ticks"] == 1), "wall_damping_ns_m", "live_n_m"
        )
    }


EXPERIMENT = Experiment(
    title="Closed region of stable contacts",
    claim="A sampled contact is stable exactly inside a region that is closed in its damping as in its stiffness.",
    x_label="damping of the contact B [N s/m]",
    y_label="stiffness of the contact K [N/m]",
    kind="boundary",
    simulate=_simulate_grid,
)
