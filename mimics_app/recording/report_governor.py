"""What a report says about the picture of a live run: how long frames took, and what was given up for time."""

from __future__ import annotations

from mimics_app.recording.report_tables import Table
from mimics_app.recording.report_values import mapping, scaled
from mimics_app.recording.run import Run

__all__ = ["governor_tables"]

_MOST_MOVES = 100


def governor_tables(run: Run) -> dict[str, Table]:
    """Frame times, shares of frames by quality, each move of the frame governor, by heading ("" for none)."""
    summary = mapping(run.summary.get("governor"))
    moves = run.lines_of("app", "governor")
    tables: dict[str, Table] = {}
    if summary:
        times = mapping(summary.get("frame_ms"))
        rows = [
            ("budget of a frame [ms]", summary.get("budget_ms")),
            ("median frame [ms]", times.get("p50")),
            ("95 % of frames within [ms]", times.get("p95")),
            ("times quality changed", summary.get("moves")),
        ]
        tables[""] = Table(["", "value"], rows)
        shares = [(name, scaled(share, 100.0)) for name, share in mapping(summary.get("shares")).items()]
        tables["Qualities"] = Table(["quality", "share of frames [%]"], shares)
    if moves:
        listed = [[line.get(name) for name in ("step", "level", "way", "frame_ms")] for line in moves[:_MOST_MOVES]]
        tables["Changes of quality"] = Table(["step", "to", "way", "frame before [ms]"], listed)
    return tables
