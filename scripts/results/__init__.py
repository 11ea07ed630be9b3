"""What scripts/render, report, gallery and sweep share: reading the folder of a run, and drawing it."""
