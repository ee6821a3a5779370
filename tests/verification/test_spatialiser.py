"""The spatialisers as the method registry shows them: what each costs, and what it loses."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.methods import registry
from mimics_app.rendering.audio import methods

RATE = 48_000


@pytest.mark.parametrize("delay", [0.0, 3.0, 12.25, -7.5])
def test_interaural_delay_finds_a_known_delay(delay):
    """A band-limited pulse shifted in the frequency domain by a known share of a sample."""
    frequency = np.fft.rfftfreq(4096, 1 / RATE)
    spectrum = np.exp(-((frequency / 700.0) ** 2)) * np.exp(-2j * np.pi * frequency * 0.02)
    near = np.fft.irfft(spectrum, 4096)
    far = np.fft.irfft(spectrum * np.exp(-2j * np.pi * frequency * delay / RATE), 4096)
    # a parabola through three samples of a peak 30 samples wide: a hundredth of a sample
    assert methods.interaural_delay_us(near, far, RATE) == pytest.approx(delay / RATE * 1e6, abs=0.3)


def test_hrtf_keeps_the_delay_between_the_ears_and_stereo_loses_it():
    rivals = {method.name: method for method in registry.rivals("spatialiser")}
    # the library's ears are whole samples (21 us) apart and its head is not KEMAR's; people notice 10 us at best
    assert rivals["hrtf"].error() < 35.0
    assert rivals["stereo"].error() == pytest.approx(np.median(list(methods.KEMAR_DELAYS_US.values())), rel=1e-6)
    assert all(method.cost() > 0.0 for method in rivals.values())
