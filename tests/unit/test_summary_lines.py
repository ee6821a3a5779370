"""What a person reads at the end of a run: the figures that `--json` has, and none that do not apply."""

from __future__ import annotations

from typing import Any

from mimics_app.app.play.summary_lines import summary_lines

RUN = {
    "simulated_s": 34.0,
    "ticks": 34_000,
    "recipe": "virtual",
    "run_dir": "runs/a",
    "report": "runs/a/report.html",
    "pictures": [],
}


def lines(task: dict[str, Any], **more: Any) -> dict[str, str]:
    answer = {**RUN, "safety": {"state": "HOMED", "stops": 0, "holds": 0}, "task": task, **more}
    return dict(line.split(maxsplit=1) for line in summary_lines(answer))


def test_trials_are_counted_as_in_json_and_practice_apart():
    task = {"completed": 2, "trials": 3, "practice": {"completed": 0, "trials": 1}, "score": 90.2, "time_s": 3.81}
    said = lines({**task, "path_error_m": 0.0031, "contacts": 12})
    assert said["task"] == "2 of 3 trials finished; mean score 90 of 100; mean time 3.8 s"
    assert said["practice"] == "0 of 1 trial finished"
    assert said["path"] == "3.1 mm from the path, 12 contacts"
    assert said["touch"] == "simulated 34.0 s; robot at rest"
    assert "carried" not in said


def test_what_does_not_apply_is_not_reported_as_zero():
    said = lines({"completed": 0, "trials": 0, "time_s": 5.0, "contacts": 1})
    assert said["task"] == "no trial ended; 5.0 s under way"
    assert said["contacts"] == "1" and "path" not in said  # there is no way that it could have been touched on
    said = lines({"completed": 0, "trials": 1, "drops": 0, "bruises": 0, "placed": 0, "contacts": 0})
    assert said["task"] == "0 of 1 trial finished"
    assert said["carried"] == "0 placed, 0 drops, 0 bruises"
    assert not any("0.0" in line for line in said.values() if not line.startswith("simulated"))


def test_figures_of_practice_are_reported_as_those_of_practice():
    task = {"completed": 0, "trials": 0, "practice": {"completed": 1, "trials": 1}, "counted": "practice"}
    said = lines({**task, "score": 71.0, "time_s": 8.8, "path_error_m": 0.0092, "contacts": 5})
    assert said["task"] == "no trial ended"
    assert said["practice"] == "1 of 1 trial finished; score 71 of 100; time 8.8 s"
    assert said["path"] == "9.2 mm from the path, 5 contacts (in practice)"
    under_way = lines({"completed": 0, "trials": 0, "counted": "under way", "time_s": 2.0, "contacts": 1})
    assert under_way["task"] == "no trial ended; 2.0 s under way"


def test_a_live_run_says_its_late_cycles():
    task = {"completed": 1, "trials": 1, "score": 81.0, "time_s": 9.0, "path_error_m": 0.001, "contacts": 0}
    assert lines(task, missed=1)["touch"] == "34.0 s; 1 of 34,000 control cycles late; robot at rest"
    assert "none of 34,000 control cycles late" in lines(task, missed=0)["touch"]
    assert lines(task)["task"] == "1 of 1 trial finished; score 81 of 100; time 9.0 s"


def test_stops_and_holds_are_reported_only_where_there_were_some():
    task = {"completed": 1, "trials": 1, "contacts": 0}
    assert "safety" not in lines(task)
    safety = {"state": "SAFE_STOP", "stops": 1, "holds": 2}
    assert lines(task, safety=safety)["safety"] == "1 stop, 2 short holds"


def test_a_run_on_a_device_says_how_well_its_data_came():
    task = {"completed": 0, "trials": 0}
    link = {"fresh_share": 0.99876, "worst_gap_ms": 4.04, "jitter_us": 310.2}
    assert lines(task, link=link)["link"] == (
        "new data in 99.88 % of the control cycles; longest gap 4.0 ms; jitter 310 µs"
    )
    assert "link" not in lines(task)
