"""Servo-press linkage."""
