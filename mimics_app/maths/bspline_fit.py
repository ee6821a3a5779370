"""Least-squares fit of a cubic B-spline to a recorded path (D2.1 4.2.10: the parameters of a trajectory)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from mimics_app.contracts.arrays import F8
from mimics_app.maths import bspline

__all__ = ["SplineFit", "fit_spline"]


_ROUNDS = 40
"""Largest number of rounds."""

_PLAIN_ROUNDS = 3
"""First rounds, which count the tangential residual in full."""

_NEWTON_STEPS = 4
"""Newton steps of the sample parameters per round."""

_RIDGE = 1e-13
"""Regularisation of the normal equations, relative to their mean diagonal [-]."""


@dataclass(frozen=True, slots=True)
class SplineFit:
    """A fitted curve and its residuals.

    Attributes:
        control_points: Shape [N, dimensions].
        parameters: s of the curve point nearest to each sample, shape [m].
        residual_rms: Root of the mean square distance of the samples from the curve [unit of the path].
        residual_max: Largest distance of a sample from the curve [unit of the path].
    """

    control_points: F8
    parameters: F8
    residual_rms: float
    residual_max: float


def fit_spline(path: ArrayLike, count: int) -> SplineFit:
    """Least-squares fit of a clamped cubic B-spline to samples in travelling order.

    Starts from chord length. Then each round projects every sample to the nearest point of the curve and solves for the
    control points without the tangential part of the residual, because a sample may slide along the curve (tangent
    distance minimisation, Wang, Pottmann & Liu 2006). A weight on that part, raised while a round increases the
    residual, keeps it stable. A path that is such a spline is reproduced to rounding.

    Args:
        path: Shape [m, dimensions], finite; repeated samples are skipped.
        count: Number N of basis functions, 4 <= N <= different samples.

    Raises:
        ValueError: not finite, fewer different samples than basis functions, fewer than 4 basis functions.
    """
    samples = _without_repeats(path)
    if count <= 3:
        raise ValueError(f"a cubic B-spline needs at least 4 basis functions, not {count}")
    if len(samples) < count:
        raise ValueError(f"{count} basis functions need as many different samples, the path has {len(samples)}")
    s = _chord_parameters(samples, count - 3)
    points: F8 = np.linalg.lstsq(bspline.basis_functions(count, s), samples, rcond=None)[0].astype(np.float64)
    s = _slide(samples, bspline.pieces_of(points), s)
    best = _measured(samples, points, s)
    slip = 1.0
    for i in range(_ROUNDS):
        slip = 1.0 if i < _PLAIN_ROUNDS else min(slip, 1e-3)
        trial = _improve(samples, best, slip)
        while trial.residual_rms > best.residual_rms and slip < 1.0:
            slip = min(1.0, 10.0 * slip)
            trial = _improve(samples, best, slip)
        gain = best.residual_rms - trial.residual_rms
        if gain > 0.0:
            best = trial
        if i > _PLAIN_ROUNDS and gain <= 1e-4 * best.residual_rms:
            break
        slip *= 0.1
    return best


def _without_repeats(path: ArrayLike) -> F8:
    """Samples of a path without those equal to their predecessor."""
    samples = np.asarray(path, np.float64)
    if samples.ndim != 2 or not np.isfinite(samples).all():
        raise ValueError("a path is a finite array of points, shape [m, dimensions]")
    moved = np.any(np.diff(samples, axis=0) != 0.0, axis=1)
    return samples[np.concatenate([[True], moved])] if len(samples) else samples


def _chord_parameters(samples: F8, pieces: int) -> F8:
    """First guess of s: relative chord length along the path, mapped by a straight spline of even control points.

    Such a spline is slower between its clamped ends than at them; plain chord length would assign the samples at the
    ends to the wrong basis functions and lead the iteration into a local minimum.
    """
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(samples, axis=0), axis=1))])
    s = np.linspace(0.0, pieces, 64 * pieces + 1)
    share = bspline.basis_functions(pieces + 3, s) @ np.linspace(0.0, 1.0, pieces + 3)
    guess: F8 = np.interp(along / along[-1], share, s)
    return guess


def _slide(samples: F8, pieces: F8, s: F8) -> F8:
    """Move every sample's s towards its nearest curve point by Newton steps of at most a quarter of a piece.

    The first and the last sample stay at the ends of the curve, which otherwise would extend beyond the path.
    """
    for _ in range(_NEWTON_STEPS):
        away = bspline.evaluate(pieces, s) - samples
        first = bspline.evaluate(pieces, s, 1)
        second = bspline.evaluate(pieces, s, 2)
        speed2 = np.sum(first * first, axis=1)
        bend = speed2 + np.sum(away * second, axis=1)
        bend = np.where(bend > 0.1 * speed2, bend, np.maximum(speed2, np.finfo(float).tiny))
        step = np.sum(away * first, axis=1) / bend
        s = np.clip(s - np.clip(step, -0.25, 0.25), 0.0, len(pieces))
        s[0], s[-1] = 0.0, len(pieces)
    return s


def _measured(samples: F8, points: F8, s: F8) -> SplineFit:
    """Fit with its residuals."""
    distance = np.linalg.norm(bspline.evaluate(bspline.pieces_of(points), s) - samples, axis=1)
    return SplineFit(points, s, float(np.sqrt(np.mean(distance**2))), float(distance.max()))


def _improve(samples: F8, fit: SplineFit, slip: float) -> SplineFit:
    """One round: a least-squares step of the control points, then the samples' nearest curve points.

    `slip` weights the squared tangential residual: 1 in full (plain least squares), 0 not at all.
    """
    pieces = bspline.pieces_of(fit.control_points)
    first = bspline.evaluate(pieces, fit.parameters, 1)
    size = np.linalg.norm(first, axis=1, keepdims=True)
    tangent = np.divide(first, size, out=np.zeros_like(first), where=size > 0.0)
    # A sample at an end of the curve cannot slide beyond it.
    tangent[(fit.parameters <= 0.0) | (fit.parameters >= len(pieces))] = 0.0
    weight = np.eye(samples.shape[1]) - (1.0 - slip) * tangent[:, :, None] * tangent[:, None, :]
    residual = np.einsum("mab,mb->ma", weight, samples - bspline.evaluate(pieces, fit.parameters))
    points = fit.control_points + _solve(fit.parameters, weight, residual, fit.control_points.shape)
    return _measured(samples, points, _slide(samples, bspline.pieces_of(points), fit.parameters))


def _solve(s: F8, weight: F8, residual: F8, shape: tuple[int, ...]) -> F8:
    """Change of the control points that minimises the weighted residuals, by normal equations assembled per piece."""
    count, dimensions = shape
    piece, basis = bspline.local_basis(count, s)
    blocks = np.zeros((count - 3, 4, dimensions, 4, dimensions))
    np.add.at(blocks, piece, np.einsum("mk,mab,ml->mkalb", basis, weight, basis))
    normal = np.zeros((count, dimensions, count, dimensions))
    right = np.zeros(shape)
    for i, block in enumerate(blocks):
        normal[i : i + 4, :, i : i + 4, :] += block
    np.add.at(right, piece[:, None] + np.arange(4), basis[:, :, None] * residual[:, None, :])
    square = normal.reshape(count * dimensions, -1)
    # A basis function without samples keeps its control point.
    square[np.diag_indices(len(square))] += _RIDGE * np.trace(square) / len(square)
    step: F8 = np.linalg.solve(square, right.ravel()).astype(np.float64).reshape(shape)
    return step
