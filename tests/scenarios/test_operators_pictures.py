"""Pictures at the operator's page: that of the person, and another view of the scene beside it."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from playwright import sync_api

from mimics_app.app.picture.around_hand import AROUND, around
from mimics_app.maths.mat import look_at
from tests.support.operators_page import LinkedSession, served

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: apt-get install chromium")


@pytest.fixture(scope="module")
def play(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[LinkedSession, Any]]:
    with served(tmp_path_factory.mktemp("run")) as address, sync_api.sync_playwright() as started:
        session = LinkedSession(tmp_path_factory.mktemp("runs"), "wavy_tunnel", lost="continue")
        session.draw()
        browser = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        tab = browser.new_page(viewport={"width": 1280, "height": 720})
        tab.goto(address.url)
        yield session, tab
        browser.close()
        session.close()


def shown(tab: Any, place: str) -> np.ndarray[Any, Any]:
    """Pixels of a picture of the page, as the browser has them."""
    width, height, pixels = tab.locator(place).evaluate(
        "node => { const at = document.createElement('canvas').getContext('2d'); at.canvas.width = node.naturalWidth;"
        "at.canvas.height = node.naturalHeight; at.drawImage(node, 0, 0);"
        "const { width, height, data } = at.getImageData(0, 0, node.naturalWidth, node.naturalHeight);"
        "return [width, height, [...data]]; }"
    )
    return np.array(pixels, float).reshape(height, width, 4)[..., :3]


def test_the_person_s_picture_is_that_of_the_surface(play: tuple[LinkedSession, Any]) -> None:
    session, tab = play
    session.play_until(lambda: tab.locator("#picture-image").is_visible())
    assert tab.locator("#second-image").is_hidden()
    assert tab.locator("#picture-image").evaluate("node => [node.naturalWidth, node.naturalHeight]") == [320, 180]


def test_another_view_is_drawn_beside_it_while_the_person_keeps_theirs(play: tuple[LinkedSession, Any]) -> None:
    session, tab = play
    view = session.session.view
    session.play_until(lambda: tab.locator("#second").is_enabled())
    tab.locator("#second").select_option("from above")
    session.play_until(lambda: tab.locator("#second-image").is_visible())
    assert session.play_until(lambda: session.journal("second_view"))[-1]["view"] == "from above"
    assert session.session.view == view and not session.commands("view")
    assert "from above" in tab.locator("#second-image").get_attribute("alt")
    above, person = shown(tab, "#second-image"), shown(tab, "#picture-image")
    assert above.shape == (270, 480, 3) and np.abs(above[::3, ::3] - person[::2, ::2]).mean() > 10.0
    if folder := os.environ.get("KEEP_PICTURES"):
        tab.screenshot(path=f"{folder}/second_view.png", full_page=True)
    tab.locator("#second").select_option("")
    session.play_until(lambda: tab.locator("#second-image").is_hidden())
    assert session.play_until(lambda: session.journal("second_view")[1:])[-1]["view"] == ""


def test_a_second_view_is_that_of_its_camera_and_the_hand_is_in_the_centre_of_the_others() -> None:
    eye, hand = look_at((0.3, 0.9, 1.4), (0.0, 0.5, 0.2)), np.array([0.1, 0.2, -0.1])
    for view, (turn, rise) in AROUND.items():
        pose = around(view, eye, hand)
        reach = np.linalg.norm(eye[:3, 3] - hand)
        assert np.allclose(np.linalg.inv(pose) @ [*hand, 1.0], [0.0, 0.0, -reach, 1.0])
        now, before = (np.degrees(np.arctan2(*(each[[0, 2], 3] - hand[[0, 2]]))) for each in (pose, eye))
        assert np.isclose(now - before, turn)
        assert np.isclose(
            pose[1, 3] - hand[1], eye[1, 3] - hand[1] if rise is None else reach * np.sin(np.radians(rise))
        )
