"""Units of the features of body signals and movement."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.system.table_file import read_table_file

__all__ = ["FEATURE_UNITS"]

FEATURE_UNITS = read_table_file(Path(__file__).with_suffix(".json"), dict[str, str])
"""Unit of each feature by its name; "1": a ratio, a flag, or the unit of a signal without one, as breath's."""
