"""Energy and change of the force that a person feels, integrated at the handle from recorded samples."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["DT", "fastest_change", "given", "paid"]

DT = 1e-3
"""Tick [s]."""


def given(samples: Any) -> np.ndarray:
    """Work of the force felt on the hand from the first sample to each [J]: a force is held until the next tick."""
    work = np.sum(samples["f_user_world"][:-1] * np.diff(samples["hip_world"], axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(work)])


def paid(samples: Any, limits: Any, viscosity: Any = 0.0) -> np.ndarray:
    """Energy that the tank has paid, from the first sample to each, at most [J].

    Args:
        samples: SAMPLE rows.
        limits: SCENE record.
        viscosity: Damping of the virtual mass, a share of whose losses flows into the tank [N s/m]; one, or one each.
    """
    speed = np.linalg.norm(samples["v_virtual"], axis=1)
    inflow = limits["tank_refill"] + limits["tank_return"] * viscosity * speed**2
    return limits["tank_size"] - samples["tank"] + np.cumsum(inflow) * DT


def fastest_change(samples: Any) -> float:
    """Largest distance of a tick's force from the nearest force between zero and that of the tick before [N]."""
    last, now = samples["f_user_world"][:-1], samples["f_user_world"][1:]
    square = np.sum(last**2, axis=1)
    kept = np.clip(np.sum(last * now, axis=1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return float(np.linalg.norm(now - kept[:, None] * last, axis=1).max())
