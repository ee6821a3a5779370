"""Extremes in the trial table are those of every tick of the travel: the recorded samples are the judge."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.messages.trial_state import TrialState
from tests.support.core_play import CorePlay


@pytest.mark.parametrize(("name", "patient"), [("wavy_tunnel", "severe"), ("examples/surfaces", "moderate")])
def test_extremes_of_a_trial_are_those_of_its_samples(name, patient):
    """A play of ten seconds of travel, cut off: its row is of the last frame's tick."""
    play = CorePlay.of(load_checked_scene(name), 3, patient=patient)
    travels = 0
    while travels < 600:
        play.step()
        travels += play.frames.orders.view.state is TrialState.TRAVEL
    first = play.frames.number - travels
    play.core.tasks.end_session(play.core.clock.now_ns())
    row, samples = play.core.tasks.rows[-1], play.samples
    travel = samples[samples["t"] > first / 60.0]
    felt = np.linalg.norm(travel["f_user_world"], axis=1)
    in_frames = felt[16::17].max()
    assert in_frames < felt.max(), "frames would miss the peak"
    assert row["force_peak_n"] == pytest.approx(felt.max(), rel=1e-12)
    if name == "wavy_tunnel":
        assert row["path_error_max_m"] == pytest.approx(travel["distance"].max(), rel=1e-12)
        assert row["progress"] == pytest.approx(travel["progress"].max(), rel=1e-12)
    else:
        assert row["path_error_max_m"] is None
    assert row["contacts"] > 0
