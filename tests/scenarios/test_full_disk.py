"""A disk that fills while a scene runs: the run ends, says what is missing, and what is there can be read."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from mimics_app.contracts.messages.trial_counts import count_trials
from mimics_app.contracts.system.resources import root
from mimics_app.recording import run_folder
from mimics_app.recording.run import Run
from tests.support.command import mimics

SIZE = "8m"
"""Too little for a minute of the tunnel and its sound, which take 0.4 MB a second."""


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    folder = tmp_path / "small"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("only root may make a small disk")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


@pytest.mark.requirement("R21")
@pytest.mark.fault(id="F09")
def test_run_on_a_disk_that_fills_ends_with_6_and_says_what_is_missing(
    small_disk: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Let in with less than a run wants, as one is whose disk others fill."""
    monkeypatch.setattr(run_folder, "_LEAST_FREE", 0)
    monkeypatch.setattr(run_folder, "BYTES_PER_SECOND", 0)
    options = ("--headless", "--seconds", 60, "--pictures", 0, "--patient", "severe", "--sound", "file", "--json")
    done = mimics("run", root() / "scenes" / "wavy_tunnel.json", *options, "--runs", small_disk)
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
