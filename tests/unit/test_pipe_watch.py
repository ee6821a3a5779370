"""A watched pipe."""

from multiprocessing import Pipe

from mimics_app.contracts.system.pipe_watch import PipeWatch


def test_a_pipe_is_ready_for_a_message_and_for_its_end():
    here, there = Pipe(duplex=False)
    watch = PipeWatch(here)
    assert not watch.ready()
    there.send(1)
    assert watch.ready() and here.recv() == 1
    assert not watch.ready()
    there.close()
    assert watch.ready()
