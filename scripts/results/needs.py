"""Installs missing packages of a script in the same way as scripts/run, once. Standard library only."""

import os
import pathlib
import subprocess
import sys

FAILED = 10  # status of scripts whose packages are missing
TRIED = "SLIPSTICK_SETUP_WAS_TRIED"


def install(script, error):
    """scripts/setup --render, then this script again. Does not return. Nothing is installed with SLIPSTICK_NO_SETUP=1."""
    print(f"{script}: {error}", file=sys.stderr)
    setup = pathlib.Path(__file__).resolve().parents[1] / "setup"
    if not os.environ.get("SLIPSTICK_NO_SETUP") and TRIED not in os.environ:
        if subprocess.run([str(setup), "--render"], stdout=sys.stderr).returncode == 0:
            os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, TRIED: "1"})
    print(f"{script}: install what it needs: scripts/setup --render", file=sys.stderr)
    sys.exit(FAILED)
