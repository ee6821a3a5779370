"""The left half of Figure 1 in a whole run: signals, features, state, choices; recorded, replayed, refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.session.body_replay import replay_body
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES


def play(folder: Path, seconds: float, **more: Any) -> Run:
    with mimics.open("wavy_tunnel", seconds=seconds, runs=folder, **more) as session:
        session.run()
    return mimics.load(session.run_dir).run


@pytest.fixture(scope="module")
def run(tmp_path_factory: Any) -> Run:
    folder = tmp_path_factory.mktemp("runs")
    return play(folder, 75.0, physio="sim", learn="kalman", patient="severe", baseline_s=20.0, seed=3)


def test_every_arrow_of_the_figure_carries_something(run: Run) -> None:
    assert {row.block.name for row in run.signals} == {"ecg", "gsr", "emg", "resp", "speed", "power"}
    ecg = np.concatenate([row.block.values for row in run.signals if row.block.name == "ecg"])
    assert len(ecg) == pytest.approx(75_000, abs=40)
    newest = run.lines_of("app", "features")[-1]["values"]
    assert {"heart_rate", "rmssd", "scl", "breath_rate", "hand_power"} <= set(newest)
    persons = run.lines_of("app", "person")
    assert "arousal" not in persons[3], "not known before the baseline"
    mean, variance = persons[-1]["arousal"]
    assert -1.0 <= mean <= 1.0
    assert variance > 0.0
    results, choices = run.lines_of("app", "result"), run.lines_of("app", "choice")
    assert len(results) >= 2
    assert choices[0]["values"]["radius"] != results[0]["values"]["radius"]
    assert results[1]["values"]["radius"] == pytest.approx(choices[0]["values"]["radius"])
    assert run.session["body"]["estimator"] == "adaptive_lda"
    judged = [line for line in persons if line["t_ns"] in {line["t_ns"] for line in results}]
    assert judged, "a trial that ended is part of the state its choice goes by"
    assert all(sum(line["load"]) == pytest.approx(1.0) for line in judged)


def test_a_run_replays_to_the_last_digit(run: Run) -> None:
    replayed = replay_body(run)
    assert replayed is not None
    assert replayed.difference == ""
    assert replayed.features >= 70
    assert replayed.choices == len(run.lines_of("app", "choice"))


def test_one_changed_sample_is_found(run: Run) -> None:
    other = Run.open(run.folder)
    row = next(row for row in other.signals if row.block.name == "gsr" and row.frame > 1800)
    values = row.block.values.copy()
    values[:] += 3.0
    other.signals[other.signals.index(row)] = type(row)(
        row.frame, type(row.block)(row.block.name, row.block.rate, row.block.t_ns, values)
    )
    replayed = replay_body(other)
    assert replayed is not None
    assert "differ" in replayed.difference


def test_the_stream_is_sealed_and_damage_is_reported(run: Run) -> None:
    assert not run.losses()
    assert not run.disagreements()
    path = run.folder / FILES["signals"]
    content = path.read_bytes()
    try:
        path.write_bytes(content[: len(content) // 2] + bytes(64) + content[len(content) // 2 + 64 :])
        damaged = Run.open(run.folder)
        assert any("signals.arrows" in loss for loss in damaged.losses())
        assert any("signals.arrows was changed" in one for one in damaged.disagreements())
        assert 0 < len(damaged.signals) < len(run.signals)
    finally:
        path.write_bytes(content)


def test_a_run_without_signals_has_no_stream(tmp_path: Path) -> None:
    plain = play(tmp_path, 0.5)
    assert not (plain.folder / FILES["signals"]).exists()
    assert plain.signals == []
    assert replay_body(plain) is None
    assert "body" not in json.loads((plain.folder / FILES["session"]).read_text())


@pytest.mark.parametrize(
    "more",
    [{"learn": "kalmann"}, {"physio": "simm"}, {"learn": "kalman", "goal": "joy"}, {"physio": "sim", "estimator": "a"}],
)
def test_what_is_not_there_is_refused_before_a_run_begins(more: dict[str, str], tmp_path: Path) -> None:
    with pytest.raises(mimics.errors.UsageError):
        play(tmp_path, 1.0, **more)
    assert not list(tmp_path.iterdir())
