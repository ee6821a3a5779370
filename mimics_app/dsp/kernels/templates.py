"""Templates of the beats and a model of the noise between them: how probable a beat of a known form is.

The forms of the beats, the normal one and others, are averaged while the signal is clear and kept in noise. The noise
is described by a linear predictor, whose error filter whitens signal and templates alike (Hamilton & Tompkins, 1988;
Xue, Hu & Tompkins, IEEE TBME 39(4), 1992). The score of a sample is the logarithm of the likelihood ratio of the
whitened signal with and without the template there. The noise is assumed to be Student-t distributed, because electrode
motion comes in bursts: a wave far larger than the template is then no evidence of a beat, as it is to a matched filter.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.dsp.kernels.sections import Floats

__all__ = [
    "COUNT",
    "ENERGY",
    "NEAR",
    "SHIFT",
    "SIGNAL",
    "WHITE",
    "Bank",
    "learn_beat",
    "learn_noise",
    "log_ratio",
    "mark_beat",
    "score",
    "whiten",
    "whiten_form",
]

SIGNAL, WHITE, NEAR = range(3)
"""Rows of the ring buffer: the signal, the whitened signal, and 1 where a beat is near."""

COUNT, ENERGY = range(2)
"""Columns of the sizes of templates: beats averaged (limited, fading), and energy of the whitened template."""

_TINY = 1e-10
"""Least variance of the noise [mV^2]."""
SHIFT = 3
"""Largest shift by which a beat is aligned to a template [samples]."""
_LEAST_SIZE, _MOST_SIZE = 0.5, 2.0
"""Size of a beat relative to a template of its form."""
_FADE, _MOST_COUNT = 0.98, 50.0
"""Factor of a template's count at a beat of another form, and limit of the count."""
_RIDGE = 1e-6
"""Added to the noise's covariance, as a share of its variance, so that the predictor is determined."""


class Bank(NamedTuple):
    """The last seconds of the signal, the templates of the beats in it, and the noise between them.

    Attributes:
        rings: Ring buffers, shape [3, m], rows see SIGNAL.
        templates: Shape [k, l + p].
        whitened: The templates through the error filter, shape [k, l].
        sizes: Shape [k, 2], columns see COUNT.
        covariance: Of p + 1 consecutive samples of noise, shape [p + 1, p + 1].
        error: Error filter of the noise's linear predictor of order p, its first coefficient 1, shape [p + 1].
    """

    rings: Floats
    templates: Floats
    whitened: Floats
    sizes: Floats
    covariance: Floats
    error: Floats


@kernel
def learn_beat(at: int, bank: Bank, before: int, same: float, weight: float) -> bool:
    """Average a beat into the template that resembles it most, or begin a template anew in place of the rarest one.

    Args:
        at: Sample of the R peak; `before` samples before it the template begins.
        bank: Its nearest template is changed.
        before: Samples of a template before the R peak.
        same: Least correlation with a template of the same form.
        weight: Least weight of a new beat in its template.

    Returns:
        Whether there was a template of its form.
    """
    rings, templates, sizes = bank.rings, bank.templates, bank.sizes
    best, k, shift = 0.0, 0, 0
    for j in range(templates.shape[0]):
        for offset in range(-SHIFT, SHIFT + 1):
            alike = _likeness(at + offset - before, rings, templates[j]) if sizes[j, COUNT] > 0.0 else 0.0
            if alike > best:
                best, k, shift = alike, j, offset
    if best < same:
        k, shift = int(np.argmin(sizes[:, COUNT])), 0
        sizes[k, COUNT] = 0.0
    weight = max(1.0 / (sizes[k, COUNT] + 1.0), weight)
    for i in range(templates.shape[1]):
        value = rings[SIGNAL, (at + shift - before + i) % rings.shape[1]]
        templates[k, i] += weight * (value - templates[k, i])
    sizes[:, COUNT] *= _FADE
    sizes[k, COUNT] = min(sizes[k, COUNT] / _FADE + 1.0, _MOST_COUNT)
    return best >= same


@kernel
def _likeness(begin: int, rings: Floats, template: Floats) -> float:
    """Return the correlation of the signal from a sample on with a template, 0 for another size."""
    both = own = other = _TINY
    for i in range(template.shape[0]):
        value = rings[SIGNAL, (begin + i) % rings.shape[1]]
        both += value * template[i]
        own += value * value
        other += template[i] * template[i]
    size = np.sqrt(own / other)
    return both / np.sqrt(own * other) if _LEAST_SIZE < size < _MOST_SIZE else 0.0


@kernel
def mark_beat(at: int, n: int, rings: Floats, width: int) -> None:
    """Mark the samples near a beat, so that it is not learnt as noise; `n` is the newest sample."""
    m = rings.shape[1]
    for i in range(max(at - width, n - m + 1, 0), min(at + width, n + 1)):
        rings[NEAR, i % m] = 1.0


@kernel
def learn_noise(at: int, bank: Bank, weight: float) -> None:
    """Update the covariance of the noise by the samples that end at `at`."""
    covariance, signal = bank.covariance, bank.rings[SIGNAL]
    for i in range(covariance.shape[0]):
        for j in range(covariance.shape[0]):
            product = signal[(at - i) % signal.shape[0]] * signal[(at - j) % signal.shape[0]]
            covariance[i, j] += weight * (product - covariance[i, j])


@kernel
def whiten(bank: Bank) -> float:
    """Determine the error filter and whiten the templates by it; return the variance of the whitened noise [mV^2]."""
    error = bank.error
    _solve(bank.covariance, error)
    for k in range(bank.templates.shape[0]):
        whiten_form(bank.templates[k], error, bank.whitened[k])
        bank.sizes[k, ENERGY] = (bank.whitened[k] * bank.whitened[k]).sum()
    variance = 0.0
    for i in range(error.shape[0]):
        for j in range(error.shape[0]):
            variance += error[i] * bank.covariance[i, j] * error[j]
    return max(variance, _TINY)


@kernel
def whiten_form(form: Floats, error: Floats, whitened: Floats) -> None:
    """Pass a form, shape [l + p], through the error filter, shape [p + 1], to `whitened`, shape [l]."""
    p = error.shape[0] - 1
    for i in range(whitened.shape[0]):
        whitened[i] = 0.0
        for j in range(p + 1):
            whitened[i] += error[j] * form[p + i - j]


@kernel
def log_ratio(without: float, rest: float, variance: float, freedom: float, length: int) -> float:
    """Return the log likelihood ratio of a template, under Student-t distributed noise.

    Args:
        without: Energy of the samples.
        rest: Energy that is left when the template is subtracted.
        variance: Of the noise.
        freedom: Degrees of freedom of its distribution.
        length: Number of samples.
    """
    ratio = np.log((freedom * variance + without) / (freedom * variance + rest))
    return float(0.5 * (freedom + length) * ratio)


@kernel
def _solve(covariance: Floats, error: Floats) -> None:
    """Write the error filter of the best linear predictor: Gauss elimination, of a positive definite matrix."""
    p = error.shape[0] - 1
    left, right = covariance[1:, 1:].copy(), -covariance[1:, 0]
    for c in range(p):
        left[c, c] += _RIDGE * covariance[0, 0] + _TINY
    for c in range(p):
        for i in range(c + 1, p):
            factor = left[i, c] / left[c, c]
            left[i] -= factor * left[c]
            right[i] -= factor * right[c]
    error[0] = 1.0
    for c in range(p - 1, -1, -1):
        value = right[c]
        for j in range(c + 1, p):
            value -= left[c, j] * error[j + 1]
        error[c + 1] = value / left[c, c]


@kernel
def score(n: int, bank: Bank, variance: float, freedom: float, least: float) -> float:
    """Return the largest log likelihood ratio of a template that ends at sample `n`, with its share of the beats.

    Args:
        n: The newest sample.
        bank: The templates.
        variance: Of the whitened noise [mV^2].
        freedom: Degrees of freedom of the noise's distribution.
        least: Beats that a template needs.

    Returns:
        Minus infinity without templates.
    """
    rings, whitened, sizes = bank.rings, bank.whitened, bank.sizes
    length, m, best = whitened.shape[1], rings.shape[1], -np.inf
    without = 0.0
    for i in range(n - length + 1, n + 1):
        without += rings[WHITE, i % m] ** 2
    for k in range(whitened.shape[0]):
        if sizes[k, COUNT] < least:
            continue
        both = 0.0
        for i in range(length):
            both += rings[WHITE, (n - length + 1 + i) % m] * whitened[k, i]
        rest = max(without - 2.0 * both + sizes[k, ENERGY], 0.0)
        share = np.log(sizes[k, COUNT] / sizes[:, COUNT].sum())
        best = max(best, log_ratio(without, rest, variance, freedom, length) + share)
    return best
