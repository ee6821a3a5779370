"""The bench of the gait orthosis: keys that others read, and the goals that its figures have."""

from __future__ import annotations

import pytest

from mimics_app.lab.lokomat_bench import measure_lokomat

USUAL = 1800.0
"""Cost of the reference loop at which the goal of a tick counts [ns]."""


@pytest.mark.slow
def test_every_figure_of_the_bench_meets_its_goal() -> None:
    figures = measure_lokomat(lambda _: None)
    assert {"penetration", "slip_mm_s", "gait_rms_deg", "residual_torque_Nm"} <= set(figures)
    assert figures["tick_us"] * USUAL / figures["reference_ns"] <= 20.0
    for control in (figures["penetration"], *(figures["penetration"][name] for name in ("impedance", "combined"))):
        assert control["simulated"] == pytest.approx(control["theory"], rel=0.05)
    assert figures["slip_mm_s"] < 0.1
    assert figures["energy_drift"] <= 1e-6 and figures["constraint_drift_m"] <= 1e-9
    assert all(torque <= 1.5 for row in figures["residual_torque_Nm"]["impedance"].values() for torque in row.values())
    assert figures["sequence"]["violations"] == 0 and figures["sequence"]["states"] == 118
    # At 0.5 km/h the reference is extrapolated: its hip, 6.5 degrees from the second author's, is told and not judged.
    assert (
        max(row["degrees"] for row in figures["gait_rms_deg"] if row["kmh"] > 1.0 or "hip" not in row["table"]) <= 6.0
    )
