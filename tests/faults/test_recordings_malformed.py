"""Damaged and hostile run folders: verify, recover and the report never fail, and say the same of each."""

from __future__ import annotations

import json
import os
import signal
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.errors import PartialDataError
from mimics_app.recording import arrow_format
from mimics_app.recording.recover import Recovery, recover
from mimics_app.recording.replay import gather
from mimics_app.recording.report import page_of, write_report
from mimics_app.recording.run import Run
from mimics_app.recording.statics import Statics, read_statics, write_statics
from mimics_app.recording.verdict import Verdict, evaluate
from mimics_app.tasks.kinds.registry import report_sections
from tests.support.full_disk import largest_file
from tests.support.recording_mutations import FILES, SEALED, copy_run, mutate
from tests.support.synthetic_run import write_synthetic_run

QUICK, FULL = 2000, 60_000
"""Mutations in `make test` and in `make test-long`."""
RECOVERED, WITHOUT_MANIFEST, REPORTED = 7, 5, 98
"""Every so manieth of them is recovered, too, was never closed, is reported and recovered twice."""
MOST_KNOWN = 100
"""Blocks whose content is kept: those of the undamaged recording come first."""
PATIENCE_S = 20
"""For one mutation: a reader that waits for a FIFO to be written waits for ever."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    write_statics(folder, Statics({"paths": np.arange(12.0)}, ("spring",)))
    write_synthetic_run(folder, 0.5)
    write_report(folder, report_sections())  # writes the log of the trip, too
    (folder / "report.html").unlink()
    (folder / "manifest.json").unlink()
    recover(folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    summary = {"recipe": "fifo", "task": {"completed": 1, "trials": 2, "score": 66.2, "path_error_m": 0.0081},
               "governor": {"moves": 2, "frame_ms": {"p50": 4.0}, "shares": {"full": 0.9}}}  # fmt: skip
    (folder / "manifest.json").write_text(json.dumps({**manifest, "status": "clean", "lost": [], "summary": summary}))
    assert evaluate(Run.open(folder)).whole
    return folder


@pytest.fixture(scope="module", autouse=True)
def _unchanged_blocks_are_decoded_once() -> Iterator[None]:
    """A block is its bytes and the schema they stand in; a mutation leaves nearly all of a recording's as they were."""
    decode = arrow_format.decode_batch
    known: dict[tuple[bytes, bytes], Any] = {}

    def decode_once(data: bytes | memoryview, schema: Any) -> Any:
        block = bytes(data), arrow_format.schema_bytes(schema)
        if block not in known:
            decoded = decode(data, schema)
            if len(known) >= MOST_KNOWN:
                return decoded
            known[block] = decoded
        return known[block]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(arrow_format, "decode_batch", decode_once)
        yield


@contextmanager
def _patience() -> Iterator[None]:
    """A reader that hangs fails, and so does one whose numpy complains to stderr."""

    def give_up(*_: object) -> None:
        raise TimeoutError("a reader hangs")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(PATIENCE_S)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def _fingerprint(folder: Path) -> dict[str, object]:
    files = {name: folder / name for name in SEALED}
    return {
        name: path.read_bytes() if path.is_file() and not path.is_symlink() else None for name, path in files.items()
    }


def _check(whole: Path, folder: Path, seed: int) -> bool:
    """All that must hold of one mutation; whether it was noticed."""
    copy_run(whole, folder)
    if seed % WITHOUT_MANIFEST == 0:
        (folder / "manifest.json").unlink()
    done = mutate(folder, seed)
    changed = _fingerprint(folder) != _fingerprint(whole)
    try:
        with _patience():
            verdict = _judged(folder, report=seed % REPORTED == 0)
            if seed % RECOVERED == 0:
                _recovered(folder, again=seed % REPORTED == 0)
    except Exception as error:
        raise AssertionError(done) from error
    assert verdict.problems or not changed, f"{done}: nobody noticed"
    return not verdict.whole


def _judged(folder: Path, *, report: bool) -> Verdict:
    verdict = evaluate(Run.open(folder))
    if report:
        assert tuple(page_of(Run.open(folder), report_sections()).problems) == verdict.problems
        write_report(folder, report_sections())
    return verdict


def _recovered(folder: Path, *, again: bool) -> None:
    losses = Run.open(folder).losses()
    verdict = recover(folder).verdict
    assert set(losses) <= set(verdict.problems), "recover forgot a loss"
    assert evaluate(Run.open(folder)) == verdict, "verify and recover say the same"
    if again:
        assert recover(folder) == Recovery((), verdict), "nothing is left to repair"


@pytest.mark.parametrize("part", range(4))
def test_mutated_recordings(whole: Path, tmp_path: Path, part: int) -> None:
    seeds = range(part * QUICK // 4, (part + 1) * QUICK // 4)
    noticed = sum(_check(whole, tmp_path / "run", seed) for seed in seeds)
    assert noticed > 0.7 * len(seeds), "most mutations are damage: the walk reaches what it tests"


@pytest.mark.slow
@pytest.mark.parametrize("part", range(20))
def test_many_mutated_recordings(whole: Path, tmp_path: Path, part: int) -> None:
    for seed in range(QUICK + part * FULL // 20, QUICK + (part + 1) * FULL // 20):
        _check(whole, tmp_path / "run", seed)


# what was found by hand


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("command", ["info", "verify", "recover", "report"])
def test_no_command_waits_for_a_fifo(
    whole: Path, tmp_path: Path, name: str, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = copy_run(whole, tmp_path / "run")
    (folder / name).unlink()
    os.mkfifo(folder / name)
    with _patience():
        code = main(["report", str(folder)] if command == "report" else ["record", command, str(folder)])
    printed = capsys.readouterr()
    assert "Traceback" not in printed.err and "internal error" not in printed.err + printed.out
    if name in SEALED and not name.endswith(".idx"):
        assert code == 6 and name in printed.out + printed.err
    assert code in (0, 6)


@pytest.mark.parametrize("name", FILES)
def test_a_replay_waits_for_no_fifo(whole: Path, tmp_path: Path, name: str) -> None:
    folder = copy_run(whole, tmp_path / "run")
    (folder / name).unlink()
    os.mkfifo(folder / name)
    needed = name in ("haptic.arrows", "parameters.arrows", "haptic_statics.npz")
    with _patience(), pytest.raises(PartialDataError) if needed else nullcontext():
        gather(Run.open(folder))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (b'"tick"', b'"tich"', "1 lines cannot be read"),
        (b'"kind":"state"', b'"kind":"stane"', "1 lines cannot be read"),
        (b'"tick":0', b'"tick":"x"', "1 lines cannot be read"),
    ],
)
def test_one_damaged_event_costs_its_line(whole: Path, tmp_path: Path, old: bytes, new: bytes, said: str) -> None:
    folder = copy_run(whole, tmp_path / "run")
    path = folder / "events.jsonl"
    path.write_bytes(path.read_bytes().replace(old, new, 1))
    run = Run.open(folder)
    assert any(said in problem for problem in run.problems())
    assert len(run.lines) == len(Run.open(whole).lines) - 1
    recovery = recover(folder)
    assert any(said in problem for problem in recovery.verdict.problems)
    assert (folder / "events.jsonl.damaged").exists()


def test_byte_that_is_not_utf8_in_the_manifest(whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = copy_run(whole, tmp_path / "run")
    path = folder / "manifest.json"
    path.write_bytes(path.read_bytes().replace(b"fifo", b"fi\xfeo"))
    assert main(["record", "recover", str(folder)]) == 6
    assert "what the application said at the end of the run cannot be read" in capsys.readouterr().out
    assert len(Run.open(folder).haptic) == 500


def test_recover_says_what_a_full_disk_took(whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A run that was closed and lost its last rows to the disk has nothing to repair, and is not whole."""
    folder = copy_run(whole, tmp_path / "run")
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["dropped"], manifest["problem"] = {"samples": 2483}, "the disk is full"
    (folder / "manifest.json").write_text(json.dumps(manifest))
    codes, printed = [], []
    for arguments in (["record", "verify"], ["record", "recover"], ["report"]):
        codes.append(main([*arguments, str(folder)]))
        output = capsys.readouterr()
        printed.append(output.out + output.err)
    assert codes == [6, 6, 6]
    assert all("the last 2483 ticks are missing: the disk is full" in text for text in printed)
    assert not (folder / "haptic.arrows.damaged").exists()


def test_repair_that_does_not_fit_leaves_no_part_of_it(whole: Path, tmp_path: Path) -> None:
    folder = copy_run(whole, tmp_path / "run")
    (folder / "manifest.json").unlink()
    before = (folder / "haptic.arrows").read_bytes()
    with largest_file(len(before) // 2):
        found = recover(folder)
    assert any("haptic.arrows cannot be repaired" in problem for problem in found.verdict.problems)
    assert not list(folder.glob("*.part"))
    assert (folder / "haptic.arrows").read_bytes() == before
    assert "manifest.json" in found.repaired


def test_rows_cut_off_a_closed_run_are_counted_and_stay_counted(whole: Path, tmp_path: Path) -> None:
    """A cut between two blocks leaves no damaged byte: the manifest knows how many rows there were."""
    folder = copy_run(whole, tmp_path / "run")
    _seq, offset, _length = np.fromfile(folder / "haptic.arrows.idx", np.int64).reshape(-1, 3)[7].tolist()
    os.truncate(folder / "haptic.arrows", offset)
    with (folder / "trials.csv").open("a") as file:
        file.write("torn")
    assert "the last 150 ticks are missing" in evaluate(Run.open(folder)).problems
    assert "the last 150 ticks are missing" in recover(folder).verdict.problems


def test_cut_end_of_an_open_run_is_counted_in_ticks_and_seconds(whole: Path, tmp_path: Path) -> None:
    """The events say how far it went; what is wrong with the bytes is said in words, not in those of a library."""
    folder = copy_run(whole, tmp_path / "run")
    (folder / "manifest.json").unlink()
    _seq, offset, length = np.fromfile(folder / "haptic.arrows.idx", np.int64).reshape(-1, 3)[4].tolist()
    os.truncate(folder / "haptic.arrows", offset + length // 2)
    with (folder / "events.jsonl").open("a") as file:
        file.write('{"source":"app","kind":"frame","frame":30,"tick":1499}\n')
    losses = recover(folder).verdict.problems
    assert "at least 1300 ticks (1.300 s) after tick 199 are missing" in losses
    assert (
        f"haptic.arrows: {length // 2} bytes at {offset} are not a valid block: it is cut off or overwritten" in losses
    )
    assert len(losses) == 3, "the third: the run is recovered"
    assert evaluate(Run.open(folder)).problems == losses


def _lines(capsys: pytest.CaptureFixture[str], *arguments: str) -> list[list[str]]:
    assert main(["record", *arguments]) == 6
    return [line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines()]


def test_what_cannot_be_recovered_is_reported_alike(
    whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = copy_run(whole, tmp_path / "run")
    session = json.loads((folder / "session.json").read_text())
    (folder / "session.json").write_text(json.dumps({**session, "clock": 5}))
    verified = _lines(capsys, "verify", str(folder))
    recovered = _lines(capsys, "recover", str(folder))
    assert recovered[0] == verified[0] == ["damaged", f"{folder}: 2 findings"]
    assert recovered[1] == ["repaired", "nothing: lost or damaged data cannot be recovered and stays as it is"]
    assert recovered[2:] == verified[1:] and len(recovered[2:]) == 2


def test_recovered_run_is_not_damaged_until_it_is_again(
    whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its losses are known; one bit of the events leaves the other files as they are."""
    folder = copy_run(whole, tmp_path / "run")
    path, haptic = folder / "events.jsonl", (folder / "haptic.arrows").stat()
    path.write_bytes(path.read_bytes().replace(b'"tick"', b'"tich"', 1))
    recovered = _lines(capsys, "recover", str(folder))
    assert recovered[1] == ["repaired", "events.jsonl, manifest.json"]
    assert (folder / "haptic.arrows").stat().st_mtime_ns == haptic.st_mtime_ns
    losses = len(recovered) - 2
    verified = _lines(capsys, "verify", str(folder))
    assert (
        verified[0]
        == recovered[0]
        == ["recovered", f"{folder}: {losses} losses; the rest is unchanged since the run was closed"]
    )
    assert verified[1:] == recovered[2:] and all(name == "problem" for name, _ in verified[1:])
    with (folder / "trials.csv").open("a") as file:
        file.write("x")
    assert _lines(capsys, "verify", str(folder))[0][0] == "damaged"


def test_pipe_in_the_place_of_a_file_is_not_missing_too(whole: Path, tmp_path: Path) -> None:
    folder = copy_run(whole, tmp_path / "run")
    for name in ("haptic.arrows", "haptic.arrows.idx"):
        (folder / name).unlink()
        os.mkfifo(folder / name)
    with _patience():
        problems = evaluate(Run.open(folder)).problems
    for name in ("haptic.arrows", "haptic.arrows.idx"):
        assert [problem for problem in problems if problem.startswith(f"{name} ")] == [
            f"{name} cannot be read: not a regular file (a pipe, a socket or a device)"
        ]


def test_nothing_outside_the_folder_is_written(whole: Path, tmp_path: Path) -> None:
    """A run folder from elsewhere whose files are links: they are replaced, never followed for writing."""
    folder = copy_run(whole, tmp_path / "run")
    target = tmp_path / "precious.txt"
    for name in ("events.jsonl", "trials.csv", "haptic.arrows", "parameters.arrows"):
        target.write_bytes(b"precious\nand not ended by a line")
        (folder / name).unlink()
        (folder / name).symlink_to(target)
        recover(folder)
        assert target.read_bytes() == b"precious\nand not ended by a line", name


def test_folder_that_cannot_be_written_is_judged_all_the_same(whole: Path, tmp_path: Path, monkeypatch) -> None:
    folder = copy_run(whole, tmp_path / "run")
    os.truncate(folder / "haptic.arrows", 120_000)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    for module in ("recover", "manifest"):
        monkeypatch.setattr(f"mimics_app.recording.{module}.write_atomically", full)
    monkeypatch.setattr("mimics_app.recording.append_file.os.write", full)
    recovery = recover(folder)
    assert "haptic.arrows cannot be repaired: No space left on device" in recovery.verdict.problems


@pytest.mark.parametrize("seed", range(60))
def test_damaged_statics_end_in_one_error(whole: Path, tmp_path: Path, seed: int) -> None:
    content = bytearray((whole / "haptic_statics.npz").read_bytes())
    chance = np.random.default_rng(seed)
    for place in chance.integers(0, len(content), 3):
        content[place] ^= 1 << int(chance.integers(8))
    (tmp_path / "haptic_statics.npz").write_bytes(content)
    try:
        read_statics(tmp_path)
    except PartialDataError as error:
        assert "cannot be" in str(error)
