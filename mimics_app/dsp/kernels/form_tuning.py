"""Parameters of the detector by forms (`beats`): constants of its kernels."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["TUNING"]


class _Tuning(NamedTuple):
    """Parameters of the detector by forms. Most are from a random search over simulated noise (decisions 203, 203)."""

    before_s: float = 0.05  # a template begins this time before the R peak
    after_s: float = 0.0555  # ... and ends this time after it
    freedom: float = 8.23  # degrees of freedom of the noise's distribution
    noise_s: float = 7.2  # time constant of the noise's covariance
    near_s: float = 0.0764  # samples within this time of a beat are not noise
    strong: float = (
        2.28  # a beat is averaged into a template if its energy is more than this multiple of the noise level
    )
    same: float = 0.766  # correlation with a template above which a beat is of its form
    weight: float = 0.103  # least weight of a new beat in its template
    usable: float = 5.71  # beats from which a template is used
    noisy: float = 20.0  # amplitude of a template over that of the noise, both whitened, below which templates decide
    clear: float = 26.0  # ... and above which energy decides again
    due: float = 5.42  # threshold of the score when a beat is due
    higher: float = 6.26  # ... and what is added to it just after a beat
    decay: float = 1.3  # share of the mean interval in which that decays
    range: float = 12.1  # over which the rhythm moves the threshold, half up and half down
    width: float = 0.179  # of the window around an expected beat, as a share of the mean interval
    unsteady: float = 0.134  # relative deviation of the intervals at which the rhythm counts for nothing
    hold_s: float = 0.0527  # a peak of the score is complete when nothing larger followed for this time
    refractory_s: float = 0.251
    wait_s: float = 0.22  # time after which a rejected candidate within that window is taken if none was better
    late: float = 1.34  # mean intervals without a beat after which the best rejected candidate is taken
    below: float = -5.05  # ... in both cases if its score exceeds the threshold by more than this
    gap: float = 1.6  # mean intervals without a beat after which one found by energy fills the gap
    gap_strong: float = 1.52  # ... if its energy is more than this multiple of the noise level
    reliable: float = 0.95  # share of the beats found by energy that were beats, above which one is taken early
    fitting: float = 0.497  # share of the beats found by templates below which these are discarded
    spread: float = 0.09  # standard deviation of the intervals on a path, as a share of the period
    missed: float = 5.0  # cost of a missed beat on it, in the logarithm of the probability
    evidence: float = 40.0  # of a path from which its form is used, in the same
    search_every_s: float = 0.9  # least time between two searches of a form
    fade_s: float = 60.0  # time constant with which the evidence for a form fades
    search_from_s: float = 6.0  # signal from which on one is searched
    covered: float = 0.7  # least share of that signal which the beats of a path cover, each by a mean interval


TUNING = _Tuning()
