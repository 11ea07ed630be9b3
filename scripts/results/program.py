"""Runs of slipstick for scripts that make many of them."""

import json
import os
import pathlib
import shlex
import signal
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATIENCE = 10  # seconds that an interrupted run may take to end


class BadInput(Exception):
    pass


def quantity(summary, name):
    """strain_energy and the like, or PAIR.KEY of a contact pair. @throws BadInput when there is none."""
    pair, dot, key = name.rpartition(".")
    results = summary["results"]
    if dot:
        found = [entry for entry in results["contact"] if entry["pair"] == pair]
        if not found:
            raise BadInput(f"quantity {name}: there is no contact pair '{pair}', there are "
                           f"{', '.join(entry['pair'] for entry in results['contact']) or 'none'}")
        results = found[0]
    if not isinstance(results.get(key), (int, float)):
        raise BadInput(f"quantity {name}: unknown; there are " +
                       ", ".join(name for name, value in results.items() if isinstance(value, (int, float))))
    return results[key]


def all_quantities(summary):
    """Every number of the results, by the name that quantity() takes, and forces of supports: support NAME Fx."""
    results = summary["results"]
    numbers = {name: value for name, value in results.items() if isinstance(value, (int, float))}
    for pair in results.get("contact", []):
        numbers.update({f"{pair['pair']}.{key}": value for key, value in pair.items() if isinstance(value, (int, float))})
    for support in results.get("supports", []):
        numbers.update({f"support {support['support']} F{axis}": value for axis, value in zip("xyz", support["force"])})
    return numbers


def flags(settings):
    """The options --set of some "NAME=VALUE" for a shell."""
    return " ".join("--set " + shlex.quote(setting) for setting in settings)


class Program:
    """slipstick on @p ranks, without threads. build/slipstick, or the program that SLIPSTICK names."""

    def __init__(self, case, ranks, time_limit):
        self.case, self.ranks, self.time_limit = case, ranks, time_limit
        self.path = os.environ.get("SLIPSTICK", str(ROOT / "build" / "slipstick"))
        if not os.access(self.path, os.X_OK):
            raise BadInput(f"{self.path} does not exist; build it: scripts/run {case}")
        self.environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

    def run(self, settings):
        """With some "NAME=VALUE". @return exit status ("time limit" if it took too long), summary.json where there is one, what
        the program said on standard error."""
        launcher = [str(ROOT / "scripts" / "mpirun"), "--shared-cores", "-n", str(self.ranks)]
        with tempfile.TemporaryDirectory(prefix="slipstick-study-") as directory:
            command = (launcher if self.ranks > 1 else []) + [self.path, str(self.case), "--quiet", "--output", directory + "/run"]
            for setting in settings:
                command += ["--set", setting]
            with open(directory + "/stderr", "w+") as messages:
                process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=messages,
                                           env=self.environment, start_new_session=True)
                try:
                    status = process.wait(timeout=self.time_limit)
                except subprocess.TimeoutExpired:
                    stop(process)
                    return "time limit", None, ""
                except BaseException:
                    stop(process)
                    raise
                messages.seek(0)
                message = messages.read().strip()
            if status not in (0, 2, 3, 4):
                raise RuntimeError(f"slipstick ended with status {status}: {message}")
            file = pathlib.Path(directory, "run", "summary.json")
            return status, json.loads(file.read_text()) if status != 2 else None, message


def stop(process):
    process.send_signal(signal.SIGTERM)
    try:
        process.wait(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
