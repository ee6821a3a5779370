"""What a session leaves on disk: the recorder process, the run folder, reading it back, recovery, replay data, report."""

__all__: list[str] = []
