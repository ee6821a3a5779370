"""What a report says about the picture of a live run: how long frames took, and what was given up for time."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.recording.report_tables import table
from mimics_app.recording.run import Run

__all__ = ["governor_text"]

_MOST_MOVES = 100


def governor_text(run: Run) -> str:
    """Frame times, shares of frames by quality, and each move of the frame governor; "" where there was none."""
    summary = run.manifest.summary.get("governor") if run.manifest else None
    moves = run.lines_of("app", "governor")
    text = ""
    if isinstance(summary, Mapping):
        times = summary.get("frame_ms", {})
        text += table(
            ["", "value"],
            [
                ("budget of a frame [ms]", summary.get("budget_ms")),
                ("median frame [ms]", times.get("p50")),
                ("95 % of frames within [ms]", times.get("p95")),
                ("times quality changed", summary.get("moves")),
            ],
        )
        shares = summary.get("shares", {})
        text += table(["quality", "share of frames [%]"], [(name, 100.0 * share) for name, share in shares.items()])
    if moves:
        names = ("step", "level", "way", "frame_ms")
        listed = [[line.get(name) for name in names] for line in moves[:_MOST_MOVES]]
        text += "<h3>Changes of quality</h3>" + table(["step", "to", "way", "frame before [ms]"], listed)
    return text
