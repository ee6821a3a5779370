"""Estimators of a person's load with their cost per update and their error on unseen families of people.

The people are the simulated ones shipped with the product: no clinical evidence.
"""

from __future__ import annotations

from functools import cache, partial
from itertools import count

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages.feature_names import BREATH_RATE, HEART_RATE, RMSSD, SCL, SCR_RATE
from mimics_app.contracts.messages.stage_messages import FeatureFrame
from mimics_app.estimation.load_people import shipped_people
from mimics_app.estimation.registry import build_estimation
from mimics_app.lab.physio.state_study import RIVALS, StateScore, state_study
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare

__all__: list[str] = []

_FEATURES = {HEART_RATE: 72.0, SCR_RATE: 3.0, SCL: 6.0, RMSSD: 35.0, BREATH_RATE: 15.0}
_BASELINE_S = 20.0


@cache
def _scores() -> dict[str, StateScore]:
    return state_study(shipped_people())


def _cost_us(estimator: str) -> float:
    """Return the cost of an update with new features after the baseline [us]."""
    estimation, seconds = build_estimation(estimator, _BASELINE_S), count()

    def update() -> None:
        second = next(seconds)
        values = {name: value + 0.1 * (second % 3) for name, value in _FEATURES.items()}
        estimation.update(FeatureFrame(second * SECOND_NS, values, {"ecg": 1.0, "gsr": 1.0, "resp": 1.0}))

    for _ in range(60):
        update()

    def updates() -> None:
        for _ in range(100):
            update()

    return shortest_us(updates, 100)


def _study_us(rival: str) -> float:
    """Return the cost of a trial of the study, training included [us]."""
    people = shipped_people()
    return shortest_us(lambda: RIVALS[rival](people), people.classes.size, 2)


def _estimator(name: str, rival: str, estimator: str, source: str, valid: str) -> Rival:
    return Rival(name, source, valid, {"estimator": estimator}, (rival,), cost=partial(_cost_us, estimator))


compare(
    __name__,
    "three classes of load, simulated people of unseen families (no clinical evidence); error: wrong",
    "share of trials",
    [
        _estimator(
            "fusion",
            "fusion",
            "fusion",
            "Kalman filter over arousal, which it cuts in three",
            "body signals alone, untrained",
        ),
        _estimator(
            "fixed LDA",
            "fixed",
            "lda",
            "linear discriminant of body and success (Koenig et al. 2011)",
            "like those trained on",
        ),
        _estimator(
            "adaptive LDA",
            "adaptive, not asked",
            "adaptive_lda",
            "the same, its class means followed by a Kalman filter, each class as far as it is likely",
            "people who differ from those trained on, after some trials",
        ),
        Rival(
            "adaptive LDA, asked",
            "the same, the person asked after each trial",
            "where somebody asks",
            probed=("adaptive",),
        ),
        Rival("success alone", "linear discriminant of success", "where success can be seen"),
        Rival("threshold per person", "two heart rates from the first three trials", "after three trials"),
        Rival("majority", "the most frequent class", "always"),
    ],
    Probes(_study_us, lambda rival: 1.0 - _scores()[rival].share),
    default="adaptive LDA",
)
