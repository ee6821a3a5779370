"""Channels of an EDF or BDF file, read by the library edfio; see https://www.edfplus.info for the format."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError, UsageError, first_line
from mimics_app.contracts.regular_file import open_regular

if TYPE_CHECKING:
    import edfio

__all__ = ["EdfChannel", "read_edf_channels"]

_NOT_EDF = (IndexError, KeyError, OSError, TypeError, ValueError, ZeroDivisionError, Warning)
"""What edfio raises on a file that is damaged or of another format; a cut-off file is a warning."""


@dataclass(frozen=True, slots=True)
class EdfChannel:
    """One channel of a file.

    Attributes:
        label: Its label, without the spaces that fill it.
        unit: Its physical dimension, as the file states it.
        rate: Sampling rate [Hz].
        values: Samples in `unit`, shape [n].
    """

    label: str
    unit: str
    rate: float
    values: NDArray[np.float64]


def read_edf_channels(path: Path, is_wanted: Callable[[str], bool]) -> list[EdfChannel]:
    """Read the channels of an EDF, EDF+C, BDF or BDF+C file whose label is wanted.

    Raises:
        SceneError: The file cannot be read, is cut off, or has gaps between its records (EDF+D).
        UsageError: edfio is not installed.
    """
    try:
        import edfio
    except ImportError as error:
        raise UsageError("EDF is read by edfio, which is not installed", 'pip install "mimics_app[signals]"') from error
    read = edfio.read_bdf if path.suffix.lower() == ".bdf" else edfio.read_edf
    try:
        _check_header(path)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            file = read(path, header_encoding="latin-1")
            return [_channel(signal) for signal in file.signals if is_wanted(signal.label)]
    except _NOT_EDF as error:
        raise SceneError(Issue(str(path), "", f"it cannot be read: {first_line(error)}")) from error


def _check_header(path: Path) -> None:
    """Refuse what edfio takes as it is: gaps between records, and records without a duration."""
    with open_regular(path) as stream:
        head = stream.read(256)
    if head[192:197] in (b"EDF+D", b"BDF+D"):
        fix = "export it as EDF+C, without gaps"
        raise SceneError(Issue(str(path), "", "there are gaps between its records (EDF+D)", fix))
    duration_s = float(head[244:252])
    if not 0.0 < duration_s < math.inf:
        raise ValueError(f"its records last {duration_s:g} s")


def _channel(signal: edfio.EdfSignal | edfio.BdfSignal) -> EdfChannel:
    values = np.asarray(signal.data, float)
    return EdfChannel(signal.label, signal.physical_dimension, float(signal.sampling_frequency), values)
