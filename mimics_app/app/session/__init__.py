"""A session: the objects of one run, their construction, one frame, and their replay."""

__all__: list[str] = []
