"""Maps of failures of the loop: R peaks by disturbance of the signal, and adaptation by gain, delay and drift."""

from __future__ import annotations

from itertools import product

import numpy as np

from mimics_app.dsp.channels.ecg import Ecg
from mimics_app.inputs.physio.simulated.person import LatentPeople, draw_traits
from mimics_app.inputs.physio.simulated.signals import Disturbance, SignalGenerator
from mimics_app.lab.figure import Figure
from mimics_app.lab.physio.detection import Annotated, f1_of, matched, mixed_noise
from mimics_app.lab.physio_drawing import Cell, Grid, heat_map, physio_figure, row_of
from mimics_app.learning.policies.rules import Proportional
from mimics_app.learning.policy import TARGET, Outcome
from mimics_app.plotting.marks import word

__all__ = ["failure_map", "loop_stability"]

_DECIBELS = (np.inf, 12.0, 6.0, 0.0)
_ECTOPIC, _WANDER, _MOTION, _LEAD_OFF = (0.0, 0.1), (0.08, 0.8), (0.0, 0.8), (0.0, 0.25)
"""Share of early beats; [mV]; [mV per m/s] at 0.4 m/s; share of seconds."""
_SECONDS = 90
_FLAGGED = 0.5
"""Quality below which a second is flagged."""


def failure_map() -> Figure:
    """Return the map of the R detector: F1 while the electrodes have contact, and share of time flagged."""
    spoilt = list(product(_ECTOPIC, _WANDER, _MOTION))
    columns = list(product(_LEAD_OFF, _DECIBELS))
    cells, rows = [], []
    for ectopic, wander, motion in spoilt:
        name = ", ".join(
            [*(["ectopic 10 %"] if ectopic else []), *(["wander x 10"] if wander > 0.1 else [])]
            + (["motion 0.4 m/s"] if motion else [])
        )
        line = []
        for lead_off, decibel in columns:
            f1, flagged = _detected(Disturbance(ectopic, wander, motion=motion, lead_off=lead_off), decibel)
            line.append(Cell(1.0 - f1, f"{f1:.3f}", f"{100.0 * flagged:.0f} % flagged"))
            method = f"{name or 'clean'}, lead off {100 * lead_off:g} %"
            rows.append(row_of(method, 99.0 if np.isinf(decibel) else decibel, 1.0 - f1) | {"flagged": flagged})
        cells.append((name or "as it is", line))
    grid = Grid(300.0, 124.0, 96.0, 40.0)
    heads = ["no noise" if np.isinf(d) else f"{d:g} dB" for _, d in columns]
    parts = heat_map(grid, heads, [name for name, _ in cells], [line for _, line in cells])
    for k, lead_off in enumerate(_LEAD_OFF):
        left = grid.left + k * len(_DECIBELS) * grid.width
        head = f"leads off {100 * lead_off:g} % of the time" if lead_off else "leads on"
        parts.append(word(left, grid.top - 32.0, head, "name strong", "start"))
    size = (grid.left + len(columns) * grid.width + 20.0, grid.top + len(cells) * grid.height + 76.0)
    what = f"{_SECONDS:d} s each; beats while the leads are on"
    return physio_figure("physio failure map", "F1 of R peaks and time flagged", size, parts, rows, what)


def _detected(disturbance: Disturbance, decibel: float) -> tuple[float, float]:
    """Return F1 of the beats during contact, and the share of seconds that are flagged."""
    record = _record(disturbance, decibel)
    channel, n = Ecg(record.rate), round(record.rate)
    found, flagged = [], []
    for i in range(0, len(record.values), n):
        found += [event.t_s for event in channel.push(record.values[i : i + n])]
        flagged.append(channel.found.quality < _FLAGGED)
    seen = np.isfinite(record.values[np.minimum((record.beats * record.rate).astype(int), len(record.values) - 1)])
    beats = record.beats[seen]
    hits = matched(beats, np.array(found))
    return f1_of(hits, len(beats), len(found)), float(np.mean(flagged))


def _record(disturbance: Disturbance, decibel: float) -> Annotated:
    """Return an ECG of a person whose hand moves at 0.4 m/s; NaN without contact."""
    rng = np.random.default_rng(167)
    people, generator = LatentPeople(draw_traits(rng, 1)), SignalGenerator(rng, disturbance)
    rest = np.array([np.nan]), np.zeros(1), np.zeros(1)
    seconds = []
    for _ in range(_SECONDS):
        people.step(1.0, *rest)
        seconds.append(generator.second(people.drive(np.array([0.4])))["ecg"])
    values = np.concatenate(seconds)
    record = Annotated("simulated", 1000.0, np.nan_to_num(values), np.array(generator.truth.beats))
    noisy = record if np.isinf(decibel) else mixed_noise(record, decibel, 1)
    return Annotated(record.name, record.rate, np.where(np.isnan(values), np.nan, noisy.values), record.beats)


_GAINS = (0.05, 0.1, 0.25, 0.5, 1.0)
_DELAYS = (0, 1, 2, 4)
"""Delay of a result [trials]."""
_DRIFTS = (0.0, 0.005, 0.015)
"""Drift of the best demand per trial."""
_STEEPNESS = 12.0
"""Slope of success over demand [logit per unit]."""


def _stable_gain(delay: int) -> float:
    """Return the largest gain g at which x[k+1] = x[k] - g s x[k - delay] decays; s: slope of success at its target."""
    return 2.0 * float(np.sin(np.pi / (2.0 * (2 * delay + 1)))) / (_STEEPNESS * TARGET * (1.0 - TARGET))


def _loop_error(gain: float, delay: int, drift: float, people: int = 200, trials: int = 80) -> float:
    """Return the RMS distance of the demand from the best one over the second half of a session."""
    rng = np.random.default_rng(170)
    policy, nothing = Proportional(gain), np.full(people, np.nan)
    policy.begin(np.full(people, 0.4), rng)
    results, squares = [], []
    for trial in range(trials):
        best = 0.25 + abs((0.25 + drift * trial) % 1.0 - 0.5)  # triangle wave between 0.25 and 0.75, from 0.5 on
        demand = policy.act().demand
        succeeds = 1.0 / (1.0 + (1.0 / TARGET - 1.0) * np.exp(_STEEPNESS * (demand - best)))
        results.append(rng.binomial(10, succeeds) / 10.0)
        late = results[trial - delay] if trial >= delay else nothing
        policy.learn(Outcome(demand, late, nothing, nothing, nothing))
        squares.append((demand - best) ** 2)
    return float(np.sqrt(np.mean(squares[trials // 2 :])))


def loop_stability() -> Figure:
    """Return the map of the adaptation's error by gain, delay and drift; framed where it is unstable without noise."""
    parts, rows = [], []
    top, height, width = 108.0, 40.0, 78.0
    for k, drift in enumerate(_DRIFTS):
        left = 120.0 + k * (len(_GAINS) * width + 30.0)
        cells = []
        for delay in _DELAYS:
            line = []
            for gain in _GAINS:
                error, swings = _loop_error(gain, delay, drift), gain > _stable_gain(delay)
                line.append(Cell(error / 0.4, f"{error:.3f}", "swings" if swings else "", swings))
                rows.append(row_of(f"delay {delay}, drift {drift:g}", gain, error))
            cells.append(line)
        names = [f"{delay} trials late" for delay in _DELAYS] if k == 0 else []
        parts += heat_map(Grid(left, top, width, height), [f"gain {g:g}" for g in _GAINS], names, cells)
        parts.append(word(left, top - 28.0, f"best demand moves by {drift:g} a trial", "name strong", "start"))
    size = (120.0 + 3 * (len(_GAINS) * width + 30.0), top + len(_DELAYS) * height + 76.0)
    what = "Policy in proportion to success, 200 people; RMS distance from the best demand in trials 41 to 80"
    return physio_figure("physio loop stability", "Adaptation by gain, delay and drift", size, parts, rows, what)
