"""Whatever comes in, a finite force inside every limit goes out: a million cases inside one compiled loop."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.maths.vec import norm
from mimics_app.rendering.haptic.kernels.limiter import brake_at_limits, decay, limit_force
from mimics_app.rendering.haptic.kernels.noise import seed_noise, uniform

REST = np.zeros(3)
SHARES = np.zeros(2)

ROUNDING = 1e-12
"""Relative: a dozen operations of 1e-16 each, with a wide margin."""


@kernel
def _nasty(noise):
    """A number of any size, sign and kind: one in eight is NaN, infinite, huge, zero or denormal."""
    kind = int(uniform(noise, 0) * 40)
    if kind == 0:
        return math.nan
    if kind == 1:
        return math.inf
    if kind == 2:
        return -math.inf
    if kind == 3:
        return 0.0
    if kind == 4:
        return 1e308 * (uniform(noise, 0) - 0.5)
    return (uniform(noise, 0) - 0.5) * 10.0 ** (uniform(noise, 0) * 12.0 - 6.0)


@kernel
def _size(f):
    """Length without overflow: the limiter's own numbers may be as large as a float goes."""
    largest = max(abs(f[0]), abs(f[1]), abs(f[2]))
    return largest * norm(f / largest) if 0.0 < largest < math.inf else largest


@kernel
def _beyond_fall(f, last, wanted, rise):
    """Distance of f from the segment between zero and the last force, less the rise; found by trial of its points."""
    best = math.inf
    for k in range(1001):
        share = k / 1000.0
        gap = norm(f - share * last)
        best = min(best, gap)
    return best - rise


@kernel
def _violations(seed, cases, counts):
    """counts: NaN out, too much, changed too fast, turned, not zero when refused, refused, passed, power too much.

    Then what was reached: held by the force limit, by the rise, by the power, by the ramp.
    """
    noise = np.zeros(1)
    seed_noise(noise, 0, seed)
    f, wanted, v = np.zeros(3), np.zeros(3), np.zeros(3)
    last, shares = np.zeros(3), np.zeros(2)
    for _ in range(cases):
        for i in range(3):
            wanted[i] = _nasty(noise)
        limit = abs(_nasty(noise))
        rise = abs(_nasty(noise))
        ramp = uniform(noise, 0) * 1.5 - 0.2 if uniform(noise, 0) > 0.05 else _nasty(noise)
        last[:] = f
        for i in range(3):
            v[i] = _nasty(noise) if uniform(noise, 0) < 0.01 else 4.0 * uniform(noise, 0) - 2.0
        power = abs(_nasty(noise)) * (1.0 if uniform(noise, 0) < 0.5 else 1e9)
        accepted = limit_force(wanted, ramp, limit, rise, v, power, f, shares)
        size = _size(f)
        if not math.isfinite(f[0] + f[1] + f[2]):
            counts[0] += 1
            f[:] = 0.0
            continue
        if not accepted:
            counts[5] += 1
            if size != 0.0:
                counts[4] += 1
            continue
        before = _size(last)
        if size > limit * (1.0 + ROUNDING):
            counts[1] += 1
        if size > (before + rise) * (1.0 + ROUNDING):
            counts[2] += 1
        if max(before, size) < 1e100 and uniform(noise, 0) < 0.002:
            spare = 1e-3 * before  # of the trial's points, next to which the nearest one lies
            counts[2] += 1 if _beyond_fall(f, last, wanted, rise) > spare + ROUNDING * size else 0
        spread = ROUNDING * size * (abs(v[0]) + abs(v[1]) + abs(v[2]))  # large parts may cancel
        if abs(f[0] * v[0] + f[1] * v[1] + f[2] * v[2]) > power + spread:
            counts[7] += 1
        for i in range(3 if _size(wanted) < 1e100 else 0):
            told = shares[0] * last[i] + shares[1] * wanted[i]
            room = 10.0 * ROUNDING * (shares[0] * before + abs(shares[1]) * _size(wanted)) + 1e-280
            counts[3] += 1 if abs(f[i] - told) > room else 0
        if size > 0.0:
            counts[8] += 1 if size >= limit * (1.0 - ROUNDING) else 0
            counts[9] += 1 if shares[0] > 0.0 or (rise > 0.0 and abs(size - rise) <= ROUNDING * size) else 0
            along = abs(f[0] * v[0] + f[1] * v[1] + f[2] * v[2])
            counts[10] += 1 if abs(along - power) <= 10.0 * ROUNDING * power else 0
            counts[11] += 1 if ramp < 1.0 and abs(size - ramp * norm(wanted)) <= ROUNDING * size else 0
        if ramp >= 1.0 and _size(wanted) < 1e100 and abs(size - norm(wanted)) <= ROUNDING * size and size > 0.0:
            counts[6] += 1
        if size > 1e150:
            f[:] = 0.0


def _check(seed: int, cases: int) -> None:
    counts = np.zeros(12, np.int64)
    _violations(seed, cases, counts)
    assert counts[:5].tolist() == [0] * 5 and counts[7] == 0
    reached = dict(zip(("refused", "passed"), counts[5:7].tolist(), strict=True))
    reached |= dict(zip(("force", "rise", "power", "ramp"), counts[8:].tolist(), strict=True))
    floors = {"refused": 0.1, "passed": 0.005, "force": 0.03, "rise": 0.1, "power": 0.05, "ramp": 0.01}
    assert all(reached[name] >= share * cases for name, share in floors.items()), reached


@pytest.mark.requirement("R01")
def test_a_million_forces():
    _check(20240, 1_000_000)


@pytest.mark.slow
def test_a_hundred_million_forces():
    _check(7, 100_000_000)


@pytest.mark.parametrize("limit", [math.nan, math.inf, -1.0])
def test_a_limit_that_is_no_limit_lets_nothing_pass(limit: float):
    for force, rise, power in ((limit, 1.0, 1.0), (1.0, limit, 1.0), (1.0, 1.0, limit)):
        f = np.array([0.1, 0.0, 0.0])
        assert not limit_force(np.array([1.0, 0.0, 0.0]), 1.0, force, rise, REST, power, f, SHARES)
        assert np.all(f == 0.0)


def _limited(last: tuple[float, ...], wanted: tuple[float, ...], rise: float = 2.0) -> np.ndarray:
    f = np.array(last)
    assert limit_force(np.array(wanted), 1.0, 60.0, rise, REST, 1.0, f, SHARES)
    return f


@pytest.mark.parametrize(
    ("last", "wanted", "felt"),
    [
        ((0.0, 50.0, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)),  # a fall is free
        ((0.0, 50.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)),  # to zero, and from there
        ((0.0, 50.0, 0.0), (0.0, 60.0, 0.0), (0.0, 52.0, 0.0)),
        ((60.0, 0.0, 0.0), (-60.0, 0.0, 0.0), (-2.0, 0.0, 0.0)),  # a reversal is a fall and a rise
        ((0.0, 30.0, 0.0), (40.0, 30.0, 0.0), (2.0, 30.0, 0.0)),  # a turn is a rise beside the force that stays
        ((0.0, 30.0, 0.0), (40.0, 10.0, 0.0), (2.0, 10.0, 0.0)),  # and beside the one that falls
    ],
)
@pytest.mark.requirement("R02")
def test_a_fall_is_free_and_a_rise_a_turn_or_a_reversal_is_not(last, wanted, felt):
    """By hand: the nearest force between zero and the last one, then 2 N towards the wanted one."""
    assert _limited(last, wanted) == pytest.approx(np.array(felt), abs=1e-14)


def test_a_force_that_turns_arrives():
    f, wanted = np.array([0.0, 0.0, 20.0]), np.array([-20.0, 5.0, 0.0])
    for _ in range(40):
        assert limit_force(wanted, 1.0, 60.0, 2.0, REST, 1.0, f, SHARES)
    assert f.tolist() == wanted.tolist()


def test_overflowing_force_is_scaled_not_refused():
    f = np.zeros(3)
    assert limit_force(np.array([1e308, 1e308, 1e308]), 1.0, 60.0, 100.0, REST, 1.0, f, SHARES)
    assert norm(f) == pytest.approx(60.0, rel=1e-12)


@kernel
def _brake_violations(seed, cases):
    """Joints started inside their limits and driven by random wishes through an ideal servo.

    Returns (how often they get out, how often a wish was slowed, how often it was not).
    """
    noise = np.zeros(1)
    seed_noise(noise, 0, seed)
    low = np.array([-0.18, -0.5, -0.2])
    high = np.array([0.18, 0.5, 0.2])
    q = np.zeros(3)
    dq = np.zeros(3)
    wish = np.zeros(3)
    out, slowed, kept = 0, 0, 0
    for _ in range(cases):
        for i in range(3):
            wish[i] = (uniform(noise, 0) - 0.5) * 40.0
            dq[i] = wish[i]
        brake_at_limits(q, low, high, dq)
        for i in range(3):
            slowed += 1 if dq[i] != wish[i] else 0
            kept += 1 if dq[i] == wish[i] else 0
            q[i] += 1e-3 * dq[i]
            if not low[i] - 1e-15 <= q[i] <= high[i] + 1e-15:
                out += 1
    return out, slowed, kept


@pytest.mark.requirement("R04")
def test_no_wish_leads_a_joint_over_its_limit():
    out, slowed, kept = _brake_violations(5, 1_000_000)
    assert out == 0
    assert slowed >= 100_000 and kept >= 100_000


def test_a_joint_beyond_its_limit_may_come_back():
    dq = np.array([-0.3, 0.0, 0.4])
    assert brake_at_limits(np.array([0.19, 0.0, 0.21]), np.full(3, -0.18), np.full(3, 0.18), dq)
    assert dq.tolist() == [-0.3, 0.0, 0.0]


def test_settling_ends_at_exactly_zero():
    command = np.array([0.8, -2.0, math.nan])
    for _ in range(400):
        decay(command, 1e-3)
    assert np.all(command == 0.0)
