"""Runs scenes in variants, one process each, and tells what they cost and how far equal problems differ."""

import argparse
import concurrent.futures
import csv
import fnmatch
import json
import math
import os
import pathlib
import subprocess
import tempfile
import threading
import time

import runs
from scene_files import Variant

STATUS_TIMEOUT = "timeout"


class Case:
    """A scene in a variant: family, scene name, function that makes it, wanted exit status."""

    def __init__(self, family, scene, variant, make, status=0):
        self.family, self.scene, self.variant, self.make = family, scene, variant, make
        self.status = status

    @property
    def name(self):
        return f"{self.family}/{self.scene}/{self.variant.name}"


def parser(description):
    made = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--only", metavar="PATTERN", action="append", help="part of a name, or pattern with *; repeatable")
    made.add_argument("--program", metavar="FILE", help="slipstick to run, default: build it")
    made.add_argument("--tolerance", default="1e-8",
                      help='of the solver, or "default": that of the program (default: %(default)s)')
    made.add_argument("--against", metavar="EPS",
                      help="solves each with this tolerance, too, and tells how far tractions differ in L2")
    made.add_argument("--quick", action="store_true", help="one or two variants of each family, 20 s each at most")
    made.add_argument("--timeout", type=float, help="seconds a run (default: 120, with --quick 20)")
    made.add_argument("--jobs", type=int, default=1, help="runs at the same time (default: %(default)s)")
    made.add_argument("--csv", metavar="FILE", help="one line a variant")
    made.add_argument("--folder", metavar="DIR", type=pathlib.Path, help="where scenes, meshes and outputs are kept")
    made.add_argument("--write-only", action="store_true", help="write the scenes, run nothing")
    made.add_argument("--list", action="store_true", help="names of the variants, nothing else")
    made.add_argument("--set", dest="more", metavar="NAME=VALUE", action="append", default=[], help="passed on to every run")
    return made


def chosen(cases, given):
    """Those that --only names."""
    if not given.only:
        return cases
    return [case for case in cases if any(part in case.name or fnmatch.fnmatch(case.name, part) for part in given.only)]


def read_contact(file_name, turn):
    """Nodes of all steps: {(pair, step): [(s, pressure, tangential traction, place)]}, by arc length; empty without the file.

    The place is that before the turn, rounded, the same for all variants of a mesh.
    """
    found, c, s = {}, math.cos(math.radians(turn)), math.sin(math.radians(turn))
    try:
        with open(file_name, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                x, y = float(row["x"]), float(row["y"])
                place = (round(c * x + s * y, 6), round(c * y - s * x, 6))
                values = (float(row[name]) for name in ("s", "pressure", "tangential_traction"))
                found.setdefault((row["pair"], int(row["step"])), []).append((*values, place))
    except OSError:
        pass
    return {key: sorted(nodes) for key, nodes in found.items()}


def run(case, program, given, folder):
    """A dictionary of what the run gave; with --against that of the other tolerance is compared."""
    directory = folder / case.family / case.scene
    scene = case.make(case.variant).write(directory)
    if given.write_only:
        return None
    result = run_once(case, scene, program, given, given.tolerance, directory / f"out-{case.variant.name}")
    if given.against:
        other = run_once(case, scene, program, given, given.against, directory / f"against-{case.variant.name}")
        result.update({"against_status": other["status"], "against_multiplications": other.get("multiplications")})
        if result["status"] == other["status"] == 0:
            result["pressure_off"], result["tangential_off"] = off(result["contact"], other["contact"])
    return result


def run_once(case, scene, program, given, tolerance, output):
    command = [str(program), str(scene), "--quiet", "--output", str(output)]
    if tolerance != "default":
        command += ["--set", f"Solver/Tolerance={tolerance}"]
    for setting in given.more:
        command += ["--set", setting]
    launcher, environment = runs.mpirun(case.variant.ranks)
    if case.variant.ranks > 1:
        command = [*launcher, "--oversubscribe", *command]
    for name in ("summary.json", "contact.csv"):  # of an earlier run
        (output / name).unlink(missing_ok=True)
    start, message = time.monotonic(), ""
    try:
        done = subprocess.run(command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=given.timeout, check=False)
        status, message = done.returncode, done.stdout.strip()
    except subprocess.TimeoutExpired:
        status = STATUS_TIMEOUT
    result = {"name": case.name, "status": status, "wanted": case.status, "seconds": round(time.monotonic() - start, 2),
              "message": " ".join(message.split())[-300:]}
    try:
        summary = json.loads((output / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return result
    return {**result, **figures(summary), "contact": read_contact(output / "contact.csv", case.variant.turn)}


def off(contact, other):
    """Differences of pressures and of tangential tractions in L2 over their own norms, the worst of pairs and steps.

    Norms below a thousandth of that of all pressures count as that thousandth: a traction of zero has no relative error.
    """
    worst = [0., 0.]
    floor = 1e-3 * norm([(s, p) for nodes in other.values() for s, p, *_ in nodes])
    for key, nodes in contact.items():
        others = other.get(key, [])
        if len(nodes) != len(others):  # pruned otherwise
            by_place = {place: (p, t) for _, p, t, place in others}
            others = [(node[0], *by_place.get(node[3], (0., 0.))) for node in nodes]
        for which in (1, 2):
            wanted = norm([(node[0], node[which]) for node in others])
            error = norm([(a[0], a[which] - b[which]) for a, b in zip(nodes, others)])
            worst[which - 1] = max(worst[which - 1], error / max(wanted, floor) if error > 0 else 0.)
    return worst


def norm(values):
    """L2 along the boundary, (s, value) by s, trapezoidal rule on the squares."""
    values = sorted(values)
    return sum((b[0] - a[0]) * (a[1] ** 2 + b[1] ** 2) / 2 for a, b in zip(values, values[1:])) ** 0.5


def figures(summary):
    solver, residuals = summary["solver"], summary["residuals"]
    pairs = summary["results"]["contact"]
    pressures = [pair["max_pressure"] or 0 for step in summary["steps"] for pair in step["contact"]]
    errors = [pair["algebraic_error"] for step in summary["steps"] for pair in step["contact"] if "algebraic_error" in pair]
    worst = max(residuals, key=lambda name: float("inf") if residuals[name] is None else residuals[name])
    return {"multiplications": solver["hessian_multiplications"], "outer": solver["outer_iterations"],
            "fallbacks": solver["fallbacks"], "residual": residuals[worst], "residual_of": worst,
            "multiplications_of_a_step": max((step["hessian_multiplications"] for step in summary["steps"]), default=0),
            "pressure": max(pressures, default=0),
            "pressure_estimate": max((error["pressure"] for error in errors), default=None),
            "tangential_estimate": max((error["tangential"] for error in errors), default=None),
            "normal_force": pairs[0]["normal_force"] if pairs else None,
            "tangential_force": pairs[0]["tangential_force"] if pairs else None,
            "contact_nodes": sum(pair["contact_nodes"] for pair in pairs),
            "slip_nodes": sum(pair["slip_nodes"] for pair in pairs),
            "subdomains": summary["problem"]["subdomains"], "unknowns": summary["problem"]["primal_dofs"],
            "dual": summary["problem"]["dual"]["total"], "solve_s": summary["time_s"]["solve"],
            "warnings": "; ".join(summary["warnings"])}


def text(value, form):
    return "-" if value is None else format(value, form)


HEAD = (f"{'variant':58} {'status':>7} {'F-mult':>7} {'a step':>6} {'outer':>5} {'falls':>5} {'residual':>8} "
        f"{'p max':>11} {'normal':>11} {'s':>6}")


def line(result):
    status = str(result["status"]) + ("" if result["status"] == result["wanted"] else f" !{result['wanted']}")
    return (f"{result['name']:58} {status:>7} {text(result.get('multiplications'), 'd'):>7} "
            f"{text(result.get('multiplications_of_a_step'), 'd'):>6} {text(result.get('outer'), 'd'):>5} "
            f"{text(result.get('fallbacks'), 'd'):>5} {text(result.get('residual'), '.1e'):>8} "
            f"{text(result.get('pressure'), '.7g'):>11} {text(result.get('normal_force'), '.7g'):>11} {result['seconds']:6.1f}"
            + (f"  off: pressure {text(result.get('pressure_off'), '.1e')}, tangential {text(result.get('tangential_off'), '.1e')}"
               f", estimated {text(result.get('pressure_estimate'), '.1e')}, {text(result.get('tangential_estimate'), '.1e')}"
               if "against_status" in result else ""))


def difference(contact, other):
    """Largest difference of pressures and of the sizes of tangential tractions over the largest pressure; None if nodes differ."""
    largest = max((abs(node[1]) for nodes in contact.values() for node in nodes), default=0)
    if largest == 0 or contact.keys() != other.keys():
        return None
    worst = 0.
    for key, nodes in contact.items():
        others = {place: (p, t) for _, p, t, place in other[key]}
        if others.keys() != {place for *_, place in nodes}:
            return None
        for _, p, t, place in nodes:
            worst = max(worst, abs(p - others[place][0]) / largest, abs(abs(t) - abs(others[place][1])) / largest)
    return worst


def spread(results):
    """Among converged runs of the same discrete problem: of the largest pressures, and node by node."""
    pressures = [result["pressure"] for result in results if result["status"] == 0]
    if len(pressures) < 2 or max(pressures) == 0:
        return None, None
    of_maxima = (max(pressures) - min(pressures)) / max(pressures)
    with_nodes = [result["contact"] for result in results if result["status"] == 0 and result.get("contact")]
    differences = [difference(with_nodes[0], other) for other in with_nodes[1:]]
    known = [value for value in differences if value is not None]
    return of_maxima, max(known, default=None)


def summarise(cases, results):
    """One line a scene, then one a family."""
    print(f"\n{'scene':44} {'runs':>4} {'as wanted':>9} {'max mult':>8} {'a step':>7} {'max/min':>7} "
          f"{'spread of max p':>15} {'by nodes':>9}")
    families = {}
    for case, result in zip(cases, results):
        families.setdefault(case.family, {}).setdefault(case.scene, []).append((case, result))
    for family, scenes in families.items():
        everything = []
        for scene, pairs in scenes.items():
            print(summary_line(f"{family}/{scene}", [pairs]))
            everything.append(pairs)
        if len(scenes) > 1:
            print(summary_line(f"{family}: all", everything))


def summary_line(name, scenes):
    results = [result for pairs in scenes for _, result in pairs]
    counts = [result["multiplications"] for result in results if result.get("multiplications")]
    of_a_step = [result["multiplications_of_a_step"] for result in results if "multiplications_of_a_step" in result]
    ratios, spreads = [], []
    for pairs in scenes:
        of_scene = [result["multiplications"] for _, result in pairs if result.get("multiplications")]
        if of_scene:
            ratios.append(max(of_scene) / min(of_scene))
        problems = {}
        for case, result in pairs:
            problems.setdefault(case.variant.problem, []).append(result)
        spreads += [spread(equal) for equal in problems.values()]
    good = sum(result["status"] == result["wanted"] for result in results)
    of_maxima = max((value for value, _ in spreads if value is not None), default=None)
    by_nodes = max((value for _, value in spreads if value is not None), default=None)
    return (f"{name:44} {len(results):4} {good:9} {text(max(counts, default=None), 'd'):>8} "
            f"{text(max(of_a_step, default=None), 'd'):>7} {text(max(ratios, default=None), '.2f'):>7} "
            f"{text(of_maxima, '.1e'):>15} {text(by_nodes, '.1e'):>9}")


def write_csv(file_name, results):
    runs.write_csv(file_name, [{key: value for key, value in result.items() if key != "contact"} for result in results])


def main(cases, given):
    """Exit status: 1 when a run did not end as wanted."""
    given.timeout = given.timeout or (20 if given.quick else 120)
    cases = chosen(cases, given)
    if given.list:
        print("\n".join(case.name for case in cases))
        return 0
    if not cases:
        runs.say("no variant has such a name (see --list)")
        return 2
    program = None if given.write_only else pathlib.Path(given.program or runs.build()).resolve()
    folder = given.folder or pathlib.Path(tempfile.mkdtemp(prefix="slipstick-"))
    runs.say(f"{len(cases)} variants, scenes in {folder}")
    if not given.write_only:
        print(f"{runs.conditions()}\ntolerance {given.tolerance}, at most {given.timeout:g} s a run\n\n{HEAD}", flush=True)
    lock, results = threading.Lock(), [None] * len(cases)

    def do(number):
        result = run(cases[number], program, given, folder)
        if result is None:
            return
        with lock:
            results[number] = result
            print(line(result), flush=True)
            if given.csv:
                write_csv(given.csv, [one for one in results if one])

    # scenes that share a mesh file are written one after the other
    for case in cases if given.jobs > 1 else ():
        case.make(case.variant).write(folder / case.family / case.scene)
    with concurrent.futures.ThreadPoolExecutor(max(1, given.jobs)) as pool:
        list(pool.map(do, range(len(cases))))
    if given.write_only:
        return 0
    summarise(cases, results)
    return 0 if all(result["status"] == result["wanted"] for result in results) else 1


def variants(seeds, degrees=(1, 2), turn=37., exchange=True, ranks=True, subdomains=16):
    """The variants of a scene: seeds, subdomains, ranks, turned, exchanged; fewer with the later degrees."""
    first, *others = degrees
    numbers = [0, *range(2, seeds + 1)]  # the C library takes a seed of 0 for 1
    all_variants = [Variant(first, subdomains, seed) for seed in numbers[:seeds]]
    all_variants += [Variant(first, 0), Variant(first, 4), Variant(first, 2 * subdomains)]
    all_variants += [Variant(first, subdomains, turn=turn)] if turn else []
    all_variants += [Variant(first, subdomains, exchanged=True), Variant(first, 0, exchanged=True)] if exchange else []
    all_variants += [Variant(first, subdomains, ranks=2)] if ranks else []
    for degree in others:
        all_variants += [Variant(degree, subdomains, seed) for seed in numbers[:min(2, seeds)]] + [Variant(degree, 0)]
        all_variants += [Variant(degree, subdomains, turn=turn)] if turn else []
        all_variants += [Variant(degree, subdomains, exchanged=True)] if exchange else []
    return list(dict.fromkeys(all_variants))
