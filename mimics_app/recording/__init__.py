"""Recording of sessions: recorder process, run folder, reader, recovery, replay data, report."""

__all__: list[str] = []
