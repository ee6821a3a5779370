"""What a frame asks of the interpreter does not grow with what a kernel or the driver can do on its own."""

from __future__ import annotations

from mimics_app.app.bench.frame_counts import count_cards, count_frame, count_nodes
from mimics_app.rendering.visual.kernels.commands import MAX_TRIANGLES


def test_nodes_cost_no_call():
    few, many = count_nodes(100), count_nodes(1500)
    pieces = 18_000 // MAX_TRIANGLES  # in which many are sent, each with a flush of the driver
    assert 0 <= many.calls - few.calls <= 6 * pieces and 100 < few.calls < 1000
    assert many.collections == 0.0 and many.blocks < 50.0, "a frame leaves nothing for the collector"


def test_a_draw_costs_a_few_calls():
    few, many = count_nodes(256, 16), count_nodes(256, 32)
    assert 0.0 < (many.calls - few.calls) / 16 <= 14.0


def test_a_card_costs_calls_where_it_says_something_else():
    unchanged, changed = ([count_cards(n, changing=changing).calls for n in (1, 3)] for changing in (False, True))
    assert (unchanged[1] - unchanged[0]) / 2 < 6.0, "all cards share two draws"
    assert 40.0 < (changed[1] - changed[0]) / 2 < 200.0


def test_what_is_counted_is_what_is_called():
    kept: list[list[int]] = []

    def frame(_: int) -> None:
        for _ in range(5):
            kept.append([len(kept)])  # two calls of C, and two blocks that stay: a list and what is in it

    nothing = count_frame(lambda _: None)
    assert nothing.calls == 1 and nothing.blocks < 1.0
    counts = count_frame(frame)
    assert counts.calls == 11, "its own, and five times two: range() is a type"
    assert counts.blocks >= 10.0
