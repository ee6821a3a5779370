"""What a session leaves on disk: recorder process, run folder, reading it back, recovery, replay data, report."""

__all__: list[str] = []
