"""Truing."""
