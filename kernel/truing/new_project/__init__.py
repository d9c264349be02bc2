"""What ``calc new`` writes: a plugin of one's own, as a project or as a single file, born with its tests."""

from __future__ import annotations

from truing.new_project.files import NewPlugin, project, single_file, write_project, write_single_file
from truing.new_project.names import check_name, check_title, spelled, title_of

__all__ = [
    "NewPlugin", "check_name", "check_title", "project", "single_file", "spelled", "title_of", "write_project",
    "write_single_file",
]  # fmt: skip
