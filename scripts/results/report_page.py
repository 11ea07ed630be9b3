"""report.html: a run on one self-contained page."""

import base64
import html
import io

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

from . import painters, pictures, probe_plot, scene_drawing

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 1.5rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; margin-bottom: 0; } h2 { font-size: 1.15rem; margin: 1.8rem 0 .5rem; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; margin: .5rem 0; } td, th { padding: .2rem .7rem; border-bottom: 1px solid #ddd; text-align: right; }
th { background: #f3f3f3; font-weight: 600; } td:first-child, th:first-child { text-align: left; }
tr.sum td { border-top: 2px solid #888; font-weight: 600; } img { max-width: 100%; height: auto; } .scroll { overflow-x: auto; }
.good { color: #0a6b2d; } .bad { color: #b00020; } .warning { background: #fff4d6; border-left: 4px solid #e0a800; padding: .4rem .8rem; margin: .4rem 0; }
.bar { display: inline-block; height: .8em; background: #4a7ebb; vertical-align: middle; } figure { margin: .8rem 0; } .small { color: #666; font-size: .9em; }
"""
MOST_LOOPS = 8  # curves of forces over displacements
CLOSED_BALANCE = 1e-6  # of the largest force: less than this is called zero
ROUNDING = 1e-9  # of the largest force or displacement: curves below it are not drawn


def number(value, digits=5):
    return "-" if value is None else f"{value:.{digits}g}"


def with_bar(run, value, quantity):
    """A figure with the estimate of its error, where the run made one."""
    error = run.error_bar(quantity)
    return number(value) if error is None else f"{number(value)} \u00b1 {number(error, 2)}"


def table(head, rows, sums=()):
    text = "<div class=scroll><table><tr>" + "".join(f"<th>{html.escape(cell)}</th>" for cell in head) + "</tr>"
    for kind, group in (("", rows), (" class=sum", sums)):
        for row in group:
            text += f"<tr{kind}>" + "".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) + "</tr>"
    return text + "</table></div>"


def picture(figure, alt):
    """Closes the figure."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=110)
    plt.close(figure)
    return f'<figure><img alt="{html.escape(alt)}" src="data:image/png;base64,{base64.b64encode(data.getvalue()).decode()}"></figure>'


def heading(run):
    summary, title = run.summary, run.scene.get("Title")
    good = summary.get("converged")
    text = f"<h1>{html.escape(title or summary.get('case', 'run'))}</h1><p class=small>{html.escape(str(summary.get('case', '')))}, "
    text += f"slipstick {html.escape(str(summary.get('version', '')))}, {html.escape(str(run.folder))}</p>"
    text += f"<p>Status: <b class={'good' if good else 'bad'}>{html.escape(str(summary.get('status', 'unknown')))}</b>"
    return text + ("" if good else ": the results below are not a solution") + "</p>"


def figures(run):
    """What is read off first."""
    summary = run.summary
    results, error, problem, solver = (summary.get(key, {}) for key in ("results", "error", "problem", "solver"))
    estimate = error.get("estimate_energy_relative")
    rows = [("largest displacement", with_bar(run, results.get("max_displacement"), "max_displacement") + " mm"),
            ("largest von Mises stress", number(results.get("max_von_mises")) + " MPa"),
            ("strain energy", with_bar(run, results.get("strain_energy"), "strain_energy") + " N mm"),
            ("discretisation error in the energy norm, estimated", "-" if estimate is None else f"{100 * estimate:.2g} %"),
            ("algebraic error in the energy norm, at most", "-" if error.get("algebraic_relative") is None else
             f"{100 * error['algebraic_relative']:.1g} %"),
            ("unknowns, cells, subdomains", ", ".join(str(problem.get(key, "-")) for key in ("primal_dofs", "cells", "subdomains"))),
            ("algorithm, tolerance, multiplications with F",
             f"{solver.get('algorithm', '-')}, {number(solver.get('tolerance'))}, {solver.get('hessian_multiplications', '-')}")]
    return table(("quantity", "value"), rows)


def warnings(run):
    texts = run.summary.get("warnings", [])
    if not texts:
        return "<p>None.</p>"
    return "".join(f"<div class=warning>{html.escape(text)}</div>" for text in texts)


def balance(results):
    """Loads and reactions of one step; contact with obstacles is outside, too."""
    entries = [(f"{entry['kind']} {entry['load']}", entry) for entry in results.get("loads", [])]
    entries += [(f"{kind} {entry[kind]}", entry) for kind in ("support", "foundation") for entry in results.get(kind + "s", [])]
    return entries


def balance_table(run, results):
    entries = balance(results)
    obstacles = set(run.scene.names("Obstacles"))
    entries += [(f"contact {pair['pair']} with obstacle {master}", pair) for pair in results.get("contact", [])
                for master in [run.scene.get(f"Contact {pair['pair']}/Master")] if master in obstacles and "force" in pair]
    def parts(entry):
        moment = entry["moment"]
        return list(entry["force"]), list(moment) if isinstance(moment, list) else [moment]

    rows = [(name, *map(number, sum(parts(entry), []))) for name, entry in entries]
    cells = []
    for of_kind in zip(*(parts(entry) for _, entry in entries)):  # all forces, then all moments
        scale = max(abs(value) for values in of_kind for value in values)
        totals = map(sum, zip(*of_kind))
        cells += ["0" if abs(total) <= CLOSED_BALANCE * scale else number(total, 3) for total in totals]
    head = [f"F{axis} [N]" for axis in "xyz"] + [f"M{axis} [N mm]" for axis in "xyz"]
    if not painters.is_in_space(run):
        head = ["Fx [N]", "Fy [N]", "moment about the origin [N mm]"]
    return table(("acts on the bodies", *head), rows, [("sum", *cells)])


def pairs_table(run):
    keys = (("normal_force", "normal force [N]"), ("tangential_force", "tangential force [N]"), ("max_pressure", "largest pressure [MPa]"),
            ("contact_length", "length in contact [mm]"), ("contact_area", "area in contact [mm^2]"), ("contact_nodes", "nodes in contact"), ("stick_nodes", "stick"),
            ("slip_nodes", "slip"), ("open_nodes", "open"))
    pairs = run.summary.get("results", {}).get("contact", [])
    keys = [(key, name) for key, name in keys if any(key in pair for pair in pairs)]
    rows = [(pair["pair"], *(with_bar(run, pair.get(key), f"{pair['pair']}.{key}") for key, _ in keys)) for pair in pairs]
    return table(("pair", *(name for _, name in keys)), rows) if rows else "<p>The scene has no contact.</p>"


def bars_table(run):
    """All figures whose errors were asked for, of the last load step."""
    rows = [(bar["quantity"], number(bar["value"]), number(bar["error"], 2) if bar.get("error") is not None else
             f"none: {bar.get('reason', 'not known')}", bar.get("unit", "")) for bar in run.summary.get("error_bars", [])]
    return table(("figure", "value", "estimated error of the mesh", "unit"), rows) if rows else ""


def bolts_table(run):
    """What was asked of every bolt when it was last tightened, and what it bears."""
    steps, rows = run.summary.get("steps", []), []
    for number_of_bolt, now in enumerate(run.summary.get("results", {}).get("pretensions", [])):
        section = "Pretension " + now["pretension"]
        point = run.scene.numbers(section + "/Point")
        tightened = [(step["load_factor"], step["pretensions"][number_of_bolt]) for step in steps
                     if step["pretensions"][number_of_bolt]["tightened"]]
        t, then = tightened[-1] if tightened else (None, {})
        asked = run.scene.field(section + "/Force", *point[:2], t) if tightened and len(point) > 1 else None
        rows.append((now["pretension"], run.scene.get(section + "/Body"), run.scene.get(section + "/Point"),
                     run.scene.get(section + "/Direction"), number(t), number(asked, 7), number(then.get("force"), 7),
                     number(now["force"], 7), number(now["shortening"])))
    head = ("bolt", "body", "section at [mm]", "axis", "tightened until t", "tension asked [N]", "reached [N]",
            "tension at the end [N]", "shortened by [mm]")
    return table(head, rows) if rows else ""


def largest_of(rows, names):
    """Magnitude in the columns of history.csv."""
    return max((abs(float(row[name] or 0)) for row in rows for name in names), default=0.)


def force_columns(rows, ends):
    """Columns of history.csv with forces of these components that are more than rounding."""
    forces = [name for name in rows[0] if name.endswith((" Fx", " Fy", " Fz", " force"))]
    least = ROUNDING * largest_of(rows, forces)
    return [name for name in forces if name.endswith(ends) and largest_of(rows, [name]) > least]


def history_plot(run):
    """Resultants, and tensions of bolts, over the load factor."""
    rows = run.table("history.csv")
    if len(rows) < 2:
        return ""
    columns = force_columns(rows, (" Fx", " Fy", " Fz", " force"))
    figure, axes = plt.subplots(figsize=(8, 4.2), layout="constrained")
    for name in columns:
        axes.plot([float(row["t"]) for row in rows], [float(row[name]) for row in rows], marker=".", label=name)
    axes.set(xlabel="t, load factor", ylabel="[N]", title="forces on the bodies over the load steps")
    axes.grid(True, color="0.9")
    if columns:
        axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    return picture(figure, "forces over the load factor")


def moved_by(run, rows):
    """What moves, in the order of interest: name, displacement in every row, axis; of probed points and of supports that are moved."""
    found = []
    for axis in "xyz":
        for column in (name for name in rows[0] if name.startswith("probe ") and name.endswith(" u" + axis)):
            found.append((column, [float(row[column]) for row in rows], axis))
        for name in run.scene.names("Supports"):
            values = [run.scene.field(f"Support {name}/Displacement {axis}", 0., 0., float(row["t"])) for row in rows]
            if None not in values:
                found.append((f"support {name} u{axis}", values, axis))
    least = ROUNDING * max((max(map(abs, values)) for _, values, _ in found), default=0.)
    return [entry for entry in found if max(entry[1]) > min(entry[1]) and max(map(abs, entry[1])) > least]


def loop_plot(run):
    """Forces over displacements: stiffness, and what friction takes in a cycle. A support's own reaction over its motion; loads over the
    probed points."""
    rows = run.table("history.csv")
    curves = []
    for what, displacement, axis in moved_by(run, rows) if len(rows) > 1 else ():
        for column in force_columns(rows, f" F{axis}"):
            own = column == f"{what[:-3]} F{axis}"
            if own or what.startswith("probe ") and column.startswith(("traction ", "point load ", "support ")):
                force = [float(row[column]) for row in rows]
                if max(force) > min(force):
                    curves.append((column, what, displacement, force))
    if not curves:
        return ""
    figure, axes = plt.subplots(figsize=(8, 4.2), layout="constrained")
    for column, what, displacement, force in curves[:MOST_LOOPS]:
        axes.plot(displacement, force, marker=".", label=f"{column} over {what}")
    axes.set(xlabel="displacement [mm]", ylabel="[N]", title="forces over displacements")
    axes.grid(True, color="0.9")
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.15), frameon=False)
    return picture(figure, "forces over displacements")


def drawings(run, options):
    text = ""
    grids = painters.grids(run)
    for name in ("von_mises", "displacement") if grids else ():
        painter = painters.field_painter(run, name, options, grids)
        text += picture(painter.draw(len(grids) - 1), painter.title)
    if run.contact:
        painter = painters.contact_painter(run)
        figure = painter.draw(painter.steps[-1])
        if figure:
            text += picture(figure, "tractions along the contact boundaries")
    probes = probe_plot.ProbePainter(run)
    if probes.probes:
        text += picture(probes.draw(probes.steps[-1]), "values at the probes")
    return text or "<p>The run wrote no fields (Output/VTU) and has no contact nodes.</p>"


def costs(run):
    seconds, memory = run.summary.get("time_s", {}), run.summary.get("memory_mb", {})
    total = seconds.get("total") or 1.
    rows = "".join(f"<tr><td>{html.escape(stage)}</td><td>{value:.3g} s</td><td style='text-align:left'>"
                   f"<span class=bar style='width:{max(0., 20 * value / total):.2f}rem'></span></td></tr>"
                   for stage, value in seconds.items() if stage != "total" and isinstance(value, (int, float)))
    return (f"<p>{number(seconds.get('total'), 3)} s on {run.summary.get('ranks', '-')} MPI rank(s), "
            f"{number(memory.get('peak_total'), 4)} MB of memory in all, {number(memory.get('peak_rank_max'), 4)} MB on one rank.</p>"
            f"<table><tr><th>stage</th><th>time</th><th></th></tr>{rows}</table>")


def scene(run):
    if painters.is_in_space(run):
        return "<p>Solids are drawn below, with their results.</p>"
    if not run.grid_files:
        return "<p>Not drawn: the run wrote no fields (Output/VTU).</p>"
    return picture(scene_drawing.draw(run), "the scene before loading")


def page(run, options=None):
    options = options or pictures.Options()
    results = run.summary.get("results", {})
    sections = [("Scene", scene(run)),
                ("Results", figures(run)), ("Warnings", warnings(run)),
                ("Balance of loads and reactions" + (", last load step" if len(run.factors) > 1 else ""), balance_table(run, results)),
                ("Contact pairs", pairs_table(run)), ("Error bars", bars_table(run)),
                ("Bolts", bolts_table(run)), ("Load steps", history_plot(run) + loop_plot(run)), ("Pictures", drawings(run, options)),
                ("Time and memory", costs(run))]
    body = heading(run) + "".join(f"<h2>{html.escape(name)}</h2>{text}" for name, text in sections if text)
    title = html.escape(run.summary.get("case", "run"))
    return f"<!DOCTYPE html><html lang=en><head><meta charset=utf-8><title>{title}</title><style>{STYLE}</style></head><body>{body}</body></html>\n"
