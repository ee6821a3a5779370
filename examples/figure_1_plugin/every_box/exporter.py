"""Exporter: one line of text for each attempt."""

from __future__ import annotations


class TrialLines:
    """Trials as one reads them aloud.

    Attributes:
        about: What it writes, for `mimics record export --help`.
    """

    about = "a line of text for each attempt"

    def open(self, run, folder):
        """Write the file and return its name."""
        file = folder / "trials.txt"
        lines = [f"{row['label']}: {row['outcome']} after {row['time_s']:.1f} s" for row in run.trials]
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return [file]


TRIAL_LINES = TrialLines()
