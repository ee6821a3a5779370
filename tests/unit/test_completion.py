"""What a shell may complete, and where faults of files are said to be."""

from __future__ import annotations

import io
import shutil
import subprocess
from pathlib import Path

import pytest

from mimics_app.app import cli
from mimics_app.app.terminal.output import line_and_column
from mimics_app.contracts.errors import Issue


@pytest.mark.parametrize(
    ("typed", "found"),
    [
        (["ru"], ["run"]),
        (["run", "free"], ["free_objects"]),
        (["run", "--prof"], ["--profile"]),
        (["run", "--profile", ""], ["draft", "study", "training"]),
        (["run", "--profile", "draft", "wavy"], ["wavy_tunnel"]),
        (["run", "--headless", "wavy"], ["wavy_tunnel"]),
        (["record", ""], ["export", "info", "recover", "verify"]),
        (["record", "info", "x"], []),
        (["nonsense", "x"], []),
    ],
)
def test_words_are_completed(
    typed: list[str], found: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{word}\n" for word in typed)))
    assert cli.main(["completion", "words"]) == 0
    assert capsys.readouterr().out.split() == found


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_script_is_one_its_shell_can_read(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert "mimics completion words" in script
    program = shutil.which(shell)
    if program is not None:
        subprocess.run([program, "-n"], input=script, text=True, check=True, capture_output=True, timeout=30)


def test_hidden_options_are_not_offered(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("run\n--\n"))
    assert cli.main(["completion", "words"]) == 0
    offered = capsys.readouterr().out.split()
    assert "--participant" in offered and "--journey" not in offered


TEXT = '{\n  "a": {"b/c": [1,\n    {"d": 2}]},\n  "e": 3\n}'


@pytest.mark.parametrize(
    ("pointer", "place"),
    [("/e", (4, 8)), ("/a/b~1c/1/d", (3, 11)), ("/a/b~1c/0", (2, 17)), ("/a/gone/x", (2, 8)), ("", None)],
)
def test_place_of_a_value_or_of_the_nearest_one_around_it(
    pointer: str, place: tuple[int, int] | None, tmp_path: Path
) -> None:
    file = tmp_path / "scene.json"
    file.write_text(TEXT)
    assert line_and_column(Issue(str(file), pointer, "is wrong")) == place


def test_what_is_no_text_of_json_has_no_place(tmp_path: Path) -> None:
    for name, content in (("model.glb", b"glTF\x02"), ("cut.json", b'{"a": ')):
        (tmp_path / name).write_bytes(content)
        assert line_and_column(Issue(str(tmp_path / name), "/a", "is wrong")) is None
    assert line_and_column(Issue(str(tmp_path / "gone.json"), "/a", "is wrong")) is None
