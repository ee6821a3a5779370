"""The methods of anti-aliasing, by the figures that the chart shows."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mimics_app.contracts.errors import DeviceError
from mimics_app.lab.catalogue import load_methods
from mimics_app.lab.groups.anti_aliasing import ANGLES, covered, edge_error
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen

PLAIN = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0, tone_map="none")


@pytest.fixture(scope="module", autouse=True)
def _a_driver_that_draws():
    try:
        open_offscreen("auto", (8, 8)).close()
    except DeviceError as error:
        pytest.skip(str(error))


def test_each_rival_lowers_the_error_of_edges():
    """All or nothing is wrong by sqrt(1/12) where coverage is spread evenly, by 1/2 along the pixels' diagonals."""
    found = {method.name: method.error() for method in load_methods(["anti aliasing"]).rivals("anti aliasing")}
    assert 0.25 < found["none"] < 0.33
    assert found["filter"] < 0.1, "the tolerance of a training, within which the planner takes it"
    assert found["4 samples"] < 0.45 * found["none"]
    assert found["4 samples, filter"] < 1.15 * found["4 samples"]


def test_the_covered_share_is_that_of_a_line():
    """Half of the picture, turned over by half a turn; a level line cuts no pixel of an even picture."""
    for angle in ANGLES:
        share = covered(angle)
        assert share.mean() == pytest.approx(0.5, abs=1e-3)
    assert set(covered(0.0).ravel()) == {0.0, 1.0}


def test_the_filter_is_best_where_edges_are_nearly_level():
    """Four samples know five shares; a long step shows the filter where between two rows an edge is."""
    angle = (0.06,)
    assert edge_error(replace(PLAIN, fxaa=True), angle) < 0.7 * edge_error(replace(PLAIN, msaa=4), angle)
