"""A crossing of the beam: where feet count, gusts, falls, marks, and what impaired legs do on it."""

from __future__ import annotations

import numpy as np
import pytest
from msgspec import structs

from mimics_app.contracts.messages.orders import HapticField
from mimics_app.tasks.kinds.canyon_walk.crossing import MOST_SWAY, Beam, BeamSway, Crossing, Wind, exposure
from mimics_app.tasks.kinds.canyon_walk.kind import CanyonWalkPlay, CanyonWalkSpec
from mimics_app.tasks.observation import observe
from mimics_app.tasks.walking.legs import GAITS
from tests.support.task_play import make_events, make_snapshot

FRAME = 1.0 / 60.0
BEAM = Beam(20.0, 220.0, 0.6)


def _cross(gait: str, seed: int, width: float, metres: float, *, calm: bool = False) -> Crossing:
    """Somebody who leans against what carries them off the middle of the beam."""
    crossing = Crossing(Beam(20.0, 220.0, width), GAITS[gait], 30.0, seed, calm=calm)
    for _ in range(60 * 240):
        crossing.step(1.3, min(max(-4.0 * crossing.walker.x, -1.0), 1.0), FRAME)
        if crossing.along >= 30.0 + metres:
            break
    return crossing


def test_impaired_people_miss_the_beam_more_often_and_the_reason_shows() -> None:
    """Over seeds: the share of feet on the beam, evenness, lift and length of the steps fall from degree to degree."""
    found = []
    for gait in ("healthy", "hemiparetic", "severe"):
        walks = [_cross(gait, seed, 0.34, 20.0) for seed in range(4)]
        falls = [walk.walker.footfalls for walk in walks]
        found.append(
            (
                np.mean([1.0 - walk.missteps / walk.on_beam for walk in walks]),
                *(
                    np.mean([getattr(each, name) for each in falls])
                    for name in ("symmetry", "clearance", "step_length")
                ),
            )
        )
    for number, values in enumerate(zip(*found, strict=True)):
        assert values[0] > values[1] > values[2], (number, values)


def test_a_foot_counts_against_the_edge_of_the_beam() -> None:
    crossing = _cross("healthy", 1, 0.6, 15.0, calm=True)
    assert crossing.missteps == 0 and crossing.on_beam > 15 and crossing.falls == 0
    assert max(crossing.off) + 0.045 <= 0.3


def test_who_walks_off_the_beam_is_set_back_and_stands_for_a_moment() -> None:
    crossing = Crossing(BEAM, GAITS["healthy"], 40.0, 1, calm=True)
    while crossing.falls == 0:
        crossing.step(1.3, 1.0, FRAME)
    assert crossing.rests and crossing.walker.x == 0.0 and crossing.along > 39.0
    at = crossing.along
    for _ in range(60):
        crossing.step(1.3, 0.0, FRAME)
    assert crossing.along == pytest.approx(at), "nobody is hurried"
    assert crossing.missteps > 0


def test_the_marks_come_once_each_and_in_order() -> None:
    crossing = Crossing(Beam(2.0, 12.0, 2.0), GAITS["healthy"], 0.0, 1, calm=True)
    while crossing.along < 14.0:
        crossing.step(1.3, 0.0, FRAME)
    assert crossing.marks == ["on_beam", "half_way", "end"]


def test_wind_rises_with_the_exposure_and_gusts_push_but_not_in_the_calm_variant() -> None:
    assert [exposure(s, 20.0, 220.0) for s in (10.0, 20.0, 120.0, 220.0, 230.0)] == [0.0, 0.0, 1.0, 0.0, 0.0]
    blown = {}
    for calm in (False, True):
        wind = Wind(np.random.default_rng(1), calm=calm)
        rows = []
        for number in range(60 * 60):
            exposed = exposure(10.0 + number / 60.0, 20.0, 220.0)
            begins = wind.blow(exposed, FRAME)
            rows.append((exposed, wind.strength, wind.push, begins))
        blown[calm] = np.array(rows)
    gusty, calm_rows = blown[False], blown[True]
    assert (gusty[gusty[:, 0] == 0.0, 1:] == 0.0).all(), "none on the street"
    assert np.ptp(gusty[gusty[:, 0] == 1.0, 1]) > 0.2 and gusty[:, 3].sum() >= 3
    assert np.abs(gusty[:, 2]).max() > 0.4 and not calm_rows[:, 2:].any()
    assert calm_rows[-1, 1] == pytest.approx(0.5 * gusty[:, 1][gusty[:, 0] == 1.0].min(), rel=0.05)


def test_the_beam_sways_as_the_wind_is_strong_and_creaks_where_it_turns_in_a_gust() -> None:
    """Still on land; half as far in half the wind; without a jump; one creak each time it turns back in a gust."""
    swung = {}
    for strength in (0.0, 0.35, 0.5, 1.0):
        sway = BeamSway()
        rows = np.array([(sway.swing(strength, FRAME), sway.aside) for _ in range(60 * 20)])
        swung[strength] = rows
        turns = np.count_nonzero(np.diff(np.sign(np.diff(rows[:, 1]))))
        assert np.count_nonzero(rows[:, 0]) == (turns if strength > 0.4 else 0), "no creak in the steady wind"
        assert np.abs(np.diff(rows[:, 1])).max() <= 0.003, "nobody is jolted: 2 mm a frame"
    assert not swung[0.0].any() and np.abs(swung[1.0][:, 1]).max() == pytest.approx(MOST_SWAY, rel=1e-3)
    np.testing.assert_allclose(swung[0.5][:, 1], 0.5 * swung[1.0][:, 1])


def test_a_misstep_is_felt_at_its_foot_and_has_no_edge() -> None:
    """A force that swells to 4 N and fades, of at most 0.5 N from frame to frame; nothing is felt on a broad beam."""
    felt = []
    for width in (0.2, 2.0):
        spec = CanyonWalkSpec("person", "beam", begins=0.0, width=width, calm=True, cues=("left", "right"))
        play = CanyonWalkPlay(spec, 1)
        seen = observe(make_snapshot(), make_events(), 0)
        play.start_attempt(seen)
        x, y, z = seen.hip_world
        raised = structs.replace(seen, hip_world=(x, y + 0.08, z))
        forces = []
        for _ in range(60 * 8):
            play.travel(raised, 1.0 / 60.0)
            forces.append([play.orders[HapticField("force", "effects", foot)] for foot in ("left", "right")])
        felt.append(np.array(forces))
    missed, broad = felt
    assert (missed.max(axis=0) > 3.5).all() and missed.max() <= 4.0 and not broad.any()
    assert np.abs(np.diff(missed, axis=0)).max() < 0.5
