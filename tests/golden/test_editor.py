"""The editor by keyboard and mouse alone, as events of a window."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mimics_app.app.viewer.editor import Editor
from mimics_app.app.viewer.selection import Selection
from mimics_app.app.viewer.shown import open_shown
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.rendering.visual.surfaces.contexts import create_surface

SCENE = """{"format": "mimics-scene", "version": 1, "x-mine":   "stays",
  "entities": [
    {"id": "sun", "components": {"light": {"target": [-1, -2, -1]}}},
    {"id": "cube", "transform": {"translation": [0, 0.25, 0]}, "components": {"mesh":
        {"primitive": {"shape": "box", "size": [0.5, 0.5, 0.5]}}}}]}
"""


class Hands:
    """Somebody with a keyboard and a mouse, and what the editor said to them."""

    def __init__(self, file: Path, surface) -> None:
        shown = open_shown(file)
        self.viewport, self.selection = Viewport(surface, shown), Selection(shown)
        self.said: list[tuple[str, bool]] = []
        self.editor = Editor(
            self.viewport, self.selection, lambda text, *, alarm=False: self.said.append((text, alarm))
        )
        self.editor.open = True
        self.look()

    def look(self) -> None:
        self.editor.follow()
        self.viewport.renderer.hud.clear()
        self.viewport.views()
        self.editor.draw()

    def keys(self, *names: str) -> None:
        for name in names:
            *held, key = name.split("+")
            for each in held:
                self.editor.handle(InputEvent("key", f"left_{each}", pressed=True))
            self.editor.handle(InputEvent("key", key, pressed=True))
            for each in held:
                self.editor.handle(InputEvent("key", f"left_{each}"))
            self.look()

    def type(self, text: str) -> None:
        for character in text:
            self.editor.handle(InputEvent("text", character))

    def point(self, kind: str, **wanted: object) -> bool:
        """Move the pointer to a part of the page."""
        hud = self.viewport.renderer.hud
        (x, y, width, height), _ = next(
            (box, hit)
            for box, hit in reversed(self.editor._page._hits)
            if hit.kind == kind and all(getattr(hit, key) == value for key, value in wanted.items())
        )
        at = (2.0 * (x + 0.5 * width) / hud.width - 1.0, 2.0 * (y + 0.5 * height) / hud.height - 1.0)
        return self.editor.handle(InputEvent("move", x=at[0], y=at[1]))

    def click(self, kind: str, **wanted: object) -> None:
        self.point(kind, **wanted)
        assert self.editor.handle(InputEvent("button", "left", pressed=True)), "it is not for the picture"
        assert self.editor.handle(InputEvent("button", "left"))
        self.look()

    @property
    def text(self) -> str:
        return self.editor.edited.texts.text(self.editor.edited.texts.files[0])


@pytest.fixture
def hands(tmp_path):
    file = tmp_path / "place.json"
    file.write_text(SCENE)
    with create_surface("egl", (640, 360)) as surface:
        hands = Hands(file, surface)
        yield hands
        hands.editor.close()
        hands.viewport.release()


def test_everything_by_keyboard(hands, tmp_path):
    hands.keys("tab", "end", "enter")  # the list, its last entity, its values
    assert hands.selection.chosen.name == "cube" and hands.editor.focus == "fields"
    hands.keys("down", "down", "down", "right")
    hands.type("0.40")
    hands.keys("enter", "page_up", "page_up")
    assert hands.text == SCENE.replace("0.25, 0]", "0.42, 0]")
    assert hands.selection.chosen.position[1] == 0.42
    hands.keys("control+z")
    assert "0.40, 0]" in hands.text, "two steps of one value are one"
    hands.keys("end", "enter")
    hands.type("haptic_ob")
    hands.keys("enter", "delete")
    assert hands.editor.edited.undo() == "cube: components.haptic_object removed"
    hands.keys("insert")
    hands.type("sph")
    hands.keys("enter")
    assert hands.selection.chosen.name == "sphere" and not hands.editor.edited.faults
    hands.keys("control+d", "escape")
    assert hands.selection.chosen.name == "sphere_2" and hands.editor.focus == "picture"
    hands.keys("delete")
    assert hands.selection.chosen is None and "sphere_2" not in hands.viewport.shown.world
    hands.keys("control+y", "control+z", "control+s")
    saved = json.loads((tmp_path / "place.json").read_text())
    assert [each["id"] for each in saved["entities"]] == ["sun", "cube", "sphere", "sphere_2"]
    assert hands.said[-1] == ("saved place.json", False) and not hands.editor.not_saved
    hands.keys("control+shift+s", "enter")
    assert (tmp_path / "place_2.json").read_text() == hands.text and hands.said[-1][0].endswith("from now on")


def test_everything_by_mouse(hands):
    hands.click("entity", name="cube")
    assert hands.selection.chosen.name == "cube"
    hands.click("row", number=3, cell=2)
    assert hands.editor.handle(InputEvent("wheel", y=1.0))
    hands.look()
    assert hands.text == SCENE.replace("0.25, 0]", "0.25, 0.001]")
    hands.type("2e9")
    hands.click("row", number=7, cell=0)
    assert hands.said[-1] == ('translation: "2e9" is too large: from -1 000 000 to 1 000 000', True)
    hands.click("button", name="undo")
    hands.click("button", name="duplicate")
    hands.click("button", name="delete")
    hands.click("button", name="undo")
    hands.click("button", name="undo")
    assert hands.text == SCENE
    hands.click("entity", name="cube")
    hands.editor.edited.delete(hands.editor.edited.find("sun"))
    hands.look()
    assert hands.editor._listed()[hands.editor._at].value == "cube", "the list follows what is selected"
    hands.click("button", name="undo")
    hands.click("button", name="add")
    hands.click("entity", name="lamp")
    assert hands.editor.edited.scene.entity("lamp").components["light"].kind == "point"
    hands.editor.handle(InputEvent("move", x=0.0, y=0.0))
    assert not hands.editor.handle(InputEvent("button", "left", pressed=True)), "the picture takes it"
    assert not hands.editor.handle(InputEvent("wheel", y=1.0))


def test_a_fault_is_found_by_its_key_and_shown_at_its_row(hands):
    hands.click("entity", name="cube")
    hands.editor.edited.put(hands.editor.place, ("components", "mesh", "material"), '"gold"')
    hands.keys("escape", "escape", "escape")
    assert hands.selection.chosen is None and not hands.editor.open
    hands.keys("f9")
    assert hands.editor.open and hands.selection.chosen.name == "cube", "what has faults is not played"
    row = hands.editor._rows()[hands.editor._row]
    assert row.label == "material" and row.cells[0].shown == "gold"
    hands.keys("delete", "f8")
    assert hands.text == SCENE and hands.said[-1] == ("no faults", False)


def test_the_value_in_focus_is_one_that_there_is(hands):
    hands.click("entity", name="cube")
    hands.editor.edited.put(hands.editor.place, ("components", "mesh", "material"), '"gold"')
    hands.look()
    hands.click("row", number=3, cell=2)  # z of the translation
    hands.keys("f8")
    hands.type("e")
    assert hands.editor._state().typed == "e", "in the only cell of the row with the fault"
    hands.keys("escape", "page_up")
    assert not hands.editor.edited.faults, "it has choices"
    hands.click("row", number=3, cell=2)
    hands.editor.handle(InputEvent("key", "escape", pressed=True))
    hands.editor.handle(InputEvent("key", "delete", pressed=True))  # and before that is drawn:
    hands.point("row", number=4)
    assert hands.editor.handle(InputEvent("button", "left", pressed=True))
    assert hands.editor.handle(InputEvent("button", "left"))
    assert hands.editor.handle(InputEvent("wheel", y=1.0))
    assert hands.editor.place is None and hands.selection.chosen is None


def test_what_somebody_else_saved_is_taken_or_told(hands, tmp_path):
    file = tmp_path / "place.json"
    file.write_text(SCENE.replace("0.25", "0.35"))
    hands.editor.take_files()
    assert hands.said[-1] == ("loaded again", False) and "0.35" in hands.text
    hands.click("entity", name="cube")
    hands.editor.edited.move("cube", (1.0, 0.0, 0.0))
    file.write_text(SCENE.replace("0.25", "0.45"))
    hands.editor.take_files()
    assert "place.json was changed on the disk" in hands.said[-1][0] and "[1.0, 0.0, 0]" in hands.text
    hands.keys("control+s")
    assert "not overwritten" in hands.said[-1][0] and "0.45" in file.read_text()
    hands.keys("control+r")
    assert hands.text == file.read_text() and not hands.editor.not_saved
    file.write_text(SCENE.replace('"box"', '"bowl"'))
    with pytest.raises(SceneError, match="bowl"):
        hands.editor.take_files()
    assert hands.editor.edited.faults and "cube" in hands.viewport.shown.world, "the old picture stays"
