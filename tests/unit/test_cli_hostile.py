"""The command line under hostile conditions: closed and full streams, signals at bad moments, values beyond reason."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app import cli
from tests.support.gltf_maker import INDICES, POSITIONS, GltfMaker, write_gltf

COMMAND = [sys.executable, "-m", "mimics_app.app.cli"]
STAND_IN = (
    "import os, signal, sys, time, types; from mimics_app.app import cli; from mimics_app.app.terminal import output\n"
    "{body}\n"
    "cli._command_module = lambda name: types.SimpleNamespace(add_arguments=lambda p: None, run=run)\n"
    "sys.exit(cli.main(sys.argv[1:]))\n"
)
ANSWER = "def run(args):\n    output.write_object('run', {'text': 'x' * 100000}); return 0"
WAIT = (  # in short sleeps: a signal that comes just before a sleep does not end it
    "def run(args):\n"
    "    try:\n"
    "        print('up', flush=True)\n"
    "        for _ in range(1200): time.sleep(0.05)\n"
    "    finally: print('closed', flush=True)"
)


def shell(line: str, body: str = ANSWER) -> subprocess.CompletedProcess[str]:
    """Run a shell line in which $RUN is a stand-in for `mimics`."""
    environment = {**os.environ, "PY": sys.executable, "SCRIPT": STAND_IN.format(body=body)}
    line = line.replace("$RUN", '"$PY" -c "$SCRIPT" run')
    return subprocess.run(
        ["bash", "-c", line], env=environment, capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-", ">&- 2>&-"])
@pytest.mark.parametrize("option", ["", "--json"])
def test_closed_streams_are_no_error(closed: str, option: str) -> None:
    done = shell(f"$RUN {option} {closed}")
    assert done.returncode == 0, done.stderr
    assert not done.stderr


def test_file_opened_after_a_closed_stderr_is_not_written_to(tmp_path: Path) -> None:
    """Without a descriptor 2 the next file opened would take its place, and messages of libraries would land in it."""
    path = tmp_path / "data"
    body = f"def run(args):\n    f = open({str(path)!r}, 'wb'); os.write(2, b'AL lib: trouble'); return 0"
    assert shell("$RUN 2>&-", body).returncode == 0
    assert path.read_bytes() == b""


def test_reader_of_json_that_leaves_is_no_error() -> None:
    done = shell("$RUN --json | true; exit ${PIPESTATUS[0]}")
    assert (done.returncode, done.stderr) == (141, "")


def test_reader_of_a_json_error_that_leaves_is_no_error() -> None:
    body = (
        "from mimics_app.contracts.errors import UsageError\ndef run(args):\n    time.sleep(0.3); raise UsageError('x')"
    )
    done = shell("$RUN --json | true; exit ${PIPESTATUS[0]}", body)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("option", ["", "--json"])
def test_stdout_on_a_full_disk_is_one_line(option: str) -> None:
    body = ANSWER if option else "def run(args):\n    print('x' * 100000); return 0"
    done = shell(f"$RUN {option} >/dev/full", body)
    assert done.returncode == 3
    cure = "free some space, or name a file or folder on another disk"
    assert done.stderr.splitlines() == [f"mimics: No space left on device; {cure}"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_picture_that_fills_the_disk_is_named(tmp_path: Path) -> None:
    from mimics_app.rendering.visual.surfaces.headless import write_png

    (tmp_path / "frame.png").symlink_to("/dev/full")
    with pytest.raises(OSError, match="No space left on device") as raised:
        write_png(np.zeros((64, 64, 4), np.uint8), tmp_path / "frame.png")
    assert raised.value.filename == str(tmp_path / "frame.png")
    assert (tmp_path / "frame.png").is_symlink(), "a link to a device is not what was written"


def test_file_trouble_names_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "session.json").write_text("{}")
    (tmp_path / "report.html").mkdir()
    assert cli.main(["report", str(tmp_path)]) == 3
    line = capsys.readouterr().err
    assert "report.html" in line and "Is a directory" in line and "Traceback" not in line
    assert cli.main(["report", str(tmp_path), "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["errors"][0]["what"] == "Is a directory"


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_signal_unwinds_the_stack(number: int, code: int) -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", STAND_IN.format(body=WAIT), "run"],
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),  # the tests themselves may run under nohup
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "up\n"
    child.send_signal(number)
    rest, _ = child.communicate(timeout=30)
    assert (rest, child.returncode) == ("closed\n", code)


IN_A_CALLBACK = (
    "import ctypes\n"
    "@ctypes.CFUNCTYPE(None)\n"
    "def called_by_c(): os.kill(os.getpid(), {signal})\n"
    "class Left:\n"
    "    def __del__(self): os.kill(os.getpid(), {signal})\n"
    "class Half:\n"
    "    def __init__(self): os.kill(os.getpid(), {signal}); self.made = True\n"
    "    def __del__(self): self.made\n"
    "def run(args):\n"
    "    try: {deed}; time.sleep(30)\n"
    "    finally: print('closed', flush=True)"
)


@pytest.mark.parametrize("deed", ["called_by_c()", "Left()", "Half()"])
@pytest.mark.parametrize(
    ("number", "code", "said"),
    [(signal.SIGTERM, 143, "mimics: ended by SIGTERM\n"), (signal.SIGINT, 130, "mimics: interrupted\n")],
)
def test_signal_in_a_callback_of_a_compiler_is_one_line(number: int, code: int, said: str, deed: str) -> None:
    """What a callback of C code or a destructor raises is printed and lost: kernels are compiled with many of both.

    So is the complaint of a destructor whose object the signal left half made.
    """
    done = shell("$RUN", IN_A_CALLBACK.format(signal=int(number), deed=deed))
    assert (done.returncode, done.stdout, done.stderr) == (code, "closed\n", said)


@pytest.mark.parametrize(
    ("number", "code", "what"), [(signal.SIGTERM, 143, "ended by SIGTERM"), (signal.SIGINT, 130, "interrupted")]
)
@pytest.mark.fault(id="F10")
def test_a_command_ended_by_a_signal_leaves_one_object(number: int, code: int, what: str) -> None:
    body = f"def run(args): os.kill(os.getpid(), {int(number)}); time.sleep(30)"
    done = shell("$RUN --json", body)
    assert (done.returncode, done.stderr) == (code, "")
    assert [error["what"] for error in json.loads(done.stdout)["errors"]] == [what]


def test_nohup_is_respected() -> None:
    script = "trap '' HUP; $RUN & sleep 2; kill -HUP $!; sleep 0.2; kill -TERM $!; wait $!"
    done = shell(script, WAIT)
    assert done.returncode == 143


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", "--seed", "9" * 30], "is not a seed"),
        (["run", "--seed", "1.5"], "1.5 is not a seed"),
        (["physio", "sim:healthy", "--seed", "-1"], "-1 is not a seed from 0"),
        (["render", "scene.json", "--seed", str(2**63)], "is not a seed"),
        (["bench", "realtime", "--seconds", "nan"], "nan is not a time"),
        (["bench", "realtime", "--seconds", "-1"], "-1 is not a time"),
        (["bench", "realtime", "--rounds", "0"], "0 is not a number of rounds"),
        (
            ["bench", "physio", "nonsense", "--charts", "."],
            "bench physio has no figure nonsense; it has noise, detectors",
        ),
        (["bench", "physio", "detectors"], "no folder for the figure detectors"),
        (["run", "wavy_tunnel", "--learn", "\x1b]0;title\x07"], '"\\x1b]0;title\\x07"'),
        (["run", "wavy_tunnel", "--runs=--"], "--runs needs a value"),
        (["physio", "sim:healthy", "--page", ""], 'argument --page: "" is a folder; name a file to write'),
        (["render", "wavy_tunnel", "--audio", "."], 'argument --audio: "." is a folder; name a file to write'),
        (["render", "wavy_tunnel", "--audio", "a.mp3"], 'argument --audio: "a.mp3" does not end in .wav'),
        (["view", "a.glb", "--output", "a.exe"], '--output: "a.exe" does not end in .png or .jpg or .jpeg'),
        (["render", "scenes", "--sheet", "all"], '--sheet: "all" does not end in .png or .jpg or .jpeg'),
    ],
)
def test_value_beyond_reason_is_refused(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(arguments) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("line", ["run", "run --headless", "check", "explain", "render", "view --headless", "study"])
def test_a_file_nested_without_end_is_a_fault_of_the_file(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Readers of the standard library raise RecursionError; a study refuses its scene before it runs anybody."""
    monkeypatch.chdir(tmp_path)
    Path("deep.json").write_text("[" * 100_000)
    assert cli.main([*line.split(), "deep.json"]) == 3
    assert capsys.readouterr().err == "mimics: deep.json: is nested deeper than 128 levels\n"
    assert os.listdir() == ["deep.json"]


@pytest.mark.parametrize("name", ["run", "check", "explain"])
def test_empty_name_of_a_scene_is_a_fault_of_the_file(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """It is the working folder's name."""
    assert cli.main([name, ""]) == 3
    assert "is a folder" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["run", "check", "explain", "render", "view"])
def test_what_is_there_but_no_file_is_not_said_to_be_missing(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    os.mkfifo(tmp_path / "f.json")
    (tmp_path / "d.json").mkdir()
    assert cli.main([name, str(tmp_path / "f.json")]) == 3
    assert "f.json: is not a regular file; name a scene file" in capsys.readouterr().err
    assert cli.main([name, str(tmp_path / "d.json")]) == 3
    assert "d.json: is a folder; name a scene file" in capsys.readouterr().err


def test_a_locale_of_128_characters_is_no_error(tmp_path: Path) -> None:
    """Names of files with other letters are found, and written into a pipe."""
    maker = GltfMaker()
    position, indices = maker.array(POSITIONS), maker.array(INDICES)
    maker.more = {"meshes": [{"primitives": [{"attributes": {"POSITION": position}, "indices": indices}]}]}
    document = maker.document()
    (tmp_path / "r\u00e4ume.bin").write_bytes(maker.blob)
    document["buffers"] = [{"byteLength": len(maker.blob), "uri": "r%C3%A4ume.bin"}]
    write_gltf(tmp_path / "m\u00f6bel.gltf", document)
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("LC_", "LANG"))}
    environment |= {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    program = [sys.executable, "-m", "mimics_app", "check", os.fsencode("m\u00f6bel.gltf")]
    done = subprocess.run(program, env=environment, cwd=tmp_path, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "m\u00f6bel.gltf: ok".encode() in done.stdout
