"""Peers of the haptic bodies with harnesses of their own: programs in the folder that PEERS names.

Every `haptics/bench_*.py` of the folder is run with the path of a JSON file to write: `{"rows": [{"engine": NAME,
"kind": "sphere|box|cylinder", "bodies": N, "gap": M, "us_block_min": US, "n": STEPS, "reps": ROUNDS}]}`, the shortest
of these rounds of these steps of 1 ms called from Python. This program is timed with the same numbers beside each.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.lab.peer_harness import run_harness

__all__ = ["HarnessRow", "run_harnesses"]

_GAP = 0.02
"""Gap between two bodies of `bodies_on_a_floor` [m]; a harness may also measure other scenes."""


@dataclass(frozen=True, slots=True)
class HarnessRow:
    """Measurement of one workload by a harness.

    Attributes:
        engine: Name and version of the peer.
        kind: Kind of the bodies.
        count: Number of bodies.
        us: Cost of a step [us].
        steps: Steps of a round.
        rounds: Number of rounds, of which the shortest counts.
    """

    engine: str
    kind: str
    count: int
    us: float
    steps: int
    rounds: int


def run_harnesses(folder: Path, report: Callable[[str], None]) -> list[HarnessRow]:
    """Run every harness of a folder; one that fails, as without its peer, is reported and left out.

    Raises:
        UsageError: There is none in the folder.
    """
    programs = sorted((folder / "haptics").glob("bench_*.py"))
    programs = [program for program in programs if program.name != "bench_common.py"]
    if not programs:
        raise UsageError(f"no harness in {folder / 'haptics'}", "name the peers' folder by PEERS, or leave it out")
    return [row for program in programs for row in _run(program, report)]


def _run(program: Path, report: Callable[[str], None]) -> list[HarnessRow]:
    report(f"peer: {program.stem}")
    try:
        return [_row(row) for row in run_harness(program)["rows"] if _is_ours(row)]
    except (DeviceError, ValueError, KeyError, TypeError) as failure:
        report(f"peer: {program.stem} is not measured: {failure}")
        return []


def _is_ours(row: dict[str, Any]) -> bool:
    """Whether it is the scene measured here: separate bodies, awake, with the peer's default contacts."""
    return row["gap"] == _GAP and not row.get("sleep") and row.get("integrator", "implicitfast") == "implicitfast"


def _row(row: dict[str, Any]) -> HarnessRow:
    return HarnessRow(
        str(row["engine"]), str(row["kind"]), int(row["bodies"]), float(row["us_block_min"]), int(row["n"]),
        int(row["reps"]),
    )  # fmt: skip
