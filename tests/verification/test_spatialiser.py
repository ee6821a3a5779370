"""The spatialisers as the method registry shows them: what each costs, and what it loses."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.ports.methods import registry
from mimics_app.lab.audio.spherical_head import HEAD_RADIUS, add_at_sphere, sphere_delay_s
from mimics_app.lab.groups import spatialiser as methods

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


@pytest.mark.parametrize("degrees", [-70.0, -20.0, 0.0, 35.0, 90.0])
def test_the_sphere_brings_a_sound_to_the_ear_on_its_side_first_and_louder(degrees):
    """a / c (theta + sin theta) apart, and 1 +- 0.9 sin theta in power; left is column 0."""
    azimuth = math.radians(degrees)
    frequency = np.fft.rfftfreq(4096, 1 / RATE)
    spectrum = np.exp(-((frequency / 700.0) ** 2)) * np.exp(-2j * np.pi * frequency * 0.02)
    pulse = np.fft.irfft(spectrum, 4096).astype(np.float32)
    mix = np.zeros((4096, 2), np.float32)
    add_at_sphere(pulse, 0.0, azimuth, RATE, 0.5, mix)
    left, right = mix.astype(np.float64).T
    apart_us = HEAD_RADIUS / 343.0 * (azimuth + math.sin(azimuth)) * 1e6
    assert methods.interaural_delay_us(right, left, RATE) == pytest.approx(apart_us, abs=1.0)
    assert sphere_delay_s(azimuth) * 1e6 == pytest.approx(apart_us, rel=1e-12)
    power = 0.25 * np.sum(pulse.astype(np.float64) ** 2)
    assert np.sum(right**2) / power == pytest.approx(0.5 * (1.0 + 0.9 * math.sin(azimuth)), rel=2e-3)
    assert np.sum(left**2) / power == pytest.approx(0.5 * (1.0 - 0.9 * math.sin(azimuth)), rel=2e-3)


def test_the_sphere_is_nearer_to_a_measured_head_than_no_delay_at_all():
    """It is that of high frequencies, a third less than KEMAR has below 1.5 kHz; with its ears exchanged, twice it."""
    rivals = {method.name: method for method in registry.rivals("spatialiser")}
    assert rivals["spherical head"].error() < 0.4 * rivals["stereo"].error()
