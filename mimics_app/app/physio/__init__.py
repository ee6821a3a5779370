"""`mimics physio`: body signals without a scene, processed as in a session, with plots, tables and their quality."""

__all__: list[str] = []
