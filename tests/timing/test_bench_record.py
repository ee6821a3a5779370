"""`mimics bench record`: what a killed session loses, end to end with the real application."""

from __future__ import annotations

import json

import pytest

from tests.support.command import mimics

MOST_LOST_MS = 100.0


@pytest.mark.slow
def test_a_killed_session_loses_at_most_a_tenth_of_a_second_and_no_trial():
    answer = mimics("bench", "record", "--n", "2", "--json")
    assert answer.returncode == 0, answer.stderr
    row = json.loads(answer.stdout)
    assert row["kills"] == row["readable"] == 4
    assert row["trials_lost"] == 0
    assert row["lost_ms"]["max"] <= MOST_LOST_MS
    application, both = row["rows"]
    assert application["lost_ms"]["max"] == 0.0, "the recorder drains the rings of an application that was killed"
    assert both["lost_ms"]["max"] > 0.0, "what nobody has written cannot be there"
