"""Questions asked of a model; one file each, all on the same error sources."""
