"""The gait orthosis: linkage, drive, treadmill, the person in it, and the machine of both legs."""

__all__: list[str] = []
