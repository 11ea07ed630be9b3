"""Shared by scripts/render, report, gallery and sweep: reading the folder of a run, and drawing it."""
