"""What a run leaves behind: where its numbers come from, its documents, its folder, and how two of them differ."""
