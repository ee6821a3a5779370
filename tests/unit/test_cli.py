"""The command line: exit codes, one line per error, one object with --json."""

from __future__ import annotations

import io
import json
import shlex
import signal
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mimics_app.app import cli, settings
from mimics_app.app.terminal import output
from mimics_app.app.terminal.command_parser import examples
from mimics_app.app.terminal.first_start import CompileLine, is_cold
from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.errors import (
    DeviceError,
    Issue,
    MimicsError,
    PartialDataError,
    SafetyStop,
    SceneError,
    UsageError,
)
from mimics_app.rendering.haptic import scheduler
from mimics_app.rendering.haptic.devices.device_names import device_names

Body = Callable[[Any], int]


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[[Body], None]:
    """Replace the module behind every command by one whose `run` is given."""

    def install(body: Body) -> None:
        module = types.SimpleNamespace(
            add_arguments=lambda parser: parser.add_argument("--count", type=int, default=1), run=body
        )
        monkeypatch.setattr(cli, "_command_module", lambda name: module)

    return install


def _raise(error: BaseException) -> Body:
    def body(args: Any) -> int:
        raise error

    return body


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (UsageError("no"), 2),
        (SceneError(Issue("a.json", "/x", "wrong")), 3),
        (DeviceError("none"), 4),
        (SafetyStop("latched"), 5),
        (PartialDataError("torn"), 6),
        (MimicsError("other"), 1),
    ],
)
@pytest.mark.parametrize("as_json", [False, True])
def test_exit_code_of_each_error(
    command: Callable[[Body], None], error: MimicsError, code: int, as_json: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    command(_raise(error))
    assert cli.main(["run", "--json"] if as_json else ["run"]) == code
    said = capsys.readouterr()
    assert "Traceback" not in said.err
    assert bool(said.out) == as_json


def test_return_value_is_the_exit_code(command: Callable[[Body], None]) -> None:
    command(lambda args: 6)
    assert cli.main(["run"]) == 6


def test_every_issue_is_one_line_that_names_the_place(
    command: Callable[[Body], None], capsys: pytest.CaptureFixture[str]
) -> None:
    command(_raise(SceneError([Issue("a.json", "/b/0", "bad", "better"), Issue("c.json", "", "worse")])))
    cli.main(["run"])
    assert capsys.readouterr().err.splitlines() == ["mimics: a.json#/b/0: bad; better", "mimics: c.json: worse"]


def test_json_errors_carry_all_issues(command: Callable[[Body], None], capsys: pytest.CaptureFixture[str]) -> None:
    command(_raise(SceneError([Issue("a.json", "/b/0", "bad", "better"), Issue("c.json", "", "worse")])))
    cli.main(["run", "--json"])
    answer = json.loads(capsys.readouterr().out)
    assert list(answer) == ["schema", "command", "errors"]
    assert answer["command"] == "run"
    assert answer["errors"] == [
        {"file": "a.json", "pointer": "/b/0", "what": "bad", "fix": "better"},
        {"file": "c.json", "pointer": "", "what": "worse", "fix": ""},
    ]


def test_unknown_command_names_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["rnu"]) == 2
    assert 'did you mean "run"' in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [["run", "--count", "many"], ["run", "--no-such-option"], ["--no-such-option"]])
def test_wrong_argument_is_one_line(
    command: Callable[[Body], None], arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    command(lambda args: 0)
    assert cli.main(arguments) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert "--help" in said[0]


@pytest.mark.parametrize(
    ("arguments", "what", "hint"),
    [
        (["run", "--headles"], '"--headles"', 'did you mean "--headless"'),
        (["run", "--second=3"], '"--second"', 'did you mean "--seconds"'),
        (["lab", "--point", "12", "stability"], '"--point"', 'did you mean "--points"'),
        (["record", "--qqq", "verify", "RUN"], '"--qqq"', "see mimics record --help"),
        (["--versoin"], '"--versoin"', 'did you mean "--version"'),
    ],
)
def test_an_option_is_not_abbreviated_and_the_nearest_is_named(
    arguments: list[str], what: str, hint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(arguments) == 2
    assert capsys.readouterr().err == f"mimics: there is no option {what}; {hint}\n"


@pytest.mark.parametrize(
    ("line", "given"),
    [
        ("lab stability --points 12 S3", {"action": "stability", "name": ["S3"], "points": 12}),
        ("lab --points 12 stability S3 S4", {"action": "stability", "name": ["S3", "S4"], "points": 12}),
        ("record --json verify RUN", {"action": "verify", "folder": Path("RUN"), "json": True}),
        ("record verify --json RUN", {"action": "verify", "folder": Path("RUN"), "json": True}),
        ("devices check --recording RUN replay", {"action": "check", "device": "replay", "recording": Path("RUN")}),
        ("assets build --seed 3 apple", {"action": "build", "name": "apple", "seed": 3}),
        ("bench render --frames 3 nodes", {"what": "render", "names": ["nodes"], "frames": 3}),
        ("run --headless scenes/a.json --seed 2", {"scene": Path("scenes/a.json"), "headless": True, "seed": 2}),
        ("check -- --odd.json", {"files": [Path("--odd.json")]}),
    ],
)
def test_options_may_stand_anywhere(line: str, given: dict[str, Any]) -> None:
    args = vars(cli.parse(line.split()))
    assert {name: args[name] for name in given} == given
    assert args["command"] == line.split()[0]


def test_help_and_version_are_0(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--help"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in cli.COMMANDS)
    assert cli.main(["--version"]) == 0


@pytest.mark.parametrize("command", sorted(examples()))
def test_examples_of_help_can_be_typed_and_are_shown_whole(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([command, "--help"]) == 0
    shown = capsys.readouterr().out
    for typed, what in examples()[command].items():
        assert any(line.strip().startswith(typed) and line.endswith(what) for line in shown.splitlines()), typed
        words = shlex.split(typed)
        assert words[0] == "mimics" and cli.parse(words[1:]).command == words[1]
        if words[1:3] == ["devices", "check"]:
            assert words[3] in device_names()


def test_ctrl_c_is_130(command: Callable[[Body], None]) -> None:
    command(_raise(KeyboardInterrupt()))
    assert cli.main(["run"]) == 130


def test_ctrl_c_while_the_program_is_imported_is_one_line_and_130() -> None:
    script = (
        "import sys\n"
        "class Interrupted:\n"
        "    def find_spec(self, name, path, target=None):\n"
        "        if name == 'mimics_app.app.cli': raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Interrupted())\n"
        "from mimics_app.__main__ import main\n"
        "sys.exit(main())\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "mimics: interrupted\n")


def test_internal_error_is_traced_and_still_one_object(
    command: Callable[[Body], None], capsys: pytest.CaptureFixture[str]
) -> None:
    command(_raise(ZeroDivisionError("oops")))
    assert cli.main(["run", "--json"]) == 1
    said = capsys.readouterr()
    assert "Traceback" in said.err
    assert "ZeroDivisionError" in json.loads(said.out)["errors"][0]["what"]
    with pytest.raises(ZeroDivisionError):
        cli.main(["run"])


def test_json_leaves_exactly_one_object_on_stdout() -> None:
    """Prints of a library, of C code and of a child process go to stderr."""
    script = (
        "import os, subprocess, sys, types\n"
        "from mimics_app.app import cli\n"
        "from mimics_app.app.terminal import output\n"
        "def run(args):\n"
        "    print('from Python'); sys.stdout.flush(); os.write(1, b'from C\\n')\n"
        "    subprocess.run([sys.executable, '-c', 'print(\"from a child\")'], check=True)\n"
        "    output.write_object('run', {'answer': 42}); print('afterwards'); return 0\n"
        "cli._command_module = lambda name: types.SimpleNamespace(add_arguments=lambda p: None, run=run)\n"
        "sys.exit(cli.main(['run', '--json']))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == {"schema": "mimics.run/1", "command": "run", "answer": 42}
    assert done.stdout.count("\n") == 1
    assert all(text in done.stderr for text in ("from Python", "from C", "from a child", "afterwards"))


def test_stdout_is_given_back_after_json(command: Callable[[Body], None], capsys: pytest.CaptureFixture[str]) -> None:
    command(lambda args: 0)
    before = sys.stdout
    cli.main(["run", "--json"])
    assert sys.stdout is before
    print("still here")
    assert "still here" in capsys.readouterr().out


def test_second_object_is_refused(command: Callable[[Body], None], capsys: pytest.CaptureFixture[str]) -> None:
    def twice(args: Any) -> int:
        output.write_object("run", {})
        output.write_object("run", {})
        return 0

    command(twice)
    assert cli.main(["run", "--json"]) == 1
    said = capsys.readouterr()
    assert len(said.out.splitlines()) == 1
    assert "second JSON object" in said.err


def test_sigterm_unwinds_the_stack_and_is_143() -> None:
    script = (
        "import os, signal, sys, time, types; from mimics_app.app import cli\n"
        "def run(args):\n"
        "    try:\n"
        "        print('up', flush=True); time.sleep(60)\n"
        "    finally:\n"
        "        print('closed', flush=True)\n"
        "cli._command_module = lambda name: types.SimpleNamespace(add_arguments=lambda p: None, run=run)\n"
        "sys.exit(cli.main(['run']))\n"
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None
    assert child.stdout.readline() == "up\n"
    child.send_signal(signal.SIGTERM)
    rest, _ = child.communicate(timeout=30)
    assert rest == "closed\n"
    assert child.returncode == 143


def test_reader_that_leaves_early_is_no_error() -> None:
    """`mimics schema | head -1`: no traceback when the pipe closes."""
    script = (
        "import sys, types; from mimics_app.app import cli\n"
        "def run(args):\n"
        "    for _ in range(100000): print('x' * 100)\n"
        "    return 0\n"
        "cli._command_module = lambda name: types.SimpleNamespace(add_arguments=lambda p: None, run=run)\n"
        "sys.exit(cli.main(['run']))\n"
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert child.stdout is not None
    assert child.stderr is not None
    child.stdout.read(100)
    child.stdout.close()
    assert child.stderr.read() == b""
    assert child.wait(timeout=30) == 141
    child.stderr.close()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", "--seconds", "long"], "long is not a time"),
        (["run", "--seconds", "nan"], "nan is not a time"),
        (["run", "--pictures", "-1"], "-1 is not a number of pictures"),
        (["run", "--recipe", "faster"], "invalid choice: 'faster'"),
        (["render", "scene.json", "--frames", "few"], "few is not a number of frames"),
        (["render", "scene.json", "--seconds", "-2"], "-2 is not a time"),
        (["run", "--seed", "1" * 5000], "1 is not a seed from"),
        (["bench", "render", "--frames", "0"], "0 is not a number of frames from 1 to 1000"),
        (["devices", "emulate", "--seconds", "inf"], "inf is not a time between 0 and 1e6 s"),
        (["devices", "emulate", "--seed", "1e3"], "1e3 is not a seed"),
        (["lab", "chart", "--points", "many"], "many is not a number of points from 2 to 2000"),
    ],
)
def test_value_that_cannot_be_is_named_without_names_of_the_code(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(arguments) == 2
    line = capsys.readouterr().err
    assert said in line
    assert "_" not in line


@pytest.mark.parametrize("name", ["run", "check", "explain", "render"])
def test_scene_that_is_not_there_is_a_fault_of_the_file(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([name, "nowhere/none.json"]) == 3
    said = capsys.readouterr().err
    assert "scene not found; mimics scenes lists those that are shipped" in said


def test_recipes_offered_are_those_the_scheduler_knows() -> None:
    assert settings.RECIPES == scheduler.RECIPES


def test_first_start_is_known_by_a_folder_without_machine_code(tmp_path: Path) -> None:
    assert is_cold(None)
    assert is_cold(tmp_path)
    (tmp_path / "tick.nbi").touch()
    assert is_cold(tmp_path)
    (tmp_path / "kernels").mkdir()
    (tmp_path / "kernels" / "tick.1.nbc").touch()
    assert not is_cold(tmp_path)


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("stream", [io.StringIO(), _Terminal()], ids=["log", "terminal"])
def test_compiling_says_how_far_it_is(stream: io.StringIO) -> None:
    """A function every half a second: nothing for two seconds, then in place, or a line every ten seconds."""
    clock, told = VirtualClock(), list[str]()
    line = CompileLine(stream, clock, told.append)
    for _ in range(400):
        line.count()
        clock.sleep_until_ns(clock.now_ns() + 500_000_000)
    said = stream.getvalue()
    assert "41 functions done, 20 s" in said and "381 functions done, 190 s" in said
    assert said.count("\n") == (0 if stream.isatty() else 19)
    assert said.count("\r") == (396 if stream.isatty() else 0)
    assert len(told) == 198, "the window that waits hears it every second"
    assert told[0] == "Preparing, once for this version; parts done: 5"
