"""Heads for the sound tests: SOFA files as laboratories write them, of the computed head or of something broken."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from mimics_app.rendering.audio.spectral.computed_head import compute_head
from mimics_app.rendering.audio.spectral.head import HeadResponses


def some_head(rate: int = 44_100, every: int = 3, width: float = 0.16) -> HeadResponses:
    """A head of another width and rate than the built-in one, in a third of its directions."""
    head = compute_head(width, rate)
    return HeadResponses(head.directions[::every], head.responses[::every], head.rate, head.name)


def write_sofa(path: Path, head: HeadResponses, *, cartesian: bool = False, **changes) -> Path:
    """A SOFA file of a head; `changes` replace a variable ("Data_IR" for Data.IR), or leave it out with None."""
    x, y, z = head.directions.T
    angles = np.stack((np.degrees(np.arctan2(-x, -z)) % 360.0, np.degrees(np.arcsin(np.clip(y, -1, 1)))), axis=1)
    places = np.stack((-z, -x, y), axis=1) if cartesian else np.column_stack((angles, np.full(len(angles), 1.4)))
    variables = {
        "Data.IR": head.responses,
        "Data.SamplingRate": np.array([head.rate]),
        "SourcePosition": places,
        **{name.replace("_", "."): value for name, value in changes.items() if name != "convention"},
    }
    with h5py.File(path, "w") as file:
        file.attrs["SOFAConventions"] = np.bytes_(changes.get("convention", "SimpleFreeFieldHRIR"))
        for name, value in variables.items():
            if value is not None:
                file[name] = value
        if "SourcePosition" in file:
            file["SourcePosition"].attrs["Type"] = np.bytes_("cartesian" if cartesian else "spherical")
    return path
