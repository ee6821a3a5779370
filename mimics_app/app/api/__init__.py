"""Python interface: `mimics_app.open` plays a scene, `mimics_app.load` reads a recording."""

__all__: list[str] = []
