"""Checks that every sound recipe has to pass, built in or of a plug-in."""

from __future__ import annotations

import numpy as np

from mimics_app.rendering.audio.recipe import Recipe, Variant

RATE = 48_000
MINUS_1_DB = 10 ** (-1 / 20)


def check_recipe(recipe: Recipe) -> None:
    """Assert what a recipe promises, for its slowest and fastest variant and each take."""
    made = []
    for speed in (0.02, 1.5) if recipe.by_speed else (0.3,):
        for take in range(recipe.takes):
            variant = Variant(speed, take)
            samples = recipe.synthesise(variant, RATE)
            assert samples.dtype == np.float32 and samples.ndim == 1
            assert np.array_equal(samples, recipe.synthesise(variant, RATE)), "the same variant gives the same samples"
            whole = samples.astype(np.float64)
            assert np.isfinite(whole).all() and 0.01 < np.abs(whole).max() <= MINUS_1_DB
            assert abs(whole.mean()) < 1e-3 * np.abs(whole).max(), "no constant part"
            assert not any(np.array_equal(samples, other) for other in made), "takes and speeds differ"
            made.append(samples)
            if recipe.loop:
                check_seam(whole)


def check_seam(samples: np.ndarray) -> None:
    """Assert that the step and the bend over the seam of a loop are no larger than the largest within."""
    assert abs(samples[0] - samples[-1]) <= np.abs(np.diff(samples)).max()
    bend = np.abs(np.diff(np.concatenate((samples[-3:], samples[:3])), 2)).max()
    assert bend <= np.abs(np.diff(samples, 2)).max()
