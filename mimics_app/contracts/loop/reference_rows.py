"""Row of the reference of one joint: its curve over a cycle, and how it depends on speed or step.

    CURVE     main -> loop   one row for each joint of the device, in their order, beside SCENE; none: no reference

The reference of a joint is rest + amplitude (c(phase, u) - rest), with the curve c of its row and, for a series, the
speed or the step as u; see `rendering/haptic/reference`.
"""

from __future__ import annotations

from enum import IntEnum

from mimics_app.contracts.loop.bounded_fields import Bounded, choice_of, record

__all__ = ["CURVE", "MAX_CURVE", "POWERS", "CurveKind", "GrowsWith"]

MAX_CURVE = 128
"""Largest number of coefficients or knots of a curve: knots every 8 ms in a cycle of one second."""

POWERS = 3
"""Rows of numbers of a curve: the powers 0, 1, 2 of u of a series; knots and their second derivatives of a cubic."""


class CurveKind(IntEnum):
    """Kind of a curve over the cycle."""

    NONE = 0
    SERIES = 1
    CUBIC = 2
    LINEAR = 3


class GrowsWith(IntEnum):
    """Quantity on which the coefficients of a series depend."""

    NOTHING = 0
    SPEED = 1
    STEP = 2


CURVE = record(
    [
        ("kind", choice_of(CurveKind)),
        ("grows_with", choice_of(GrowsWith)),
        ("used", Bounded(MAX_CURVE)),  # coefficients or knots in use
        ("shift", "f8"),  # the joint's cycle begins so much later than the reference's [cycles]
        ("rest", "f8"),  # joint in standing [m, rad]
        ("least", "f8"),  # u is hypot(speed or step, least) [m/s, m]
        ("guidance", "f8"),  # share of SCENE.guidance that this joint gets [-]
        ("values", "f8", (POWERS, MAX_CURVE)),
        # of a series: coefficients [m, rad] of the powers of u, each mean, then cosine and sine of every harmonic; of a
        # table: knots at even phases [m, rad]; of a cubic one, too, their second derivatives [per cycle^2]
    ]
)
"""Reference of one joint."""
