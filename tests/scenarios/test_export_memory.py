"""An export holds a stretch of the recording in memory and never the whole: 500 MB are enough for an hour."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.recording.exporter_kinds import exporter_names
from tests.support.long_run import write_long_run

LIBRARIES = {"edf": "edfio", "mcap": "mcap", "nwb": "pynwb"}
MOST_MB = 500
SHORT_MIN, LONG_MIN = 1, 3
MOST_GROWTH_MB = 15 * (LONG_MIN - SHORT_MIN)
"""A minute of ticks and signals is 42 MB of numbers; an hour of events and of what an index needs may take some 5 a
minute, and buffers fill in the first minutes."""

EXPORT = """
import sys
from pathlib import Path
from mimics_app.recording.exporter_kinds import export_run
from mimics_app.recording.run import Run
export_run(Run.open(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
lines = Path("/proc/self/status").read_text().splitlines()
print(next(int(line.split()[1]) // 1024 for line in lines if line.startswith("VmHWM:")))
"""


def peak_mb(run: Path, name: str, into: Path) -> int:
    """Return the most memory that a process needs which exports a run [MB]."""
    command = [sys.executable, "-c", EXPORT, str(run), name, str(into)]
    return int(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def made(folder: Path, minutes: float) -> Path:
    folder.mkdir()
    return write_long_run(folder, minutes)


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of memory is read from /proc")
@pytest.mark.parametrize("name", ["parquet", "mcap"])
def test_memory_hardly_grows_with_the_recording(tmp_path: Path, name: str) -> None:
    pytest.importorskip(LIBRARIES.get(name, "pyarrow"))
    peaks = [
        peak_mb(made(tmp_path / f"run_{minutes}", minutes), name, tmp_path / f"out_{minutes}")
        for minutes in (SHORT_MIN, LONG_MIN)
    ]
    assert peaks[1] - peaks[0] <= MOST_GROWTH_MB, peaks


@pytest.fixture(scope="module")
def hour(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("hour") / "run", 60)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the peak of memory is read from /proc")
@pytest.mark.parametrize("name", exporter_names())
def test_an_hour_needs_no_more_than_500_mb(hour: Path, tmp_path: Path, name: str) -> None:
    pytest.importorskip(LIBRARIES.get(name, "pyarrow"))
    assert peak_mb(hour, name, tmp_path / "out") <= MOST_MB
