"""The heads-up display: readable, exactly placed, and at one depth for both eyes."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.errors import SceneError
from mimics_app.rendering.visual.displays.desktop import compute_tangents
from mimics_app.rendering.visual.figures.glyphs import load_glyph_atlas
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.passes.hud import plane_of_views
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.world import World

BLACK = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
WHITE = (1.0, 1.0, 1.0, 1.0)


def draw_hud(fill, size=(1280, 720), tangents=None, msaa=0, views=None, depth=1.0) -> NDArray[np.float64]:
    """Brightness 0-1 of a display on black, row 0 at the top."""
    tangents = tangents or compute_tangents(0.8, size)
    world = World()
    world.environment = BLACK
    world.update()
    with create_surface("egl", size) as surface:
        settings = RenderSettings(msaa=msaa, shadow_size=0, tone_map="none", hud_depth=depth)
        renderer = Renderer(surface, world, settings)
        renderer.hud.width = 720.0 * size[0] / size[1]
        fill(renderer.hud)
        renderer.draw(views or [View(np.eye(4), tangents, (0, 0, *size))])
        assert surface.ctx.error == "GL_NO_ERROR"
        return read_pixels(surface)[..., :3].mean(axis=-1) / 255.0


@pytest.mark.parametrize("sparse", [False, True])
def test_a_display_that_is_filled_while_the_world_is_drawn_is_of_that_frame(sparse):
    def fill() -> None:
        renderer.hud.clear()
        renderer.hud.box(5.0 * place, 0.0, 100.0, 100.0, WHITE)

    world = World()
    world.environment = BLACK
    world.update()
    view = View(np.eye(4), compute_tangents(0.8, (144, 144)), (0, 0, 144, 144))
    with create_surface("egl", (144, 144)) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=4, shadow_size=0, tone_map="none"), sparse=sparse)
        renderer.hud.width = 720.0
        for place in (10.0, 10.0, 50.0, 90.0):
            renderer.draw([view], None, fill)
            shown = read_pixels(surface)[::-1][10, :, 0] > 128
            assert np.flatnonzero(shown).tolist() == list(range(int(place), int(place) + 20))


@pytest.mark.parametrize("tangents", [(-0.8, 0.8, -0.45, 0.45), (0.2, 1.0, -0.7, -0.25)], ids=["centred", "off-axis"])
def test_a_box_lies_on_its_pixels(tangents):
    """At 1280 x 720 a canvas unit is a pixel: whole coordinates give sharp edges, whatever the frustum."""
    picture = draw_hud(lambda hud: hud.box(100.0, 50.0, 300.0, 40.0, WHITE), tangents=tangents)
    expected = np.zeros((720, 1280))
    expected[720 - 90 : 720 - 50, 100:400] = 1.0
    assert np.abs(picture - expected).max() <= 2.0 / 255.0


def test_a_bar_is_filled_to_its_share():
    track, full = (0.2, 0.2, 0.2, 1.0), WHITE
    picture = draw_hud(lambda hud: hud.bar((100.0, 100.0, 400.0, 20.0), 0.35, full, track=track))
    row = picture[720 - 110, 100:500]
    assert (row > 0.9).sum() == pytest.approx(0.35 * 400, abs=1)
    assert row[200:380] == pytest.approx(0.2, abs=0.01)
    for share in (float("nan"), -3.0, 0.0):
        assert draw_hud(lambda hud, s=share: hud.bar((100.0, 100.0, 400.0, 20.0), s, full, track=track)).max() < 0.21
    assert (draw_hud(lambda hud: hud.bar((100.0, 100.0, 400.0, 20.0), 7.0, full))[610, 101:499] > 0.9).all()


def test_boxes_words_and_images_lie_over_each_other_in_their_order():
    """In one display as each pair alone: words on a box, a box on words, an image on both, words on the image."""

    def fill(hud: Hud) -> None:
        hud.images = np.full((1, 4, 4, 4), 255, np.uint8)
        hud.images[..., :3] = 128
        hud.box(100.0, 100.0, 400.0, 200.0, (0.3, 0.3, 0.3, 1.0))
        hud.text(120.0, 250.0, "seen", 30.0)
        hud.text(120.0, 150.0, "hidden", 30.0)
        hud.box(110.0, 130.0, 150.0, 60.0, (0.3, 0.3, 0.3, 1.0))
        hud.image((300.0, 120.0, 150.0, 150.0), 0)
        hud.text(320.0, 180.0, "seen", 30.0)

    drawn = draw_hud(fill)[::-1]
    words = draw_hud(lambda hud: hud.text(120.0, 250.0, "seen", 30.0))[::-1]
    assert drawn[240:290, 105:290] == pytest.approx(0.3 + 0.7 * words[240:290, 105:290], abs=0.01)
    assert np.abs(drawn[110:200, 105:290] - 0.3).max() < 0.01, "a box hides the words before it"
    assert drawn[130:170, 305:445] == pytest.approx(128 / 255, abs=0.01) and drawn[175:215, 310:440].max() > 0.9


def test_every_character_has_its_own_ink():
    """Each digit drawn at reading size leaves ink inside its box, of full strength, and unlike any other digit's."""
    size = 24.0
    seen = {}
    for character in "0123456789%.MmNg":
        picture = draw_hud(lambda hud, c=character: hud.text(100.0, 100.0, c, size), size=(320, 360))
        scale = 360 / 720
        glyph = load_glyph_atlas().face(bold=False).glyphs[character]
        left, right = int(100 * scale) - 1, int((100 + glyph.advance * size) * scale) + 2
        bottom, top = 360 - int((100 - 0.3 * size) * scale), 360 - int((100 + size) * scale)
        inked = picture > 0.5
        assert inked.sum() >= 2, character
        outside = inked.copy()
        outside[top:bottom, left:right] = False
        assert not outside.any(), f"{character} leaves its box"
        key = picture[top:bottom, left : left + 14].round(1).tobytes()
        assert key not in seen, f"{character} looks like {seen.get(key)}"
        seen[key] = character


def test_text_is_crisp_at_720_lines():
    """A capital I at 24 px has stems about 2.4 px wide: full ink inside, and edges no wider than two pixels."""
    picture = draw_hud(lambda hud: hud.text(100.0, 100.0, "I", 24.0))
    row = picture[720 - 100 - 9, 95:115]
    assert row.max() > 0.97
    assert ((row > 0.05) & (row < 0.95)).sum() <= 2
    assert (row > 0.05).sum() <= 4


def test_capitals_stand_on_the_baseline_at_their_height():
    """DejaVu's capitals are 0.729 em high."""
    picture = draw_hud(lambda hud: hud.text(100.0, 200.0, "H", 100.0))
    rows = np.flatnonzero(picture.max(axis=1) > 0.5)
    assert 720 - 1 - rows.max() == pytest.approx(200, abs=1)
    assert rows.size == pytest.approx(72.9, abs=1.5)


def test_text_ends_where_it_is_measured():
    hud = Hud()
    length = hud.measure("Wall contacts 12", 40.0, bold=True)
    for align, left in (("left", 600.0), ("centre", 600.0 - 0.5 * length), ("right", 600.0 - length)):
        picture = draw_hud(lambda hud, a=align: hud.text(600.0, 300.0, "Wall contacts 12", 40.0, bold=True, align=a))
        columns = np.flatnonzero(picture.max(axis=0) > 0.5)
        # Side bearings: W and 2 keep up to 0.1 em from their boxes.
        assert columns.min() == pytest.approx(left, abs=5)
        assert columns.max() == pytest.approx(left + length, abs=5)


def test_long_text_is_cut_with_an_ellipsis():
    hud = Hud()
    assert hud.text(0.0, 0.0, "a very long line of text", 20.0, width=100.0) <= 100.0
    assert hud.rows().size < len("a very long line of text")
    lines = hud.wrap("one two three four five six seven eight nine ten", 20.0, 90.0, 3)
    assert len(lines) == 3 and lines[-1].endswith("…")
    assert all(hud.measure(line, 20.0) <= 90.0 for line in lines)
    assert " ".join(hud.wrap("one two three", 20.0, 90.0, 3)) == "one two three"


def test_a_character_the_font_lacks_becomes_a_box():
    hud = Hud()
    assert hud.text(0.0, 0.0, "\N{CJK UNIFIED IDEOGRAPH-4E00}", 20.0) > 5.0
    assert hud.rows().size == 1


@pytest.mark.parametrize(("wanted", "depth"), [(2.0, 2.0), (1.0, 1.28)])
def test_both_eyes_see_it_at_its_depth_and_no_nearer_than_is_easy(wanted, depth):
    """Disparity of a plane at depth d for parallel eyes e apart: e / d in tangents."""
    separation = 0.064
    tangents = (-0.5, 0.5, -0.28125, 0.28125)
    views = []
    for index, sign in enumerate((-0.5, 0.5)):
        pose = np.eye(4)
        pose[0, 3] = sign * separation
        views.append(View(pose, tangents, (640 * index, 0, 640, 360)))
    assert plane_of_views(views, wanted).canvas_width == pytest.approx(1280.0)
    picture = draw_hud(
        lambda hud: hud.box(630.0, 350.0, 20.0, 20.0, WHITE), (1280, 360), msaa=4, views=views, depth=wanted
    )
    eyes = [picture[:, :640].sum(axis=0), picture[:, 640:].sum(axis=0)]
    centres = [(light * (np.arange(640) + 0.5)).sum() / light.sum() for light in eyes]
    assert centres[0] - centres[1] == pytest.approx(separation / depth * 640, abs=0.1)
    assert 0.5 * (centres[0] + centres[1]) == pytest.approx(320.0, abs=0.1)


def test_a_broken_atlas_names_its_builder(tmp_path):
    with pytest.raises(SceneError, match="mimics assets build fonts"):
        load_glyph_atlas(tmp_path)
