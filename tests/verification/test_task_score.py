"""Scores against closed forms: path error, contact time, smoothness, points."""

from __future__ import annotations

import math
from dataclasses import asdict

import numpy as np
import pytest
from msgspec import structs

from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.loop.loop_fields import PointSnapshot
from mimics_app.tasks.observation import observe
from mimics_app.tasks.score import part_marks, session_result, trial_points
from mimics_app.tasks.tally import RESAMPLE_HZ, Measures, Tally, resample_speed, sparc
from mimics_app.tasks.task import ScorePartSpec, ScoreSpec
from tests.support.task_play import make_events, make_snapshot

MS = 1_000_000


def frame(t_ns, *events, distance=None, **changes):
    """An observation as the kind of a tunnel passes it on."""
    seen = observe(make_snapshot(t_ns, **changes), make_events(*events), t_ns)
    peaks = {name: changes[name] for name in ("distance_peak", "progress_peak") if name in changes}
    return structs.replace(seen, distance=distance, **peaks)


def travel(times_s, **columns):
    """Tally of a travel with one value per frame of each column."""
    frames = [
        frame(round(time * 1e9), **{name: values[i] for name, values in columns.items()})
        for i, time in enumerate(times_s)
    ]
    tally = Tally(frames[0])
    for seen in frames[1:]:
        tally.add(seen)
    return tally.measures()


def test_straight_along_the_bisector_has_no_path_error():
    measures = travel(np.linspace(0.0, 3.0, 181), distance=np.zeros(181))
    assert measures.path_error_rms_m == 0.0
    assert measures.time_s == 3.0


def test_constant_offset_is_the_path_error_whatever_the_frames():
    times = np.cumsum(np.random.default_rng(1).uniform(0.001, 0.1, 200))
    measures = travel(times, distance=np.full(200, 0.0125))
    assert measures.path_error_rms_m == pytest.approx(0.0125, rel=1e-12)


def test_offset_that_grows_evenly_has_rms_of_a_ramp():
    n = 240
    measures = travel(np.linspace(0.0, 4.0, n + 1), distance=np.linspace(0.0, 0.03, n + 1))
    # the trapezoidal rule adds h^2/12 * (f'(b) - f'(a)) to the integral of x^2: a factor 1 + 1/(2 n^2) on the mean
    assert measures.path_error_rms_m == pytest.approx(0.03 / math.sqrt(3.0) * (1 + 1 / (2 * n**2)) ** 0.5, rel=1e-9)


def test_means_weigh_time_not_frames():
    times = np.concatenate([np.linspace(0.0, 1.0, 1001), np.linspace(1.0 + 1e-6, 2.0, 3)])
    force = [np.array([0.0, 0.0, 0.0])] * 1001 + [np.array([0.0, 3.0, 4.0])] * 3
    measures = travel(times, f_user_world=force, distance=[0.0] * 1001 + [0.02] * 3)
    assert measures.force_mean_n == pytest.approx(2.5, abs=1e-5)  # 5 N for half the time; 2.5e-6 by the step's frame
    assert measures.path_error_rms_m == pytest.approx(0.02 / math.sqrt(2.0), rel=1e-5)


def test_extremes_are_those_of_the_loop_and_not_of_the_frames():
    """The frames see 2 N and 10 mm at most; between them the loop saw more."""
    force = [np.array([newton, 0.0, 0.0]) for newton in (1.0, 2.0, 1.0)]
    peaks = {"force_peak": (1.0, 34.1, 34.1), "distance_peak": (0.0, 0.02, 0.03)}
    measures = travel([0.0, 1.0, 2.0], f_user_world=force, distance=[0.0, 0.01, 0.01], **peaks)
    assert (measures.force_peak_n, measures.path_error_max_m) == (34.1, 0.03)


def test_the_distance_from_a_line_is_over_the_time_in_which_there_is_one():
    """An apple that is carried for a second of ten, 20 mm off its way; nothing for a hand that never held it."""
    times = np.linspace(0.0, 10.0, 601)
    carried = [0.02 if 4.0 <= time <= 5.0 else None for time in times]
    assert travel(times, distance=carried).path_error_rms_m == pytest.approx(0.02)
    assert travel(times, distance=[None] * 601).path_error_rms_m is None


def test_each_of_several_points_has_measures_of_its_own():
    """The first rests and touches for 30 ms; the second goes 0.1 m/s at 3 N, from 2 to 4 mm off its tunnel's line."""

    def seen(k):
        point = {name: getattr(make_snapshot(), name) for name in PointSnapshot.__slots__}
        point |= {"hip_world": np.array([0.1 * k / 60, 0.0, 0.0]), "v_world": np.array([0.1, 0.0, 0.0])}
        point |= {"f_user_world": np.array([0.0, 3.0, 0.0]), "force_peak": 5.0, "own_work": 0.25}
        point |= {"distance": 2e-3 + 2e-3 * k / 60, "distance_peak": 4.5e-3, "progress_peak": 0.5}
        return make_snapshot(round(k * 1e9 / 60), further=(PointSnapshot(**point),), force_peak=0.5)

    touch = make_events((100 * MS, EventKind.CONTACT_BEGIN, 1.0), (130 * MS, EventKind.CONTACT_END, 0.0))
    tally = Tally(observe(seen(0), make_events(), 0))
    for k in range(1, 61):
        tally.add(observe(seen(k), touch if k == 8 else make_events(), round(k * 1e9 / 60)))
    row = tally.row()
    first, second = ({name[8:]: row[name] for name in row if name.startswith(f"point_{k}_")} for k in (0, 1))
    assert (first["contacts"], first["contact_time_s"]) == (1, pytest.approx(0.03)) and first["force_peak_n"] == 0.5
    assert (first["path_m"], first["path_error_rms_m"], first["progress"]) == (0.0, None, None)
    assert (second["contacts"], second["contact_time_s"], second["work_j"]) == (0, 0.0, 0.25)
    assert (second["path_m"], second["force_mean_n"]) == (pytest.approx(0.1), pytest.approx(3.0))
    assert (second["force_peak_n"], second["path_error_max_m"], second["progress"]) == (5.0, 4.5e-3, 0.5)
    # a ramp from a to b has the mean square (a^2 + ab + b^2) / 3; the trapezoidal rule adds (b - a)^2 / (6 n^2)
    assert second["path_error_rms_m"] ** 2 == pytest.approx((28.0 / 3.0 + 4.0 / (6.0 * 60**2)) * 1e-6, rel=1e-9)
    assert (row["contacts"], row["force_peak_n"], row["path_m"]) == (1, 5.0, 0.0), "of all points; of the first"


def test_the_total_of_a_distance_keeps_its_fraction_and_that_of_a_count_is_whole():
    totals = session_result([{"walked_m": 80.7, "contacts": 2}, {"walked_m": 0.5, "contacts": 3}])
    assert totals["walked_m"] == pytest.approx(81.2, rel=1e-12)
    assert totals["contacts"] == 5 and isinstance(totals["contacts"], int)


def test_contacts_are_counted_and_timed_at_the_tick_not_the_frame():
    tally = Tally(frame(0))
    tally.add(frame(16 * MS, (3 * MS, EventKind.CONTACT_BEGIN, 1.0), (5 * MS, EventKind.CONTACT_END, 0.0)))
    tally.add(frame(32 * MS, (30 * MS, EventKind.CONTACT_BEGIN, 1.0), penetration=0.001))
    tally.add(frame(48 * MS, penetration=0.001))
    tally.add(frame(64 * MS, (50 * MS, EventKind.CONTACT_END, 0.0), (51 * MS, EventKind.TRIP, 0.0)))
    assert tally.measures().contacts == 2
    assert tally.measures().contact_time_s == pytest.approx(0.002 + 0.020, abs=1e-12)


def test_contact_still_held_counts_up_to_now():
    tally = Tally(frame(0))
    tally.add(frame(10 * MS, (4 * MS, EventKind.CONTACT_BEGIN, 1.0), penetration=0.001))
    tally.add(frame(20 * MS, penetration=0.001))
    assert tally.measures().contact_time_s == pytest.approx(0.016, abs=1e-12)


def test_contact_that_lasts_into_the_travel_is_counted_once_and_timed_from_its_beginning():
    tally = Tally(frame(100 * MS, penetration=0.001))
    tally.add(frame(116 * MS, (90 * MS, EventKind.CONTACT_BEGIN, 1.0), (110 * MS, EventKind.CONTACT_END, 0.0)))
    assert (tally.measures().contacts, tally.measures().contact_time_s) == (1, pytest.approx(0.010, abs=1e-12))


def test_a_contact_with_an_object_lasts_until_its_end():
    tally = Tally(frame(0))
    tally.add(frame(16 * MS, (4 * MS, EventKind.CONTACT_BEGIN, 1.0), partners=1))
    for k in range(2, 10):
        tally.add(frame(16 * k * MS, partners=1))
    tally.add(frame(160 * MS, (154 * MS, EventKind.CONTACT_END, 0.0)))
    assert (tally.measures().contacts, tally.measures().contact_time_s) == (1, pytest.approx(0.150, abs=1e-12))


def test_contacts_that_overlap_are_timed_once_to_the_end_of_the_last():
    tally = Tally(frame(0, partners=1))
    tally.add(frame(16 * MS, (4 * MS, EventKind.CONTACT_BEGIN, 1.0), (8 * MS, EventKind.CONTACT_END, 0.0), partners=1))
    tally.add(frame(32 * MS, partners=1))
    tally.add(frame(48 * MS, (40 * MS, EventKind.CONTACT_END, 0.0)))
    assert (tally.measures().contacts, tally.measures().contact_time_s) == (2, pytest.approx(0.040, abs=1e-12))


def test_contact_whose_end_was_lost_does_not_last_for_ever():
    tally = Tally(frame(0, penetration=0.001))
    tally.add(frame(10 * MS))
    tally.add(frame(1000 * MS))
    assert tally.measures().contact_time_s == pytest.approx(0.010, abs=1e-12)


def test_contact_whose_event_comes_a_frame_late_is_not_counted_twice():
    """Published again from before the frame that found nothing touched: no instant belongs to two contacts."""
    tally = Tally(frame(0, penetration=0.001))
    tally.add(frame(10 * MS))
    tally.add(frame(12 * MS, (4 * MS, EventKind.CONTACT_BEGIN, 1.0), penetration=0.001))
    assert tally.measures().contact_time_s == pytest.approx(0.012, abs=1e-12)


def minimum_jerk_speed(t):
    return 30 * t**2 - 60 * t**3 + 30 * t**4


def exact_minimum_jerk_sparc():
    """Arc length from the Fourier integral itself (midpoint rule, fine), no FFT, no padding."""
    t = (np.arange(4000) + 0.5) / 4000
    f = np.linspace(0.0, 4.0, 2001)
    magnitude = np.abs(np.exp(-2j * np.pi * f[:, None] * t) @ minimum_jerk_speed(t)) / 4000
    last = np.flatnonzero(magnitude >= 0.05)[-1]
    return -np.sum(np.hypot(1.0 / last, np.diff(magnitude[: last + 1])))


@pytest.mark.parametrize(("rate", "duration"), [(60, 1.0), (100, 1.0), (1000, 1.0), (60, 3.0), (60, 30.0)])
def test_sparc_of_a_minimum_jerk_reach(rate, duration):
    t = np.arange(round(rate * duration) + 1) / (rate * duration)
    exact = exact_minimum_jerk_sparc()
    assert exact == pytest.approx(-1.408, abs=0.001)
    # The last bin is known to one bin of the padded spectrum, >= 40 bins here; there the curve falls by < 0.5 per bin
    assert sparc(minimum_jerk_speed(t), rate) == pytest.approx(exact, abs=0.5 / 40)


def test_sparc_knows_no_amplitude():
    t = np.linspace(0.0, 1.0, 101)
    assert sparc(1e-6 * minimum_jerk_speed(t), 100) == pytest.approx(sparc(minimum_jerk_speed(t), 100), rel=1e-12)


def test_every_submovement_makes_it_less_smooth():
    one = minimum_jerk_speed(np.linspace(0.0, 1.0, 61))
    values = [sparc(np.tile(one, n), 60.0) for n in (1, 2, 3, 5)]
    assert values == sorted(values, reverse=True) and values[1] < values[0] - 0.5


def test_tremor_makes_it_less_smooth():
    t = np.linspace(0.0, 2.0, 121)
    smooth = minimum_jerk_speed(t / 2.0)
    assert sparc(smooth + 0.4 * np.sin(2 * np.pi * 5.0 * t) * smooth, 60.0) < sparc(smooth, 60.0) - 0.3


@pytest.mark.parametrize("speed", [np.zeros(0), np.ones(3), np.zeros(100)], ids=["empty", "too short", "no movement"])
def test_sparc_of_nothing_to_judge(speed):
    assert sparc(speed, 60.0) is None


def test_resampling_a_straight_line_of_uneven_frames_is_exact():
    times = np.cumsum(np.random.default_rng(2).uniform(0.001, 0.05, 300))
    speeds = resample_speed(times, 2.0 * times)
    expected = 2.0 * (times[0] + np.arange(len(speeds)) / RESAMPLE_HZ)
    np.testing.assert_allclose(speeds, expected, rtol=1e-12)
    assert 0.0 <= times[-1] - expected[-1] / 2.0 < 1.0 / RESAMPLE_HZ + 1e-9


def test_tally_of_a_minimum_jerk_reach_has_its_smoothness():
    t = np.linspace(0.0, 2.0, 121)
    measures = travel(t, v_world=[np.array([0.0, v, 0.0]) for v in minimum_jerk_speed(t / 2.0)])
    assert measures.smoothness == pytest.approx(exact_minimum_jerk_sparc(), abs=0.5 / 40)


@pytest.mark.parametrize(
    ("value", "marks"), [(8.0, 1.0), (40.0, 0.0), (24.0, 0.5), (0.0, 1.0), (99.0, 0.0), (math.inf, 0.0)]
)
def test_marks_of_a_measure_where_less_is_better(value, marks):
    assert part_marks(ScorePartSpec(weight=1.0, best=8.0, worst=40.0), value) == marks


@pytest.mark.parametrize(("value", "marks"), [(-1.0, 1.0), (-3.0, 0.5), (-5.0, 0.0), (-math.inf, 0.0)])
def test_marks_of_a_measure_where_more_is_better(value, marks):
    assert part_marks(ScorePartSpec(weight=1.0, best=-1.0, worst=-5.0), value) == marks


def test_points_weigh_the_marks():
    spec = ScoreSpec(
        time=ScorePartSpec(weight=3.0, best=0.0, worst=10.0),
        path_error=ScorePartSpec(weight=1.0, best=0.0, worst=0.01),
        contacts=ScorePartSpec(weight=0.0, best=0.0, worst=1.0),
        smoothness=ScorePartSpec(weight=1.0, best=-1.0, worst=-3.0),
    )
    measures = Measures(time_s=2.0, path_error_rms_m=0.005, contacts=50, smoothness=-2.0, progress=0.4)
    points = 100.0 * (3.0 * 0.8 + 0.5 + 0.5) / 5.0
    assert trial_points(spec, asdict(measures), finished=True) == pytest.approx(points)
    assert trial_points(spec, asdict(measures), finished=False) == pytest.approx(0.4 * points)


def test_best_and_worst_travel_have_100_and_0_points():
    best = Measures(time_s=1.0, path_error_rms_m=0.0, smoothness=-1.4, progress=1.0)
    worst = Measures(time_s=99.0, path_error_rms_m=1.0, contacts=99, smoothness=-99.0, progress=1.0)
    assert trial_points(ScoreSpec(), asdict(best), finished=True) == pytest.approx(100.0)
    assert trial_points(ScoreSpec(), asdict(worst), finished=True) == 0.0


def test_a_measure_that_the_task_does_not_take_counts_in_neither_sum():
    judged = ScoreSpec(
        time=ScorePartSpec(weight=1.0, best=0.0, worst=10.0),
        path_error=ScorePartSpec(weight=9.0, best=0.0, worst=0.01),
        contacts=ScorePartSpec(weight=0.0, best=0.0, worst=1.0),
        smoothness=ScorePartSpec(weight=0.0, best=-1.0, worst=-3.0),
    )
    assert trial_points(judged, asdict(Measures(time_s=5.0)), finished=True) == pytest.approx(50.0)
    no_way = travel([0.0, 1.0])
    assert no_way.path_error_rms_m is None and no_way.path_error_max_m is None
