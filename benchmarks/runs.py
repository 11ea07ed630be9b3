"""What the benchmarks share: builds slipstick, runs a scene under mpirun, times it from outside, reads its summary."""

import csv
import datetime
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BOX = ROOT / "prm" / "box_on_circle.prm"


class RunFailed(Exception):
    """A run that left no summary; its message is the end of what it wrote."""


def say(text):
    print(text, file=sys.stderr, flush=True)


def shell(command, **options):
    """Standard output of a bash command that has the functions of scripts/common.sh."""
    script = f'source "{ROOT}/scripts/common.sh" && {command}'
    return subprocess.run(["bash", "-c", script, "benchmarks"], check=True, text=True, stdout=subprocess.PIPE, **options).stdout


def n_cores():
    return int(shell("n_cores"))


def build(target="slipstick"):
    """Path of the program, built first where that is needed (status 10 when it cannot be, as in scripts/run)."""
    try:
        shell(f"setup && build_target {target}")
    except subprocess.CalledProcessError as error:
        sys.exit(error.returncode)
    found = [file for file in (ROOT / "build").rglob(target) if file.is_file() and os.access(file, os.X_OK)]
    if not found:
        sys.exit(f"{target} was built but is not below {ROOT / 'build'}")
    return found[0]


def mpirun(ranks):
    """The launcher, that of scripts/run, and an environment in which programs may start alone, too."""
    return [str(ROOT / "scripts" / "mpirun"), "-n", str(ranks)], dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")


def run(program, settings, ranks, scene=BOX, look=None):
    """summary.json of one run, with "wall_s" from outside and "exit" added; raises RunFailed when there is none.

    look(directory of the outputs) is called before they are deleted, its result is "seen".
    """
    launcher, environment = mpirun(ranks)
    output = pathlib.Path(tempfile.mkdtemp(prefix="slipstick-"))
    try:
        command = [*launcher, str(program), str(scene), "--quiet", "--output", str(output / "out")]
        for name, value in settings.items():
            command += ["--set", f"{name}={value}"]
        start = time.monotonic()
        done = subprocess.run(command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        wall = time.monotonic() - start
        try:
            summary = json.loads((output / "out" / "summary.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            raise RunFailed(f"status {done.returncode}: {done.stdout.strip()[-500:]}") from None
        summary["wall_s"] = wall
        summary["exit"] = done.returncode
        if look:
            summary["seen"] = look(output / "out")
        return summary
    finally:
        shutil.rmtree(output, ignore_errors=True)


def median_run(program, settings, ranks, repetitions):
    """Of several runs the one with the median wall time; all wall times in "wall_all_s"."""
    all_runs = sorted((run(program, settings, ranks) for _ in range(repetitions)), key=lambda one: one["wall_s"])
    middle = all_runs[len(all_runs) // 2]
    middle["wall_all_s"] = [one["wall_s"] for one in all_runs]
    return middle


def box(n, slip_bound, **more):
    """Settings of a cell of the tables; keywords: center, tolerance, vtu."""
    settings = {"Decomposition/Blocks": n, "Contact circle/Slip bound": slip_bound}
    if "center" in more:
        settings["Obstacle disc/Center"] = more["center"]
    if "tolerance" in more:
        settings["Solver/Tolerance"] = more["tolerance"]
    if "vtu" in more:
        settings["Output/VTU"] = "true" if more["vtu"] else "false"
    return settings


def conditions(ranks=None):
    """One line on where and when: commit, cores, ranks, load of the machine; goes above every table."""
    commit = subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"], text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.DEVNULL, check=False).stdout.strip()
    load = ", ".join(f"{value:.1f}" for value in os.getloadavg())
    return (f"{datetime.datetime.now():%Y-%m-%d %H:%M}, commit {commit or '-'}, {os.cpu_count()} cores"
            + (f", {ranks} rank(s)" if ranks else "") + f", load at the start {load} (1, 5, 15 min)")


class Figures:
    """What is asked for, and by how much it is met or missed; prints each as a line of a Markdown list."""

    def __init__(self):
        self.missed, self.records = 0, []

    def at_most(self, what, value, limit, unit=""):
        return self._judge(what, value, limit, value <= limit, f"at most {limit:g}{unit}", unit)

    def at_least(self, what, value, limit, unit=""):
        return self._judge(what, value, limit, value >= limit, f"at least {limit:g}{unit}", unit)

    def true(self, what, is_met, text):
        """A claim without a number."""
        self.missed += not is_met
        self.records.append({"what": what, "value": text, "limit": "", "met": int(is_met)})
        print(f"- {what}: {text}: {'met' if is_met else 'MISSED'}", flush=True)
        return is_met

    def _judge(self, what, value, limit, is_met, asked, unit):
        self.missed += not is_met
        self.records.append({"what": what, "value": value, "limit": limit, "met": int(is_met)})
        how = "met by" if is_met else "MISSED by"
        print(f"- {what}: {value:.4g}{unit}, asked {asked}: {how} {abs(value - limit):.3g}{unit} "
              f"({100 * abs(value - limit) / limit:.0f} %)", flush=True)
        return is_met

    def end(self):
        """Exit status, and a last line."""
        if not self.records:
            return 0
        print(f"\n{self.missed} of {len(self.records)} figures missed" if self.missed else
              f"\nall {len(self.records)} figures met", flush=True)
        return 1 if self.missed else 0


def write_csv(file_name, rows):
    """Dictionaries as lines; columns in the order in which they first occur."""
    columns = list(dict.fromkeys(name for row in rows for name in row))
    with open(file_name, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def markdown(head, rows):
    """A Markdown table with padded columns."""
    cells = [[str(cell) for cell in row] for row in (head, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |" for row in cells]
    lines.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(lines)
