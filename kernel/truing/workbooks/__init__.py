"""Workbooks (.xlsx): read as data and written with real numbers; nothing inside of one ever runs."""
