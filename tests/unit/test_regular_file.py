"""Only regular files are opened: nothing that a person names can hang a command."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from mimics_app.contracts.system.regular_file import open_regular, read_regular


def test_a_file_is_read_whole_or_to_a_limit(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_bytes(b"0123456789")
    (tmp_path / "link").symlink_to(file)
    assert read_regular(tmp_path / "link") == b"0123456789"
    assert read_regular(file, at_most=4) == b"0123"


def test_a_pipe_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="not a regular file"):
        open_regular(tmp_path / "pipe")


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/tty", "/dev/ptmx"])
def test_a_device_is_refused(device: str) -> None:
    with pytest.raises(OSError):
        open_regular(device)


def test_a_socket_and_a_folder_are_refused(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(tmp_path / "socket"))
        with pytest.raises(OSError):
            open_regular(tmp_path / "socket")
    with pytest.raises(IsADirectoryError):
        open_regular(tmp_path)


def test_no_descriptor_is_left_open_by_a_refusal(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(8):
        with pytest.raises(OSError):
            open_regular(tmp_path / "pipe")
    assert len(os.listdir("/proc/self/fd")) == before
