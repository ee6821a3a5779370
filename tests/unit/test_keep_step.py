"""A simulated person in the gait orthosis falls into the step in which their legs are led, if they keep step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.rendering.haptic.devices.gait_people import write_person_in
from mimics_app.rendering.haptic.kernels.lokomat.gait_person import (
    KEEPS,
    PHASE,
    STRIDE,
    STRIDE_NOW,
    WALKER,
    intended,
    keep_step,
    move_walker,
)

TICK, LED = 1e-3, 2.0


@pytest.mark.parametrize(("keeps", "most"), [(2.0, 0.03), (0.0, 1.0)])
@pytest.mark.parametrize("share", [0.25, 1.0])
def test_who_keeps_step_is_in_it_after_some_strides(keeps: float, most: float, share: float) -> None:
    """Led at a stride of 2 s by a share of the own gait, begun 0.4 cycles apart; who does not keep it stays apart."""
    walker = np.zeros(WALKER)
    write_person_in(walker, "healthy", 75.0, 1000, 3)
    walker[STRIDE] = walker[STRIDE_NOW] = LED
    walker[KEEPS], led = keeps, walker[PHASE] + 0.4
    for _ in range(8000):
        led += TICK / LED
        left, left_rate = intended(walker, 0, led % 1.0)
        right, right_rate = intended(walker, 0, (led + 0.5) % 1.0)
        keep_step(walker, share * (left - right), share * (left_rate - right_rate) / LED, TICK)
        move_walker(walker, True, TICK)
    apart = abs(math.remainder(walker[PHASE] - led, 1.0))
    assert apart <= most and (keeps > 0.0 or apart > 0.2)
