"""The entry of the desktop's menu: read back by another reader, started as a desktop would, and removed."""

from __future__ import annotations

import shutil
import subprocess
from configparser import ConfigParser
from pathlib import Path

import pytest

from mimics_app.app import cli
from mimics_app.app.commands.desktop import entry_of


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's folder of data, empty."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return tmp_path / "data"


def read_entry(text: str) -> dict[str, str]:
    parser = ConfigParser(interpolation=None, delimiters=("=",))
    parser.optionxform = str  # type: ignore[assignment, method-assign]
    parser.read_string(text)
    return dict(parser["Desktop Entry"])


def words_of(value: str) -> list[str]:
    """The arguments of Exec, by the two rules of the specification: of a string, then of quoted arguments."""
    text, words = value.replace("\\\\", "\\"), []
    while text:
        assert text[0] == '"'
        word, at = "", 1
        while text[at] != '"':
            at += text[at] == "\\"
            word += text[at]
            at += 1
        words.append(word.replace("%%", "%"))
        text = text[at + 1 :].lstrip()
    return words


def test_an_entry_and_its_icon_are_written_and_removed(data: Path, tmp_path: Path) -> None:
    assert cli.main(["desktop", "--folder", str(tmp_path / "sessions")]) == 0
    entry, icon = data / "applications" / "mimics.desktop", data / "icons/hicolor/256x256/apps/mimics.png"
    assert icon.read_bytes().startswith(b"\x89PNG")
    values = read_entry(entry.read_text(encoding="utf-8"))
    assert (values["Path"], values["Type"]) == (str(tmp_path / "sessions"), "Application")
    assert Path(values["Path"]).is_dir()
    told = subprocess.run([*words_of(values["Exec"]), "--version"], capture_output=True, text=True, check=True)
    assert told.stdout.startswith("mimics ")
    if validator := shutil.which("desktop-file-validate"):
        subprocess.run([validator, entry], check=True)

    assert cli.main(["desktop", "--remove"]) == 0
    assert not entry.exists() and not icon.exists()
    assert cli.main(["desktop", "--remove"]) == 0, "nothing to remove is no fault"


def test_signs_of_a_path_are_kept() -> None:
    program = 'a folder/50% "of" `it` $HOME \\ end'
    values = read_entry(entry_of([program, "-m"], Path("/a b")))
    assert words_of(values["Exec"]) == [program, "-m"]


def test_a_folder_that_cannot_be_written_is_one_error(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data.write_text("a file where the folder would be")
    assert cli.main(["desktop", "--folder", str(tmp_path)]) == 3
    assert "desktop entry cannot be changed" in capsys.readouterr().err
