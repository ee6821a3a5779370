"""`.ci/dev.sh` with stand-ins for uv, apt, sudo and id: what it installs, when, and what it says where it may not.

The real thing, on bare machines, is described in docs/decisions; here is what must not rot.
"""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

_UV = """#!/bin/sh
echo "uv $*" >>"$CALLS"
case "$1" in
    --version) exit 0 ;;
    venv) for last; do :; done; mkdir -p "$last/bin"; ln -sf "$REAL_PYTHON" "$last/bin/python" ;;
    pip) [ -z "${KILLED:-}" ] || kill -9 $PPID
         case "$*" in *"-e ."*) for tool in mimics ruff; do
             printf '#!/bin/sh\\necho %s "$@"\\n' $tool >.venv/bin/$tool; chmod +x .venv/bin/$tool; done ;;
         esac ;;
esac
"""
_SYSTEM_PACKAGES = """
import os, sys
lacking = os.environ.get("LACKING", "").split() if not os.path.exists(os.environ["CALLS"] + ".apt") else []
wanted = {"run": "lib", "test": "x", "optional": "opt", "test-optional": "pulse"}
print(" ".join(name for name in lacking for kind in sys.argv[1:] if name.startswith(wanted[kind])))
"""


class Bench:
    """A checkout with the real script and stand-ins for everything it calls."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "a checkout"
        self.tools = folder / "tools"
        self.calls = folder / "calls"
        (self.root / ".ci").mkdir(parents=True)
        installation = self.root / "mimics_app" / "app" / "installation"
        installation.mkdir(parents=True)
        self.tools.mkdir()
        self.calls.touch()
        shutil.copy(ROOT / ".ci" / "dev.sh", self.root / ".ci")
        for name in ("pyproject.toml", "requirements.txt", "requirements-test.txt"):
            shutil.copy(ROOT / name, self.root)
        (installation / "system_packages.py").write_text(_SYSTEM_PACKAGES)
        self.stand_in("uv", _UV)
        self.stand_in("id", '#!/bin/sh\n[ "$1" = -u ] && echo "${FAKE_UID:-1000}" || echo somebody\n')
        self.stand_in("sudo", "#!/bin/sh\nexit 1\n")
        self.stand_in("apt-get", '#!/bin/sh\necho "apt-get $*" >>"$CALLS"; touch "$CALLS.apt"\n')

    def stand_in(self, name: str, text: str) -> None:
        tool = self.tools / name
        tool.write_text(text)
        tool.chmod(tool.stat().st_mode | stat.S_IXUSR)

    def word(self, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
        """Run a word of the script; the calls of its stand-ins are in `self.called` afterwards."""
        self.calls.write_text("")
        (self.calls.parent / "calls.apt").unlink(missing_ok=True)
        settings = {
            "PATH": f"{self.tools}:/usr/bin:/bin",
            "HOME": str(self.tools),
            "CALLS": str(self.calls),
            "PYTHON": sys.executable,
            "REAL_PYTHON": sys.executable,
            **environment,
        }
        command = ["sh", str(self.root / ".ci" / "dev.sh"), *words]
        return subprocess.run(
            command, env=settings, cwd="/", capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL
        )

    @property
    def called(self) -> str:
        return self.calls.read_text()

    @property
    def installed(self) -> bool:
        return "uv pip install" in self.called


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    """A fresh checkout, with a space in its path."""
    yield Bench(tmp_path)


def test_first_run_builds_and_the_second_only_runs(bench: Bench) -> None:
    first = bench.word("run", "--seconds", "1")
    assert first.returncode == 0, first.stderr
    assert first.stdout == "mimics run scenes/wavy_tunnel.json --seconds 1\n"
    assert "--require-hashes" in bench.called
    assert "--no-deps --no-build-isolation -e ." in bench.called
    second = bench.word("run")
    assert second.returncode == 0
    assert second.stderr == ""
    assert not bench.installed


def test_source_package_finds_its_builder_installed_before_it(bench: Bench) -> None:
    bench.word("setup")
    steps = [line for line in bench.called.splitlines() if "-r " in line]
    assert "build-requirements.txt" in steps[0]
    assert steps[1].endswith("-r requirements.txt --require-hashes --no-build-isolation")
    first = (bench.root / ".venv" / "build-requirements.txt").read_text()
    assert first.startswith("setuptools==")
    assert "--hash=sha256:" in first
    assert first.count("==") == 1


def test_changed_requirements_are_installed_into_the_same_environment(bench: Bench) -> None:
    bench.word("setup")
    keep = bench.root / ".venv" / "keep"
    keep.touch()
    with (bench.root / "requirements.txt").open("a") as file:
        file.write("# changed\n")
    assert bench.word("setup").returncode == 0
    assert bench.installed
    assert keep.exists()


def test_running_installs_no_tool_of_the_tests(bench: Bench) -> None:
    """A linter, a type checker and a peer of physics are of no use to who only runs a scene."""
    bench.word("run")
    assert "requirements-test.txt" not in bench.called
    assert bench.word("check").returncode != 69
    assert "-r requirements.txt -r requirements-test.txt" in bench.called
    bench.word("run")
    assert not bench.installed, "what tests need stays where it is"


def test_a_check_ends_with_all_that_is_red(bench: Bench) -> None:
    """Types are checked in the background; neither they nor the tests can be right here."""
    done = bench.word("check")
    assert done.returncode == 1 and done.stderr.endswith("imports tests mypy\n")


def test_changed_pins_of_the_tests_leave_running_alone(bench: Bench) -> None:
    bench.word("check")
    with (bench.root / "requirements-test.txt").open("a") as file:
        file.write("# changed\n")
    bench.word("run")
    assert not bench.installed
    bench.word("check")
    assert bench.installed


def test_moved_folder_is_built_anew(bench: Bench) -> None:
    """Scripts in .venv/bin and the editable install point to the old place."""
    bench.word("setup")
    keep = bench.root / ".venv" / "keep"
    keep.touch()
    moved = bench.root.with_name("moved")
    bench.root.rename(moved)
    bench.root = moved
    assert bench.word("setup").returncode == 0
    assert bench.installed
    assert not (moved / ".venv" / "keep").exists()


def test_broken_interpreter_is_built_anew(bench: Bench) -> None:
    bench.word("setup")
    python = bench.root / ".venv" / "bin" / "python"
    python.unlink()
    python.symlink_to("/nowhere/python3")
    assert bench.word("setup").returncode == 0
    assert bench.installed
    assert python.exists()


def test_interrupted_set_up_is_completed(bench: Bench) -> None:
    """The mark is written last; without it nothing that lies there is believed."""
    assert bench.word("setup", KILLED="1").returncode == -9
    assert not (bench.root / ".venv" / ".mimics-ready").exists()
    assert bench.word("setup").returncode == 0
    assert (bench.root / ".venv" / ".mimics-ready").exists()


def test_environment_made_by_hand_is_replaced(bench: Bench) -> None:
    (bench.root / ".venv" / "bin").mkdir(parents=True)
    (bench.root / ".venv" / "bin" / "python").symlink_to(sys.executable)
    (bench.root / ".venv" / "old").touch()
    assert bench.word("setup").returncode == 0
    assert not (bench.root / ".venv" / "old").exists()


def test_without_rights_one_line_is_said_and_nothing_is_asked(bench: Bench) -> None:
    done = bench.word("run", LACKING="libegl1 libopenal1 xvfb optional1")
    assert done.returncode == 69
    assert done.stdout == ""
    lines = [line for line in done.stderr.splitlines() if "apt-get install" in line]
    assert len(lines) == 1
    assert lines[0].endswith("sudo apt-get install -y libegl1 libopenal1")
    assert "apt-get" not in bench.called
    assert (bench.root / ".venv" / ".mimics-ready").exists(), "the Python part is complete all the same"


def test_tests_ask_for_their_own_tools_too(bench: Bench) -> None:
    done = bench.word("test", LACKING="libegl1 xvfb")
    assert done.returncode == 69
    assert "sudo apt-get install -y libegl1 xvfb" in done.stderr


@pytest.mark.parametrize("has_it", [True, False])
def test_sound_server_of_the_tests_is_asked_for_once_and_by_them_only(bench: Bench, has_it: bool) -> None:
    """Where a package manager would have to remove a desktop's own server for it, tests say that they are skipped."""
    bench.stand_in("apt-get", f'#!/bin/sh\necho "apt-get $*" >>"$CALLS"\nexit {0 if has_it else 100}\n')
    assert bench.word("run", LACKING="pulseaudio", FAKE_UID="0").returncode == 0
    assert "pulseaudio" not in bench.called
    python = bench.root / ".venv" / "bin" / "python"
    python.unlink()  # what runs instead of the tests
    python.write_text(f'#!/bin/sh\n[ "$1" = -m ] && echo "python $*" || exec {sys.executable} "$@"\n')
    python.chmod(0o755)
    first = bench.word("test", LACKING="pulseaudio", FAKE_UID="0")
    assert first.returncode == 0, first.stderr
    assert "--no-remove pulseaudio" in bench.called
    assert ("not to be had here: pulseaudio" in first.stderr) != has_it
    assert "-rfEs" in first.stdout.split(), "what is skipped is said with its reason"
    bench.word("test", LACKING="pulseaudio", FAKE_UID="0")
    assert "apt-get" not in bench.called


def test_going_on_without_system_packages_is_possible(bench: Bench) -> None:
    assert bench.word("run", LACKING="libegl1", MIMICS_SKIP_SYSTEM="1").returncode == 0


def test_root_installs_required_and_optional_packages_apart(bench: Bench) -> None:
    """One unknown name fails a whole apt line; the optional one must not take the required ones with it."""
    bench.stand_in(
        "apt-get",
        '#!/bin/sh\necho "apt-get $*" >>"$CALLS"\n'
        'case "$*" in *opt*) exit 100 ;; *" install "*) touch "$CALLS.apt" ;; esac\n',
    )
    done = bench.word("run", LACKING="libegl1 optmesa", FAKE_UID="0")
    assert done.returncode == 0, done.stderr
    installs = [line for line in bench.called.splitlines() if " install " in line and line.startswith("apt-get")]
    assert any(line.endswith("--no-install-recommends --no-remove libegl1") for line in installs)
    assert all(not ("libegl1" in line and "optmesa" in line) for line in installs)
    bench.word("run", LACKING="optmesa", FAKE_UID="0")
    assert "apt-get" not in bench.called, "what the distribution does not have is requested once"


def test_sudo_without_a_password_is_used(bench: Bench) -> None:
    bench.stand_in("sudo", '#!/bin/sh\n[ "$1" = -n ] || exit 1\nshift\nexec "$@"\n')
    assert bench.word("run", LACKING="libegl1").returncode == 0
    assert "install -y --no-install-recommends --no-remove libegl1" in bench.called


def test_packages_that_apt_does_not_bring_end_in_the_line(bench: Bench) -> None:
    bench.stand_in("apt-get", "#!/bin/sh\nexit 100\n")
    done = bench.word("run", LACKING="libegl1", FAKE_UID="0")
    assert done.returncode == 69
    assert "apt-get install -y libegl1" in done.stderr


def test_settings_of_other_tools_stay_outside(bench: Bench) -> None:
    """ROS sets PYTHONPATH for every shell; its pytest plug-ins break ours. Byte code is what a start saves time by."""
    reported = 'echo "uv PYTHONPATH=${PYTHONPATH:-unset} bare=${PYTHONDONTWRITEBYTECODE:-unset} $*"'
    bench.stand_in("uv", _UV.replace('echo "uv $*"', reported))
    bench.word("setup", PYTHONPATH="/elsewhere/ros", PYTHONHOME="/elsewhere", PYTHONDONTWRITEBYTECODE="1")
    assert "PYTHONPATH=unset bare=unset" in bench.called
    assert "/elsewhere" not in bench.called


def test_two_set_ups_at_once_are_one_after_the_other(bench: Bench) -> None:
    bench.stand_in("uv", _UV.replace("pip)", 'pip) echo begin >>"$CALLS"; sleep 0.2; echo end >>"$CALLS";'))
    environment = {
        **os.environ,
        "PATH": f"{bench.tools}:/usr/bin:/bin",
        "CALLS": str(bench.calls),
        "PYTHON": sys.executable,
        "REAL_PYTHON": sys.executable,
    }
    command = ["sh", str(bench.root / ".ci" / "dev.sh"), "setup"]
    both = [subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    said = [child.communicate(timeout=60)[1] for child in both]
    assert [child.returncode for child in both] == [0, 0], said
    turns = [line for line in bench.called.splitlines() if line in {"begin", "end"}]
    assert turns == ["begin", "end"] * 3, "the second found everything done"
    assert any("waiting" in text for text in said)


def test_read_only_checkout_says_whose_it_is(bench: Bench) -> None:
    if os.geteuid() == 0:
        pytest.skip("root may write everywhere")
    bench.root.chmod(0o555)
    try:
        done = bench.word("setup")
    finally:
        bench.root.chmod(0o755)
    assert done.returncode == 73
    assert "not writable" in done.stderr


def test_clean_keeps_recordings(bench: Bench) -> None:
    bench.word("setup")
    recording = bench.root / "runs" / "one" / "haptic.arrows"
    recording.parent.mkdir(parents=True)
    recording.touch()
    assert bench.word("clean").returncode == 0
    assert recording.exists()
    assert not (bench.root / ".venv").exists()


def test_unknown_word_lists_the_words(bench: Bench) -> None:
    done = bench.word("rnu")
    assert done.returncode == 2
    assert "test-long" in done.stderr
    assert not bench.called


needs_make = pytest.mark.skipif(
    shutil.which("make") is None, reason="make is not installed; sh .ci/dev.sh works without"
)


@needs_make
def test_makefile_has_every_word() -> None:
    words = "setup run test test-long nightly check bench docs fresh clean pins".split()
    text = (ROOT / "Makefile").read_text()
    assert all(word in text for word in words)
    for word in words:
        done = subprocess.run(
            ["make", "--no-print-directory", "-n", word, "ARGS=--seed 7"],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stdout.strip() == f"sh .ci/dev.sh {word} --seed 7"


@needs_make
@pytest.mark.parametrize(
    ("verdict", "code", "fresh", "passes"),
    [
        ("===== 3 passed in 1.20s =====", 0, 0, True),
        ("===== 3 passed in 1.20s =====", 0, 69, True),
        ("===== 3 passed in 1.20s =====", 0, 1, False),
        ("== 1 failed, 2 passed in 61.20s (0:01:01) ==", 1, 0, False),
    ],
)
def test_automatic_check_ends_with_the_verdict_of_pytest(
    tmp_path: Path, verdict: str, code: int, fresh: int, passes: bool
) -> None:
    """make says "Error 1" below a failure; the last line is pytest's. A fresh system may fail alone."""
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "run", tmp_path / ".ci")
    shutil.copy(ROOT / "Makefile", tmp_path)
    script = (
        f'case $1 in test) echo "{verdict}"; exit {code} ;; fresh) echo "on a fresh system"; exit {fresh} ;; esac\n'
    )
    (tmp_path / ".ci" / "dev.sh").write_text(script)
    done = subprocess.run([tmp_path / ".ci" / "run"], capture_output=True, text=True, check=False)
    assert (done.returncode == 0) == passes
    assert done.stdout.splitlines()[-1] == verdict
    assert ("make fresh: not run" in done.stdout) == (fresh == 69)
