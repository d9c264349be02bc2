"""Diagnosis: what the simulation gets wrong, why, the extended model, and what it is worth."""

from __future__ import annotations
