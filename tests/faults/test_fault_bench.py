"""`mimics bench faults`: each fault ends the force in its time, with a message, in a complete session."""

from __future__ import annotations

import pytest

from mimics_app.app.bench import fault_bench
from mimics_app.app.bench.fault_bench import measure_faults
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import TripCause
from mimics_app.contracts.system.resources import root


@pytest.mark.fault("F03")
def test_every_fault_during_contact_is_handled_as_stated():
    rows = measure_faults(root() / "scenes" / "wavy_tunnel.json", 1, lambda _: None)["rows"]
    failed = [row for row in rows if not row["passed"]]
    assert not failed
    stops = [row for row in rows if row["cause"] != TripCause.NONE.name]
    assert all(row["t_safe_ms"]["max"] <= row["bound_ms"] and row["told"] for row in stops)
    spike = next(row for row in rows if row["cause"] == TripCause.NONE.name)
    assert spike["force_max_n"] > 0.0 and "t_safe_ms" not in spike


def test_a_scene_in_which_nothing_is_touched_is_refused(monkeypatch):
    monkeypatch.setattr(fault_bench, "_SEARCHED_S", 0.5)
    with pytest.raises(UsageError, match="touches nothing"):
        measure_faults(root() / "scenes" / "guided_walk.json", 1, lambda _: None)
