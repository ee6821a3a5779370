"""A signal that is processed and an estimator, each added by a file or by an installed package: no list names them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.messages.stage_messages import FeatureFrame, SignalBlock
from mimics_app.contracts.ports.members import member_names
from mimics_app.dsp import channel_kinds, channels
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.estimation import estimators, registry
from tests.support.plugin_site import write_package

WARMTH = '''
"""Skin temperature: its mean over a second."""
import numpy as np
from mimics_app.contracts.messages.stage_messages import Estimate, UserState
from mimics_app.dsp.channel import Channel, FeatureSet


class Warmth(Channel):
    name, unit, features = "warmth", "degC", {"skin_warmth": "degC"}
    latency_s, lowest_rate = 1.0, 1.0

    def _take(self, piece):
        return []

    def _evaluate(self, raw):
        return FeatureSet({"skin_warmth": float(np.nanmean(raw))}, 1.0)


class Unnamed(Warmth):
    name = "coldness"


class ByWarmth:
    """Whoever is warm is aroused."""

    def __init__(self, baseline_s):
        self.baseline_s, self.state = baseline_s, UserState(-1)

    def update(self, features):
        warm = features.values.get("skin_warmth")
        self.state = UserState(features.t_ns, arousal=None if warm is None else Estimate(warm / 40.0, 0.1))
        return self.state

    def update_from_result(self, result):
        return self.state

    def recalibrate(self):
        pass


CHANNEL = Warmth


def build(baseline_s):
    return ByWarmth(baseline_s)
'''

GROUPS = """
[mimics_app.signal_channels]
warmth = lab_of_skin:Warmth
humidity = lab_of_skin:Unnamed

[mimics_app.estimators]
by_warmth = lab_of_skin:ByWarmth
"""


def frame_of(name: str) -> FeatureFrame:
    """The features after a second of a signal of 34 at 4 Hz."""
    return PhysioDsp().process([SignalBlock(name, 4.0, 0, np.full(4, 34.0))], 10**9)


def check_warmth(estimator: str) -> None:
    """The signal becomes a feature with a unit, the feature a state."""
    frame = frame_of("warmth")
    assert frame.values == {"skin_warmth": 34.0}
    assert channel_kinds.feature_units()["skin_warmth"] == "degC"
    registry.check_estimator(estimator)
    state = registry.build_estimation(estimator, 30.0).update(frame)
    assert state.arousal is not None and state.arousal.mean == pytest.approx(0.85)


def test_a_signal_nobody_processes_is_only_recorded() -> None:
    assert frame_of("warmth").values == {}
    channel_kinds.check_rate("warmth", 0.1)


def test_an_installed_package_adds_a_signal_and_an_estimator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_of_skin", WARMTH, GROUPS)))
    check_warmth("by_warmth")
    with pytest.raises(DeviceError, match="from 1 to 20000 Hz"):
        channel_kinds.check_rate("warmth", 0.1)
    with pytest.raises(DeviceError, match='processes the signal "coldness", not "humidity"'):
        frame_of("humidity")
    with pytest.raises(UsageError, match='did you mean "by_warmth"'):
        registry.check_estimator("by_warmt")


def test_a_file_beside_the_built_in_ones_adds_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "warmth.py").write_text(WARMTH)
    for package in (channels, estimators):
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])
        monkeypatch.setattr(channel_kinds if package is channels else registry, "BUILT_IN", member_names(package))
    check_warmth("warmth")


@pytest.mark.parametrize("name", channel_kinds.BUILT_IN)
def test_every_built_in_channel_is_named_as_its_file_and_has_units(name: str) -> None:
    kind = channel_kinds.channel_kind(name)
    assert kind is not None and kind.name == name
    assert channel_kinds.PLUGINS.fault_of(name, kind) == ""
    assert set(kind.features) <= set(channel_kinds.feature_units())
