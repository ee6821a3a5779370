"""`mimics bench audio`: cost and accuracy of the mixers, beside peers, and latency of a live device.

Costs are medians over blocks of 5 ms with moving sources, the mixers alternately in one run; `reference_ns` is the cost
of a loop timed in the same run. Accuracy is relative to a head: the computed one, and the one of a SOFA file where the
environment variable MIMICS_SOFA or a Debian package (libmysofa1) provides it. PEERS names a folder with
`audio/hrtf_accuracy.py`.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.lab.audio.hearing import hearing_errors
from mimics_app.lab.audio.live_latency import measure_live_latency, pulse_missing
from mimics_app.lab.audio.rendered import render_clicks
from mimics_app.lab.groups.spatialiser import measure_block_us, own_head_errors
from mimics_app.lab.peer_harness import run_harness
from mimics_app.lab.probe import reference_us
from mimics_app.rendering.audio.spectral.sofa import read_sofa

__all__ = ["KEMAR", "find_measured_head", "measure_audio"]

_VOICES = (1, 16, 64, 192, 256)
_MOST_OPENAL = 200
_BLOCKS = 80
KEMAR = Path("/usr/share/libmysofa/MIT_KEMAR_normal_pinna.sofa")
"""A measured head of 710 directions and 512 taps, in the libmysofa1 of Debian and Ubuntu."""

_RATE = 48_000

Report = Callable[[str], None]


def find_measured_head() -> Path | None:
    """Return the file of a measured head in SOFA; None without one on this machine."""
    named = os.environ.get("MIMICS_SOFA")
    path = Path(named) if named else KEMAR
    return path if path.is_file() else None


def measure_audio(report: Report, seconds: float, peers: Path | None) -> dict[str, Any]:
    """Measure cost, accuracy and live latency: the object of `mimics bench audio`.

    Args:
        report: Called with a description of the next measurement.
        seconds: Length of the live measurement [s].
        peers: Folder with the peers' harnesses, None for none.

    Raises:
        DeviceError: The peers' harness failed.
    """
    answer: dict[str, Any] = {"reference_ns": round(1e3 * reference_us(), 1), "rows": _cost_rows(report)}
    answer["accuracy"] = _accuracy_rows(report)
    report("contact to sample, live")
    missing = pulse_missing()
    answer.update({"skipped": missing} if missing else measure_live_latency(seconds))
    if peers is not None:
        report("peers")
        script = peers / "audio" / "hrtf_accuracy.py"
        answer["peers"] = run_harness(script) if script.is_file() else {"skipped": f"no {script}"}
    return answer


def _cost_rows(report: Report) -> list[dict[str, Any]]:
    rows = []
    for hrtf, work in ((True, "hrtf, all moving"), (False, "stereo, all moving")):
        for voices in _VOICES:
            report(f"{work}: {voices} voices")
            ours = measure_block_us(hrtf, _BLOCKS, voices, mixer="spectral")
            row: dict[str, Any] = {"work": work, "voices": voices, "us_per_block": ours}
            if voices <= _MOST_OPENAL:
                row |= {"peer": "OpenAL Soft", "peer_us": measure_block_us(hrtf, _BLOCKS, voices)}
            rows.append(row)
    return rows


def _accuracy_rows(report: Report) -> list[dict[str, Any]]:
    report("accuracy against the computed head")
    rows: list[dict[str, Any]] = [{"method": "spectral, computed head", **own_head_errors().as_dict()}]
    path = find_measured_head()
    if path is None:
        return rows
    report(f"accuracy against {path.stem}")
    head = read_sofa(path)

    def ours(directions: NDArray[np.float64]) -> NDArray[np.float64]:
        return render_clicks(directions, sofa=path)

    def openal(directions: NDArray[np.float64]) -> NDArray[np.float64]:
        return render_clicks(directions, "openal")

    for method, render in (("spectral", ours), ("openal, its own head", openal)):
        errors = hearing_errors(render(head.directions), _RATE, head, render)
        rows.append({"method": f"{method}, against {path.stem}", **errors.as_dict()})
    return rows
