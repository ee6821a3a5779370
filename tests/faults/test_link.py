"""The link of a device: the supervisor leaves a descriptor alone that the loop is taking at the same moment."""

from __future__ import annotations

import numpy as np

from mimics_app.rendering.haptic.devices.link import LINK_LENGTH, LinkSupervisor, drop_link, link_words, take_link


class Racing:
    """Words of a link that the loop takes right after the supervisor has read one of them."""

    def __init__(self, words: np.ndarray) -> None:
        self._words = words

    def __getitem__(self, place: int) -> int:
        value = int(self._words[place])
        take_link(self._words)
        return value

    def __setitem__(self, place: int, value: int) -> None:
        self._words[place] = value


def test_a_failure_of_the_system_is_reported_and_tried_again():
    fails = [False, True, False]

    def open_line():
        if fails.pop(0):
            raise OSError("out of descriptors")
        return 7, lambda: None

    memory = np.zeros(LINK_LENGTH)
    supervisor = LinkSupervisor(memory, open_line, "a device")
    supervisor._ended.set()
    supervisor._thread.join()
    words = link_words(memory)
    take_link(words)
    drop_link(words)
    supervisor.poll()
    assert "is gone: no force" in supervisor.trouble() and "out of descriptors" in supervisor.trouble()
    supervisor.poll()
    assert supervisor.trouble() == "" and take_link(words) == (7, True)


def test_a_descriptor_taken_while_the_supervisor_looks_stays_open():
    opened: list[int] = []
    closed: list[int] = []

    def open_line():
        opened.append(7)
        return 7, lambda: closed.append(7)

    memory = np.zeros(LINK_LENGTH)
    supervisor = LinkSupervisor(memory, open_line, "a device")
    supervisor._ended.set()
    supervisor._thread.join()
    words = link_words(memory)
    supervisor._words = Racing(words)  # type: ignore[assignment]
    supervisor.poll()
    assert take_link(words) == (7, False)
    assert (opened, closed) == ([7], [])
