"""The editor of the viewer: list of entities, inspector and commands, by keyboard and mouse."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np

from mimics_app.app.viewer.edited_scene import EditedScene, Place, pointer_of
from mimics_app.app.viewer.editor_page import EditorPage, EditorState, Hit, ListRow
from mimics_app.app.viewer.inspected import Cell, Row, component_names, default_of, object_of
from mimics_app.app.viewer.new_entities import Template, templates_of
from mimics_app.app.viewer.played_scene import PlayedScene
from mimics_app.app.viewer.selection import Selection
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.contracts.errors import Issue, MimicsError, SceneError
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.world.files.reading.json_edit import source_of

__all__ = ["Editor", "Say"]

_ADD = Row("+ component", ("components",), 0, help="Add a component to this entity")
_SHARE = 0.12
"""Width of new bodies, and offset of copies, in distances of the camera."""
_MODIFIERS = {"left_control": "ctrl", "right_control": "ctrl", "left_shift": "shift", "right_shift": "shift"}
_OF_THE_WINDOW = re.compile(r"f[0-9]+")
"""Keys that do the same wherever the focus is."""
_STEPS = {"page_up": 1, "page_down": -1}


class Say(Protocol):
    """Shows a message over the picture."""

    def __call__(self, text: str, *, alarm: bool = False) -> None: ...


class Editor:
    """Edits the scene in the viewer.

    Args:
        viewport: Viewport that shows the scene.
        selection: Selection in the picture; the editor's is the same.
        say: Shows a message.

    Attributes:
        edited: The scene with its unsaved edits.
        open: Whether the panels are shown.
        focus: What the keys go to: "picture", "list", "fields", "add", "component" (lists to choose from) or "name".
        saved: Files that were written.
    """

    def __init__(self, viewport: Viewport, selection: Selection, say: Say) -> None:
        self._viewport, self._selection, self._say = viewport, selection, say
        self.edited = EditedScene(viewport.shown)
        self._page = EditorPage(viewport.renderer.hud)
        self.open, self.focus, self.saved = False, "picture", list[Path]()
        self._name, self._search, self._at = "", "", 0
        self._row = self._cell = 0
        self._typed: str | None = None
        self._unfolded: set[tuple[str, ...]] = set()
        self._held: set[str] = set()
        self._pointer = (0.0, 0.0)
        self._pressed = self._written = False
        self._played: PlayedScene | None = None
        self._doing = ""
        self._commands: dict[str, Callable[[], object]] = {
            "ctrl+s": self.save,
            "ctrl+shift+s": self._ask_name,
            "ctrl+z": self.undo,
            "ctrl+y": self._redo,
            "ctrl+shift+z": self._redo,
            "ctrl+d": self._duplicate,
            "ctrl+r": self._read_again,
            "insert": lambda: self._choose_from("add"),
            "f8": self._next_fault,
            "f9": self._play,
        }

    @property
    def place(self) -> Place | None:
        """Where the selected entity is written, None where none is selected."""
        return self.edited.find(self._name) if self._name else None

    @property
    def not_saved(self) -> list[str]:
        """The steps since the edits were saved, in words."""
        unsaved, steps = self.edited.texts.unsaved, self.edited.texts.steps
        return [f"{file.name}, {step}" for file in list(unsaved)[:1] for step in steps or ["undone steps"]]

    def handle(self, event: InputEvent) -> bool:
        """Process an event; return whether it is not for the picture."""
        if event.kind == "key" and event.name in _MODIFIERS:
            (self._held.add if event.pressed else self._held.discard)(_MODIFIERS[event.name])
            return False
        if event.kind == "key" and event.pressed:
            return self._press(event)
        if event.kind == "text":
            return self._type(event.name)
        if event.kind == "wheel":
            return self._turn_wheel(event)
        if event.kind == "move":
            hud = self._viewport.renderer.hud
            self._pointer = 0.5 * (event.x + 1.0) * hud.width, 0.5 * (event.y + 1.0) * hud.height
        if event.kind == "button":
            return self._click(event)
        return False

    def follow(self) -> bool:
        """Apply edits, take over the selection in the picture, and see whether a session ended.

        Returns:
            Whether there is anything new to draw.
        """
        changed = self.edited.stale
        if changed:
            self.edited.apply()
            self._find_row()
        chosen = self._selection.chosen
        if chosen is None or chosen.name != self._name:
            if chosen is not None:
                self._select(chosen.name)
                changed = True
            elif self._name and self._name in self._viewport.shown.world:
                self._select("")
                changed = True
        return self._watch_session() or changed

    def _watch_session(self) -> bool:
        """Say what a session does until it is seen, and why it ended; return whether anything is new."""
        if self._played is None:
            return False
        outcome = self._played.outcome()
        if outcome is not None:
            self._played = None
            self._say(outcome or "back from the session", alarm=bool(outcome))
            return True
        before, self._doing = self._doing, self._played.doing
        if self._doing and self._doing != before:
            self._say(f"{self._doing} ...")
        return self._doing != before

    def leave(self) -> bool:
        """Take one step out of the editor; return whether there was one."""
        if self._typed is not None:
            self._typed = None
        elif self.focus in ("add", "component", "name"):
            self.focus = "list" if self.focus == "add" else "fields" if self.focus == "component" else "picture"
            self._typed = None
        elif self._search:
            self._search = ""
        elif self.focus != "picture":
            self.focus = "picture"
        elif self._selection.chosen is not None:
            self._select("")
        elif self.open:
            self.open = False
            self._page.hide()
        else:
            return False
        return True

    def close(self) -> None:
        """End a session that still runs."""
        if self._played is not None:
            self._played.end()

    def undo(self) -> None:
        """Undo the last edit."""
        what = self.edited.undo()
        self._say(f"undone: {what}" if what else "nothing to undo")

    def save(self) -> None:
        """Write the edits to their files."""
        try:
            files = self.edited.texts.save()
        except MimicsError as error:
            self._say(_short(error.issues[0]), alarm=True)
            return
        self._written = self._written or bool(files)
        self._note_saved(files)
        self._say(f"saved {', '.join(file.name for file in files)}" if files else "nothing was changed")

    def _note_saved(self, files: Sequence[Path]) -> None:
        """Note files that were written, by their names in this folder where they are inside it."""
        here = Path.cwd()
        named = [file.relative_to(here) if file.is_relative_to(here) else file for file in files]
        self.saved += [file for file in named if file not in self.saved]

    def take_files(self) -> None:
        """Take files that were changed on the disk; where one has unsaved edits as well, the person decides.

        Raises:
            SceneError: One cannot be read; the present texts stay.
        """
        texts = self.edited.texts
        both = [file.name for file in texts.changed_on_disk() if file in texts.unsaved]
        if both:
            self._say(f"{', '.join(both)} was changed on the disk: Ctrl + R takes it and drops your edits", alarm=True)
            return
        own, self._written = self._written and not texts.changed_on_disk(), False
        self.edited.read_again()
        self.edited.apply()
        if self.edited.faults and not own:
            raise SceneError(self.edited.faults)
        if not own:
            self._say("loaded again")

    def moved(self, name: str) -> None:
        """Note that an entity was dragged to another place."""
        node = self._viewport.shown.world.find(name)
        x, y, z = node.position.tolist()
        self.edited.move(name, (x, y, z))

    def draw(self) -> None:
        """Draw the faults at their objects, and the panels where they are open."""
        self._draw_badges()
        if self.open:
            self._page.draw(self._state())

    # --- keys and pointer ------------------------------------------------------------------------------------------

    def _press(self, event: InputEvent) -> bool:
        name = "+".join([*(each for each in ("ctrl", "shift") if each in self._held), event.name])
        if self.focus == "name":
            self._press_in_name(event.name)
        elif name in self._commands:
            if not event.repeat or name in ("ctrl+z", "ctrl+y"):
                self._end_typing()
                self._commands[name]()
        elif _OF_THE_WINDOW.fullmatch(event.name):
            return False
        elif event.name == "tab":
            self._next_panel(-1 if "shift" in self._held else 1)
        elif event.name == "escape":
            return self.leave()
        elif self.focus == "picture":
            if event.name != "delete" or not self._name:
                return False
            self._delete()
        elif self.focus == "fields":
            self._press_in_fields(event.name)
        else:
            self._press_in_list(event.name)
        return True

    def _press_in_list(self, key: str) -> None:
        rows = self._listed()
        steps = {"up": -1, "down": 1, "page_up": -15, "page_down": 15, "home": -len(rows), "end": len(rows)}
        if key in steps and rows:
            self._choose_row(min(max(self._at + steps[key], 0), len(rows) - 1), rows)
        elif key == "backspace":
            self._search = self._search[:-1]
        elif key in ("enter", "kp_enter", "right"):
            self._take(rows)
        elif key == "delete" and self.focus == "list":
            self._delete()

    def _press_in_fields(self, key: str) -> None:
        rows = self._rows()
        if not rows:
            return
        row = rows[min(self._row, len(rows) - 1)]
        if self._typed is not None:
            self._press_typing(row, key)
        elif key in ("up", "down", "home", "end"):
            step = {"up": -1, "down": 1, "home": -len(rows), "end": len(rows)}[key]
            self._row = min(max(self._row + step, 0), len(rows) - 1)
            self._cell = min(self._cell, max(len(rows[self._row].cells) - 1, 0))
        elif key in ("left", "right"):
            self._sideways(row, 1 if key == "right" else -1)
        elif key in _STEPS and row.cells:
            self._set(row, self._cell_of(row).stepped(_STEPS[key]), merge=True)
        elif key in ("enter", "kp_enter"):
            self._enter(row)
        elif key == "delete" and self.place is not None and row.steps not in (("id",), ("transform",), _ADD.steps):
            self.edited.remove(self.place, row.steps)

    def _press_typing(self, row: Row, key: str) -> None:
        if key == "backspace":
            self._typed = (self._typed or "")[:-1]
        elif key in ("enter", "kp_enter", "down", "up") and self._commit(row) and key in ("down", "up"):
            self._press_in_fields(key)

    def _press_in_name(self, key: str) -> None:
        if key == "escape":
            self.leave()
        elif key == "backspace":
            self._typed = (self._typed or "")[:-1]
        elif key in ("enter", "kp_enter"):
            self._save_as()

    def _type(self, character: str) -> bool:
        if self.focus == "picture":
            return False
        if self.focus == "name":
            self._typed = (self._typed or "") + character
        elif self.focus == "fields":
            rows = self._rows()
            row = rows[min(self._row, len(rows) - 1)] if rows else None
            if row is not None and row.cells and self._cell_of(row).kind not in ("choice", "switch", "variant"):
                self._typed = (self._typed or "") + character
        elif character.strip():
            self._search, self._at = self._search + character, 0
        return True

    def _click(self, event: InputEvent) -> bool:
        if not event.pressed:
            inside, self._pressed = self._pressed, False
            return inside
        hit = self._page.hit(self._pointer) if self.open else None
        if hit is None:
            self._end_typing()
            self.focus = "picture"
            return False
        self._pressed = True
        if event.name == "left":
            self._hit(hit)
        return True

    def _hit(self, hit: Hit) -> None:
        if hit.kind == "button":
            self._end_typing()
            self._press_button(hit.name)
        elif hit.kind == "lines":
            self._next_fault()
        elif hit.kind == "entity":
            self._end_typing()
            if self.focus not in ("add", "component"):
                self.focus = "list"
            rows = self._listed()
            self._choose_row(hit.number, rows)
            if self.focus != "list":
                self._take(rows)
        elif hit.kind == "row":
            again = (self.focus, self._row, self._cell) == ("fields", hit.number, hit.cell)
            if again and self._typed is not None:
                return
            self._end_typing()
            self.focus, self._row, self._cell = "fields", hit.number, hit.cell
            row = self._row_at(hit)
            if row is not None and (again or not row.cells):
                self._enter(row)
        elif hit.kind in ("list", "fields"):
            self._end_typing()
            self.focus = hit.kind

    def _press_button(self, name: str) -> None:
        keys = {
            "add": "insert",
            "duplicate": "ctrl+d",
            "undo": "ctrl+z",
            "redo": "ctrl+y",
            "play": "f9",
            "save": "ctrl+s",
        }
        if name == "delete":
            self._delete()
        else:
            self._commands[keys[name]]()

    def _turn_wheel(self, event: InputEvent) -> bool:
        hit = self._page.hit(self._pointer) if self.open else None
        if hit is None:
            return False
        step = 1 if event.y > 0 else -1
        if hit.kind == "row" and self.focus == "fields" and (hit.number, hit.cell) == (self._row, self._cell):
            row = self._row_at(hit)
            if row is not None and row.cells and self._typed is None:
                self._set(row, self._cell_of(row).stepped(step), merge=True)
        elif hit.kind in ("entity", "list") and self._listed():
            self._at = min(max(self._at - 3 * step, 0), len(self._listed()) - 1)
        elif hit.kind in ("row", "fields") and self._rows():
            self._row = min(max(self._row - 3 * step, 0), len(self._rows()) - 1)
            self._cell = 0
        return True

    # --- what the keys do ------------------------------------------------------------------------------------------

    def _next_panel(self, step: int) -> None:
        """Open the panels, or take the keys to the next one."""
        self._end_typing()
        if not self.open:
            self.open, self.focus = True, "list"
            return
        places = ("list", "fields", "picture")
        at = places.index(self.focus) if self.focus in places else -1
        self.focus = places[(at + step) % 3]

    def _choose_row(self, number: int, rows: list[ListRow]) -> None:
        self._at = number
        if self.focus == "list" and number < len(rows):
            self._select(rows[number].value)

    def _take(self, rows: list[ListRow]) -> None:
        """Choose the row of the left panel: what is to be added, or the entity whose values are changed."""
        if not rows:
            return
        value = rows[min(self._at, len(rows) - 1)].value
        if self.focus == "list":
            self._select(value)
            self._search, self.focus = "", "fields"
        elif self.focus == "add":
            self._add(next(each for each in self._templates() if each.label == value))
        elif self.place is not None:
            added = source_of(default_of("components", value))
            self.edited.put(self.place, ("components", value), added)
            self._unfolded.add(("components", value))
            self._search, self.focus = "", "fields"
            self._row = next((n for n, row in enumerate(self._rows()) if row.steps == ("components", value)), self._row)

    def _choose_from(self, what: str) -> None:
        self._end_typing()
        self.open, self.focus, self._search, self._at = True, what, "", 0

    def _select(self, name: str) -> None:
        """Select an entity in the list and in the picture."""
        if name != self._name:
            self._end_typing()
            self._name, self._row, self._cell = name, 0, 0
        world = self._viewport.shown.world
        self._selection.chosen = world.find(name) if name and name in world else None
        self._find_row()

    def _find_row(self) -> None:
        """Go to the selected entity in the list, whose rows may have changed."""
        if self.focus not in ("add", "component"):
            self._at = next((n for n, row in enumerate(self._listed()) if row.value == self._name), self._at)

    def _sideways(self, row: Row, step: int) -> None:
        """Go to another cell, or change the only one."""
        if len(row.cells) > 1:
            self._cell = min(max(self._cell + step, 0), len(row.cells) - 1)
        elif row.cells:
            self._set(row, row.cells[0].stepped(step), merge=True)
        elif step > 0 or row.steps in self._unfolded:
            self._enter(row)

    def _row_at(self, hit: Hit) -> Row | None:
        """Return the row under the pointer; None for one that has gone since it was drawn."""
        return next(iter(self._rows()[hit.number :]), None)

    def _cell_of(self, row: Row) -> Cell:
        """Return the cell of a row in focus; the row before may have had more of them."""
        return row.cells[min(self._cell, len(row.cells) - 1)]

    def _enter(self, row: Row) -> None:
        """Begin to type a value, change what has choices, or unfold a heading."""
        if row == _ADD:
            self._choose_from("component")
        elif not row.cells:
            self._unfolded ^= {row.steps}
        else:
            cell = self._cell_of(row)
            if cell.kind in ("choice", "switch", "variant"):
                self._set(row, cell.stepped(1))
            else:
                self._typed = cell.shown

    def _end_typing(self) -> None:
        """Take what was typed, as a person expects who goes elsewhere."""
        rows = self._rows() if self._typed is not None and self.focus == "fields" else []
        if rows:
            self._commit(rows[min(self._row, len(rows) - 1)])
        self._typed = None

    def _commit(self, row: Row) -> bool:
        """Take what was typed; return whether it could be taken."""
        typed, self._typed = self._typed or "", None
        if self._set(row, typed):
            return True
        self._typed = typed
        return False

    def _set(self, row: Row, typed: str, *, merge: bool = False) -> bool:
        cell, place = self._cell_of(row), self.place
        if place is None or typed == cell.shown:
            return True
        try:
            if typed == "" and cell.kind != "json":
                self.edited.remove(place, row.steps)
            else:
                self.edited.set(place, cell, typed, merge=merge)
        except (ValueError, KeyError) as error:
            self._say(f'{row.label}: "{typed}" {error.args[0]}', alarm=True)
            return False
        if row.steps == ("id",):
            self._name = typed
        return True

    def _add(self, template: Template) -> None:
        target = [round(float(value), 3) + 0.0 for value in self._viewport.orbit.target]
        entity = {"id": template.entity["id"], "transform": {"translation": target}, **template.entity}
        self._show_new(self.edited.add(entity))

    def _duplicate(self) -> None:
        place = self.place
        if place is None:
            self._say("select what to duplicate")
            return
        offset = float(f"{_SHARE * self._viewport.orbit.distance:.1g}")
        self._show_new(self.edited.duplicate(place, (offset, 0.0, 0.0)))

    def _show_new(self, name: str) -> None:
        self.focus, self._search = "list" if self.focus == "add" else self.focus, ""
        self.edited.apply()
        self._select(name)
        self._say(f"added {name}")

    def _delete(self) -> None:
        place, name = self.place, self._name
        if place is None:
            self._say("select what to delete")
            return
        count = self.edited.delete(place)
        self._select("")
        self._say(
            f"deleted {name}"
            + (f" and {count - 1} that moved with it" if count > 1 else "")
            + "; Ctrl + Z brings it back"
        )

    def _redo(self) -> None:
        what = self.edited.undo(again=True)
        self._say(f"done again: {what}" if what else "nothing to do again")

    def _read_again(self) -> None:
        """Take what somebody else has saved, without the edits here."""
        try:
            self.edited.read_again()
        except MimicsError as error:
            self._say(_short(error.issues[0]), alarm=True)
        else:
            self._say("read again from the disk")

    def _ask_name(self) -> None:
        self._end_typing()
        path = self.edited.texts.files[0]
        self.focus, self._typed = "name", f"{path.stem}_2.json"

    def _save_as(self) -> None:
        typed = (self._typed or "").strip()
        path = self._viewport.shown.path.parent / typed
        try:
            self.edited.save_as(path if path.suffix == ".json" else path.with_name(f"{path.name}.json"))
        except MimicsError as error:
            self._say(_short(error.issues[0]), alarm=True)
            return
        self._written = True
        self._note_saved(self.edited.texts.files[:1])
        self._typed, self.focus = None, "picture"
        self._say(f"saved as {self.saved[-1]}; it is edited from now on")

    def _play(self) -> None:
        """Play the scene as it is now; the editor stays as it is meanwhile."""
        if self._played is not None:
            self._say("it is being played; end that session first")
        elif self.edited.faults:
            self._next_fault()
        else:
            try:
                self._played = PlayedScene(self.edited)
            except MimicsError as error:
                self._say(_short(error.issues[0]), alarm=True)
            else:
                self._say("starting it in a window of its own")

    def _next_fault(self) -> None:
        """Select the entity of the next fault, and its row."""
        faults = [(place, issue) for issue in self.edited.faults if (place := self.edited.place_of(issue)) is not None]
        if not faults:
            self._say(
                _short(self.edited.faults[0]) if self.edited.faults else "no faults", alarm=bool(self.edited.faults)
            )
            return
        names = [str(self.edited.plain(place).get("id", "")) for place, _ in faults]
        at = (names.index(self._name) + 1) % len(names) if self._name in names else 0
        self.open, self.focus, self._search = True, "fields", ""
        self._select(names[at])
        self._row = min(self._faults_of_rows(self._rows()), default=0)

    # --- what the page shows ---------------------------------------------------------------------------------------

    def _templates(self) -> list[Template]:
        width = float(f"{_SHARE * self._viewport.orbit.distance:.1g}")
        return templates_of(self.edited.scene, self.edited.prefabs(self.edited.texts.files[0]), width)

    def _listed(self) -> list[ListRow]:
        """Return the rows of the left panel, those that were searched for."""
        if self.focus == "add":
            rows = [ListRow(each.label, each.label) for each in self._templates()]
        elif self.focus == "component":
            there = {} if self.place is None else object_of(self.edited.plain(self.place).get("components"))
            rows = [ListRow(name, name) for name in component_names() if name not in there]
        else:
            main = self.edited.texts.files[0]
            rows = [
                ListRow(
                    row.id,
                    row.id,
                    row.depth,
                    "" if row.place.file == main else row.place.file.stem,
                    bool(self.edited.faults and self.edited.faults_of(row.place)),
                )
                for row in self.edited.entities
            ]
        return [row for row in rows if self._search.lower() in row.label.lower()]

    def _rows(self) -> list[Row]:
        """Return the rows of the inspector: what the file has, and under unfolded headings all else."""
        return [row for row, _ in self._folded() if row.depth >= 0]

    def _folded(self) -> list[tuple[Row, int]]:
        """Return the rows with the number of rows that are hidden below each."""
        place = self.place
        if place is None:
            return []
        found: list[tuple[Row, int]] = []
        faulty = [pointer for pointer, _ in self.edited.faults_of(place)] if self.edited.faults else []
        head = 0
        for row in self.edited.rows(place):
            if row.depth == 0 and not row.cells:
                head = len(found)
            elif row.steps == ("prefab",) and not row.own:
                continue
            elif row.depth > 0 and row.steps[0] == "components" and not self._is_shown(row, faulty):
                found[head] = found[head][0], found[head][1] + 1
                continue
            found.append((row, 0))
        return [*found, (_ADD, 0)]

    def _is_shown(self, row: Row, faulty: list[str]) -> bool:
        return row.own or row.steps[:2] in self._unfolded or any(_is_at(row, pointer) for pointer in faulty)

    def _faults_of_rows(self, rows: list[Row]) -> dict[int, Issue]:
        """Return the faults of the present entity by the row that shows them, the innermost one."""
        place, found = self.place, dict[int, Issue]()
        for pointer, issue in [] if place is None else self.edited.faults_of(place):
            inside = [n for n, row in enumerate(rows) if row != _ADD and _is_at(row, pointer)]
            found[max(inside, key=lambda n: len(rows[n].steps), default=0)] = issue
        return found

    def _state(self) -> EditorState:
        listed, folded, texts = self._listed(), self._folded(), self.edited.texts
        rows = [row for row, _ in folded]
        self._at, self._row = min(self._at, max(len(listed) - 1, 0)), min(self._row, max(len(rows) - 1, 0))
        faults = self._faults_of_rows(rows)
        choosing = {"add": "Add an entity", "component": "Add a component"}.get(self.focus, "")
        unsaved = ", ".join(file.name for file in texts.unsaved)
        return EditorState(
            title=choosing or self._viewport.shown.title,
            subtitle="Enter adds it, Esc leaves; type to find"
            if choosing
            else f"not saved: {unsaved}"
            if unsaved
            else texts.files[0].name,
            listed=listed,
            at=self._at if choosing or self._name or self.focus == "list" else -1,
            search=self._search,
            heading=self._name,
            rows=rows,
            row=self._row,
            cell=min(self._cell, max(len(rows[self._row].cells) - 1, 0)) if rows else 0,
            hidden={n: count for n, (_, count) in enumerate(folded)},
            faults=faults,
            typed=self._typed if self.focus == "fields" else None,
            focus="list" if choosing else self.focus,
            lit=self._lit(),
            lines=self._lines(listed, rows, faults),
        )

    def _lit(self) -> frozenset[str]:
        texts, selected = self.edited.texts, self.place is not None
        there = {
            "add": True,
            "duplicate": selected,
            "delete": selected,
            "undo": bool(texts.steps),
            "redo": texts.can_redo,
            "play": self._played is None and not self.edited.faults,
            "save": bool(texts.unsaved),
        }
        return frozenset(name for name, can in there.items() if can)

    def _lines(self, listed: list[ListRow], rows: list[Row], faults: dict[int, Issue]) -> list[tuple[str, bool]]:
        if self.focus == "name":
            return [(f"Save as: {self._typed}|", False), ("beside the scene; Enter saves, Esc leaves", False)]
        if self.focus == "add" and listed:
            return [(next(each.help for each in self._templates() if each.label == listed[self._at].label), False)]
        if self.focus == "fields" and rows:
            row, fault = rows[self._row], faults.get(self._row)
            cell = self._cell_of(row) if row.cells else None
            limits = "" if cell is None or not cell.limits else f"{cell.limits}{f' {row.unit}' if row.unit else ''}"
            words = [(". ".join(part for part in (row.help, limits) if part), False)]
            return [(_short(fault), True)] if fault is not None else [each for each in words if each[0]]
        found = self.edited.faults
        more = [(f"and {len(found) - 1} more; F8 goes to the next", True)] if len(found) > 1 else []
        return [(_short(found[0]), True), *more] if found else []

    def _draw_badges(self) -> None:
        """Draw each fault at its object, as far as the picture shows it."""
        world, hud = self._viewport.shown.world, self._viewport.renderer.hud
        drawn: set[str] = set()
        for issue in self.edited.faults:
            place = self.edited.place_of(issue)
            name = "" if place is None else str(self.edited.plain(place).get("id", ""))
            if not name or name in drawn or name not in world:
                continue
            drawn.add(name)
            seen = self._viewport.orbit.view(self._viewport.surface.size).clip_from_world
            x, y, _, w = seen @ np.append(world.find(name).world_matrix()[:3, 3], 1.0)
            if w > 0.0:
                place_drawn = 0.5 * (x / w + 1.0) * hud.width, 0.5 * (y / w + 1.0) * hud.height
                self._page.draw_badge(place_drawn, issue.what)


def _short(issue: Issue) -> str:
    """Return a fault in words, with the name of its file."""
    return str(Issue(Path(issue.file).name, issue.pointer, issue.what, issue.fix))


def _is_at(row: Row, pointer: str) -> bool:
    """Whether a fault's pointer below the entity is inside a row's value."""
    return f"{pointer}/".startswith(f"{pointer_of(row.steps)}/")
