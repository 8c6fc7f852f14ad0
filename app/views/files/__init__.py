"""Design › Files."""

from app.views.files.folder import FilesView

__all__ = ["FilesView"]
