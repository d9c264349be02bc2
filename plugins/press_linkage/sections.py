"""The sheet, in the order an engineer reads it."""

from truing import Section

SECTIONS: list[Section] = []
