"""Extremes in the trial table are those of every tick of the travel: the recorded samples are the judge."""

from __future__ import annotations

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.contracts.messages.trial_state import TrialState


@pytest.mark.parametrize(("name", "patient"), [("wavy_tunnel", "severe"), ("examples/surfaces", "moderate")])
def test_extremes_of_a_trial_are_those_of_its_samples(name, patient):
    """A play of ten seconds of travel, cut off: its row is of the last frame's tick."""
    travels = 0
    with mimics.open(name, seed=3, patient=patient, record="memory") as session:
        while travels < 600:
            session.step()
            travels += session.orders.view.state is TrialState.TRAVEL
    row, samples = session.trials[-1], session.haptic
    travel = np.asarray(samples["t"]) > session.time_s - travels / 60.0
    felt = np.linalg.norm(samples["f_user_world"][travel], axis=1)
    in_frames = felt[16::17].max()
    assert in_frames < felt.max(), "frames would miss the peak"
    assert row["force_peak_n"] == pytest.approx(felt.max(), rel=1e-12)
    if name == "wavy_tunnel":
        assert row["path_error_max_m"] == pytest.approx(samples["distance"][travel].max(), rel=1e-12)
        assert row["progress"] == pytest.approx(samples["progress"][travel].max(), rel=1e-12)
    else:
        assert row["path_error_max_m"] is None
    assert row["contacts"] > 0
