"""Heads in SOFA files that lie: about their size, about where their data are, or by damage. None costs much."""

from __future__ import annotations

import os
import random
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.read_budget import READ_BUDGET
from mimics_app.rendering.audio.spectral.head import HeadResponses, delays_between_ears
from mimics_app.rendering.audio.spectral.sofa import read_sofa
from tests.support.heads import some_head, write_sofa

HEAD = some_head(44_100, 40)
COUNT = len(HEAD.directions)
CHEAP = 8 << 20
"""Memory within which a file is refused whose shapes are wrong [bytes]."""


def refusal(path: Path, at_most: int = CHEAP) -> str:
    """What is said of a file that is refused, with no more memory than allowed."""
    tracemalloc.start()
    try:
        with pytest.raises(SceneError) as caught:
            read_sofa(path)
        assert tracemalloc.get_traced_memory()[1] < at_most
    finally:
        tracemalloc.stop()
    (issue,) = caught.value.issues
    assert issue.file == str(path) and issue.fix
    return issue.what


def replaced(path: Path, name: str, make: Callable[[h5py.File], object]) -> Path:
    """A head in which one variable is made anew."""
    write_sofa(path, HEAD)
    with h5py.File(path, "a") as file:
        del file[name]
        make(file)
    return path


def claimed(name: str, shape: tuple[int, ...]) -> Callable[[h5py.File], object]:
    """A variable of which only the shape is in the file."""
    chunks = tuple(min(n, 64) for n in shape) if all(shape) else None
    return lambda file: file.create_dataset(name, shape, "f8", chunks=chunks)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("Data.IR", (100_000, 2, 16_384)),
        ("Data.IR", (5_000, 2, 16_384)),
        ("Data.IR", (10**9, 2, 16)),
        ("SourcePosition", (10**9, 3)),
        ("Data.SamplingRate", (10**9,)),
        ("Data.SamplingRate", (10**6,)),
        ("Data.SamplingRate", (0,)),
        ("Data.Delay", (10**9, 2)),
        ("Data.Delay", (5, 2)),
        ("Data.Delay", (1, 3)),
        ("Data.Delay", ()),
    ],
)
def test_a_shape_that_is_wrong_or_too_large_is_refused_before_anything_is_read(
    tmp_path: Path, name: str, shape: tuple[int, ...]
) -> None:
    path = write_sofa(tmp_path / "head.sofa", HEAD, Data_Delay=np.zeros((1, 2)))
    with h5py.File(path, "a") as file:
        del file[name]
        if shape:
            claimed(name, shape)(file)
        else:
            file[name] = 0.0
    assert name in refusal(path) or "responses for" in refusal(path)


@pytest.mark.parametrize("name", ["Data.IR", "SourcePosition", "Data.SamplingRate", "Data.Delay"])
@pytest.mark.parametrize("kind", ["link", "soft", "raw", "virtual"])
def test_nothing_outside_the_file_is_read(tmp_path: Path, name: str, kind: str) -> None:
    """What lies there is a pipe, so that a reader which follows hangs."""
    outside = tmp_path / "outside"
    os.mkfifo(outside)
    shapes = {"Data.IR": HEAD.responses.shape, "SourcePosition": (COUNT, 3), "Data.Delay": (1, 2)}
    shape = shapes.get(name, (1,))

    def make(file: h5py.File) -> None:
        if kind == "link":
            file[name] = h5py.ExternalLink(str(outside), "/x")
        elif kind == "soft":
            file[name] = h5py.SoftLink("/elsewhere")
            file["elsewhere"] = np.zeros(shape)
        elif kind == "raw":
            file.create_dataset(name, shape, "f8", external=[(str(outside), 0, h5py.h5f.UNLIMITED)])
        else:
            layout = h5py.VirtualLayout(shape, "f8")
            layout[:] = h5py.VirtualSource(str(outside), "x", shape)
            file.create_virtual_dataset(name, layout)

    path = write_sofa(tmp_path / "head.sofa", HEAD, Data_Delay=np.zeros((1, 2)))
    with h5py.File(path, "a") as file:
        del file[name]
        make(file)
    assert "in another file" in refusal(path) or "is a link" in refusal(path)


def test_a_pipe_is_no_head(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "head.sofa")
    assert "not a regular file" in refusal(tmp_path / "head.sofa")


@pytest.mark.parametrize("values", [HEAD.responses * 1j, HEAD.responses.astype("S8"), None])
def test_only_real_numbers_are_responses(tmp_path: Path, values: np.ndarray | None) -> None:
    def make(file: h5py.File) -> None:
        if values is None:
            file.create_group("Data.IR")
        else:
            file["Data.IR"] = values

    assert "no real numbers" in refusal(replaced(tmp_path / "head.sofa", "Data.IR", make))


def test_what_unpacks_to_more_than_it_says_is_refused(tmp_path: Path) -> None:
    """One chunk of a few hundred kilobytes that holds 80 MB of zeros, where 40 kB are announced."""
    import zlib

    shape = (COUNT, 2, 128)
    packer = zlib.compressobj(1)
    packed = b"".join(packer.compress(bytes(1 << 24)) for _ in range(5)) + packer.flush()

    def make(file: h5py.File) -> None:
        variable = file.create_dataset("Data.IR", shape, "f8", chunks=shape, compression="gzip")
        variable.id.write_direct_chunk((0, 0, 0), packed)

    path = replaced(tmp_path / "head.sofa", "Data.IR", make)
    assert "unpacks to more" in refusal(path)


def test_an_attribute_that_is_a_book_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "head.sofa"
    with h5py.File(path, "w", libver="latest") as file:
        file.attrs.create("SOFAConventions", np.bytes_("x"), dtype="S200000")
    assert "is not a word" in refusal(path)


def test_heads_compressed_as_laboratories_do_are_read(tmp_path: Path) -> None:
    def make(file: h5py.File) -> None:
        file.create_dataset("Data.IR", data=HEAD.responses, compression="gzip", shuffle=True, fletcher32=True)

    found = read_sofa(replaced(tmp_path / "head.sofa", "Data.IR", make))
    np.testing.assert_array_equal(found.responses, HEAD.responses)


def test_flipped_bits_are_refused_or_read_and_nothing_else(tmp_path: Path) -> None:
    chance, path = random.Random(32), tmp_path / "head.sofa"
    whole = write_sofa(path, HEAD).read_bytes()
    refused = 0
    for number in range(250):
        data = bytearray(whole)
        for _ in range(chance.choice((1, 1, 2, 5))):
            at = chance.randrange(8000)  # where the tables are
            data[at] ^= 1 << chance.randrange(8)
        path.write_bytes(data if number % 8 else data[: chance.randrange(len(data))])
        try:
            read_sofa(path)
        except SceneError:
            refused += 1
    assert 40 < refused < 240


def apart(head: HeadResponses) -> tuple[np.ndarray, np.ndarray]:
    """Responses that all begin at one sample, and the delays that were taken out of them [samples], [n, 2]."""
    chance = np.random.default_rng(32)
    delays = np.stack((20.0 + 13.3 * head.directions[:, 0], 20.0 - 13.3 * head.directions[:, 0]), axis=1)
    taps = np.arange(128)
    place = 12.0 + 0.0 * delays
    shape = chance.uniform(0.8, 1.2, delays.shape)
    return shape[..., None] * np.sinc(taps - place[..., None]) * np.hanning(128), delays


@pytest.mark.parametrize("common", [0.0, 200.0])
def test_delays_of_the_ears_that_stand_apart_are_heard(tmp_path: Path, common: float) -> None:
    """The delay between the ears is the one stated, to a microsecond; what is common to all directions is not added."""
    responses, delays = apart(HEAD)
    path = write_sofa(tmp_path / "head.sofa", HEAD, Data_IR=responses, Data_Delay=delays + common)
    found = read_sofa(path)
    between = delays_between_ears(found.responses, found.rate)
    np.testing.assert_allclose(between, (delays[:, 0] - delays[:, 1]) / 44_100.0, atol=1e-6)
    assert found.responses.shape[2] < 128 + 40
    level = read_sofa(write_sofa(tmp_path / "level.sofa", HEAD, Data_Delay=np.array([[3.0, 3.0]])))
    np.testing.assert_array_equal(level.responses, HEAD.responses)


@pytest.mark.parametrize(
    ("changes", "reported"),
    [
        ({"Data_Delay": np.array([[0.0, 5000.0]])}, "over 20 ms"),
        ({"Data_Delay": np.array([[0.0, np.nan]])}, "none that are numbers"),
        ({"Data_SamplingRate": np.where(np.arange(COUNT) == 7, 48_000.0, 44_100.0)}, "several sampling rates"),
        ({"SourcePosition": np.array([[0.0, 0.0, 1.0 + n % 2] for n in range(COUNT)])}, "distances from 1 to 2 m"),
    ],
)
def test_what_is_not_one_head_is_refused(tmp_path: Path, changes: dict[str, np.ndarray], reported: str) -> None:
    assert reported in refusal(write_sofa(tmp_path / "head.sofa", HEAD, **changes))


def test_one_rate_stated_for_each_direction_is_one(tmp_path: Path) -> None:
    path = write_sofa(tmp_path / "head.sofa", HEAD, Data_SamplingRate=np.full(COUNT, 44_100.0))
    assert read_sofa(path).rate == 44_100.0


def test_the_largest_head_that_is_read_stays_within_twice_the_budget(tmp_path: Path) -> None:
    """All zeros, so that it is refused at last, after everything was read."""
    path = write_sofa(tmp_path / "head.sofa", HEAD, Data_IR=None, SourcePosition=None)
    count = READ_BUDGET // (8 * 2 * 8192)
    with h5py.File(path, "a") as file:
        claimed("Data.IR", (count, 2, 8192))(file)
        file["SourcePosition"] = np.ones((count, 3))
    assert "silent" in refusal(path, 2 * READ_BUDGET)
