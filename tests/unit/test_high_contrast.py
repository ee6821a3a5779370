"""High contrast: every text that is drawn is at least 7:1 to what is behind it, by the formula of WCAG 2.1."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.picture.board import BoardLayout
from mimics_app.app.play.launching import launcher_cards, launcher_settings, settings_of_choice
from mimics_app.app.play.session_keys import OPERATORS_PAGE
from mimics_app.app.session.requested import read_requested
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.messages.board import Bar, Board, Card, Tone
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.figures.contrast import high_contrast, in_high_contrast, ink_in_contrast
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.figures.key_page import draw_keys
from mimics_app.rendering.visual.figures.palette import TONES, tone_colour
from mimics_app.rendering.visual.launcher.launcher import LauncherChoice
from mimics_app.rendering.visual.launcher.launcher_page import LauncherPage, PageState
from mimics_app.world.components.visible import LightComponent, MeshComponent
from tests.support.watched_hud import page_canvas
from tests.unit.test_status_colours import CONES, LEAST_APART, STATUS, contrast, least_apart

LEAST = 7.0
"""WCAG 2.1, 1.4.6."""
BOX, GLYPH = 0.0, 1.0
Rgb = tuple[float, float, float]


def texts_on_grounds(hud: Hud, picture: Rgb) -> Iterator[tuple[Rgb, Rgb]]:
    """Yield the colour of each glyph and of what is behind it: the boxes below it, over a picture of one colour."""
    rows = hud.rows()
    boxes = []
    for row in rows:
        kind, _, border, _ = row["style"]
        left, bottom, width, height = row["box"]
        if kind == BOX and border == 0.0:
            boxes.append((left, bottom, left + width, bottom + height, row["tint"]))
        elif kind == GLYPH and width > 0.0:
            x, y, ground = left + 0.5 * width, bottom + 0.5 * height, np.array(picture)
            for low_x, low_y, high_x, high_y, tint in boxes:
                if low_x <= x <= high_x and low_y <= y <= high_y:
                    ground = ground + float(tint[3]) * (np.array(tint[:3]) - ground)
            yield tuple(map(float, row["tint"][:3])), tuple(map(float, ground))  # type: ignore[misc]


def worst(hud: Hud, picture: Rgb = (0.0, 0.0, 0.0)) -> float:
    return min(contrast(*pair) for pair in set(texts_on_grounds(hud, picture)))


def board() -> Board:
    cards = {tone.value: Card(f"Card {tone}", "8.8 N", tone, remark="remark") for tone in Tone if tone in TONES}
    bars = {f"bar {tone}": Card("Force", "8 N", bar=Bar(0.5, 1.0, tone, right=(0.2, 0.4))) for tone in Tone}
    return Board({**cards, **bars}, message="Squeeze as hard as you can", count=3)


@pytest.mark.parametrize("picture", [(0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.5, 0.3, 0.2)])
@pytest.mark.parametrize("alarm", [False, True])
def test_board_and_messages(picture: Rgb, alarm: bool) -> None:
    hud, shown = page_canvas((1280, 720)), board()
    shown = Board(shown.cards, shown.message, alarm, shown.count)
    with high_contrast():
        BoardLayout().lay(hud, shown, list(shown.cards), 10.0)
        assert worst(hud, picture) >= LEAST
        draw_keys(hud, OPERATORS_PAGE.keys)
        assert worst(hud, picture) >= LEAST
    assert not in_high_contrast()


def test_the_launcher(tmp_path: Path) -> None:
    cards, settings, hud = launcher_cards(tmp_path), launcher_settings(), page_canvas((1280, 720))
    values = {setting.name: setting.default for setting in settings}
    page = LauncherPage(hud)
    with high_contrast():
        for focus in (("card", 0), ("option", 3), ("start", 0), ("people", 0)):
            listed = [(card, 0) for card in cards[:4]]
            page.state = PageState(listed, 0, focus, ["All", "Tasks"], 0, "", settings, values, "A notice")
            page.draw()
            assert worst(hud) >= LEAST, focus


def test_usual_colours_are_found_to_be_less() -> None:
    """The test finds what it is for."""
    hud, shown = page_canvas((1280, 720)), board()
    BoardLayout().lay(hud, shown, list(shown.cards), 10.0)
    assert worst(hud, (1.0, 1.0, 1.0)) < LEAST


@pytest.mark.parametrize("cones", CONES)
def test_the_tones_are_still_told_apart(cones: str) -> None:
    with high_contrast():
        shown = [ink_in_contrast(tone_colour(tone)) for tone in STATUS]
    assert least_apart(shown, cones) >= LEAST_APART


@pytest.mark.parametrize(
    ("value", "larger", "high"),
    [("", False, False), ("larger", True, False), ("contrast", False, True), ("both", True, True)],
)
def test_it_is_chosen_in_the_launcher(value: str, larger: bool, high: bool) -> None:
    chosen = {setting.name: setting.default for setting in launcher_settings()}
    settings = settings_of_choice(LauncherChoice(Path("a"), {**chosen, "text": value}))
    assert (settings.larger_text, settings.high_contrast) == (larger, high)


def shown(colour: tuple[float, ...]) -> Rgb:
    """Display values of a linear colour (IEC 61966-2-1)."""
    red, green, blue = (
        12.92 * each if each <= 0.0031308 else 1.055 * each ** (1.0 / 2.4) - 0.055 for each in colour[:3]
    )
    return red, green, blue


@pytest.mark.parametrize("name", ["wavy_tunnel", "calibration", "pick_and_place"])
def test_targets_paths_and_the_hand_stand_out_in_the_scene(name: str) -> None:
    scene = read_requested(RunSettings(root() / "scenes" / f"{name}.json", high_contrast=True))
    roles = scene.document["systems"]["contrast"]["materials"]
    found: dict[str, list[Rgb]] = {}
    for material, role in roles.items():
        assert scene.materials[material].technique == "unlit", "its colour is what is shown"
        found.setdefault(role, []).append(shown(scene.materials[material].base_colour))
    assert found.keys() >= {"target", "ground"}
    for role in found.keys() - {"ground"}:
        assert all(contrast(one, ground) >= LEAST for one in found[role] for ground in found["ground"]), role
    usual = read_requested(RunSettings(root() / "scenes" / f"{name}.json"))
    assert usual.hash != scene.hash and usual.materials != scene.materials


@pytest.mark.parametrize("name", ["tower", "city_walk", "canyon_walk", "soccer", "two_fingers"])
def test_what_is_felt_or_named_by_the_task_stands_out_of_a_scene_without_roles(name: str) -> None:
    file = next((root() / "scenes").rglob(f"{name}.json"))
    scene, usual = read_requested(RunSettings(file, high_contrast=True)), read_requested(RunSettings(file))
    drawn = {mesh.material for _, mesh, _ in scene.components(MeshComponent)} & scene.materials.keys()
    shown_in = {each: scene.materials[each] for each in drawn if each.startswith("contrast_")}
    assert shown_in and all(material.technique == "unlit" for material in shown_in.values())
    (_, dim, _), (_, bright, _) = (next(iter(each.components(LightComponent))) for each in (scene, usual))
    white = shown((dim.intensity / bright.intensity,) * 3)
    assert all(contrast(shown(material.base_colour), white) >= 5.0 for material in shown_in.values())


@pytest.mark.parametrize(
    ("name", "pressed"), [("lokomat_wall", "wall"), ("lokomat_obstacle", "wall"), ("springs_and_magnets", "spring")]
)
def test_what_is_felt_without_a_haptic_object_stands_out(name: str, pressed: str) -> None:
    scene = read_requested(RunSettings(root() / "scenes" / "examples" / f"{name}.json", high_contrast=True))
    (named,) = (mesh.material for entity, mesh, _ in scene.components(MeshComponent) if entity == pressed)
    material = scene.materials[str(named)]
    assert material.technique == "unlit" and contrast(shown(material.base_colour), (0.0, 0.0, 0.0)) >= LEAST


def test_a_scene_that_a_program_opens_has_it_as_that_scene_says() -> None:
    for high in (True, False):
        with mimics.open("wavy_tunnel", record=False, high_contrast=high) as session:
            session.step()
            assert in_high_contrast() is high
