"""A disk that fills while a scene runs: the run ends, says what is missing, and what is there can be read."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from mimics_app.contracts.resources import root
from mimics_app.contracts.trial_counts import count_trials
from mimics_app.recording.run import Run

SIZE = "20m"
"""Enough to be let in (a run wants 17 MB), too little for the whole tunnel and its sound."""


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    folder = tmp_path / "small"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("only root may make a small disk")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_run_on_a_disk_that_fills_ends_with_6_and_tells_what_is_missing(small_disk: Path) -> None:
    command = [sys.executable, "-m", "mimics_app.app.cli", "run", str(root() / "scenes" / "wavy_tunnel.json")]
    options = ["--headless", "--pictures", "0", "--patient", "severe", "--json", "--runs", str(small_disk)]
    done = subprocess.run([*command, *options], capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 6, done.stderr
    assert "Traceback" not in done.stderr
    assert "ticks were not recorded; the disk is full" in done.stderr
    answer = json.loads(done.stdout)
    run = Run.open(Path(answer["run_dir"]))
    assert run.manifest is not None and run.status == "clean"
    assert len(run.haptic) + run.lost_at_end == answer["ticks"]
    assert any("ticks are missing: the disk is full" in problem for problem in run.problems())
    assert count_trials(run.trials).as_dict().items() <= answer["task"].items()
    assert not run.disagreements() and not run.damages
