"""What operating system and installation give: files, processes, this machine."""

__all__: list[str] = []
