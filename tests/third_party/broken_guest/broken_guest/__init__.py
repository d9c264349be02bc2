"""A plugin whose own tables are out of order: loading it raises, far from its first line."""

from broken_guest.tables import STRENGTH

LIMIT = max(STRENGTH.values())
