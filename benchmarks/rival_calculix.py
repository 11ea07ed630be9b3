"""Decks for CalculiX (surface-to-surface penalty contact of two meshes of quadrilaterals or hexahedra), its runs and its results."""

import os
import pathlib
import re
import subprocess
import tempfile
import time

import runs

FACES = ((0, 1), (1, 2), (2, 3), (3, 0))  # ends of the edges S1 to S4 of a quadrilateral


def edges_where(body, condition):
    """(element, number of its edge from 1) of the outer edges both of whose ends meet condition(x, y)."""
    seen = {}
    for element, cell in enumerate(body["cells"]):
        for face, ends in enumerate(FACES):
            key = tuple(sorted(cell[end] for end in ends))
            seen.setdefault(key, []).append((element, face + 1))
    return [where[0] for key, where in seen.items()
            if len(where) == 1 and all(condition(*body["points"][point]) for point in key)]


def write_deck(file_name, bodies, held, pressed, contact, physics):
    """Bodies: points, cells (counterclockwise; hexahedra as C3D8), young, poisson. held: [(body, points, directions)]; pressed: (body,
    edges or faces, MPa); contact: ((slave body, edges), (master body, edges)); physics: element, penalty, stick, friction."""
    is_solid = len(bodies[0]["points"][0]) == 3
    line = (lambda i, point: ",".join([str(i), *(f"{x:.15g}" for x in point)] + ([] if is_solid else ["0"])) + "\n")
    with open(file_name, "w", encoding="ascii") as file:
        write = file.write
        first_node, first_element, n_nodes, n_elements = [], [], 0, 0
        for number, body in enumerate(bodies):
            first_node.append(n_nodes + 1)
            first_element.append(n_elements + 1)
            write("*NODE\n" + "".join(line(n_nodes + 1 + i, point) for i, point in enumerate(body["points"])))
            write(f"*ELEMENT,TYPE={physics['element']},ELSET=E{number}\n")
            write("".join(f"{n_elements + 1 + i},{','.join(str(n_nodes + 1 + point) for point in cell)}\n"
                          for i, cell in enumerate(body["cells"])))
            write(f"*MATERIAL,NAME=M{number}\n*ELASTIC\n{body['young']:g},{body['poisson']:g}\n"
                  f"*SOLID SECTION,ELSET=E{number},MATERIAL=M{number}\n" + ("" if is_solid else "1.\n"))
            n_nodes += len(body["points"])
            n_elements += len(body["cells"])
        for name, (body, edges) in zip(("SLAVE", "MASTER"), contact):
            write(f"*SURFACE,NAME={name},TYPE=ELEMENT\n" + "".join(f"{first_element[body] + e},S{f}\n" for e, f in edges))
        write(f"*SURFACE INTERACTION,NAME=I\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n{physics['penalty']:g}\n")
        if physics["friction"]:
            write(f"*FRICTION\n{physics['friction']:g},{physics['stick']:g}\n")
        write("*CONTACT PAIR,INTERACTION=I,TYPE=SURFACE TO SURFACE\nSLAVE,MASTER\n*BOUNDARY\n")
        for body, points, directions in held:
            write("".join(f"{first_node[body] + point},{directions[0]},{directions[-1]}\n" for point in points))
        body, edges, pressure = pressed
        write("*STEP\n*STATIC,SOLVER=SPOOLES\n1.,1.\n*DLOAD\n"
              + "".join(f"{first_element[body] + e},P{f},{pressure:g}\n" for e, f in edges))
        write(f"*CONTACT FILE\nCDIS,CSTR\n*NODE FILE{'' if is_solid else ',OUTPUT=2D'}\nU\n*END STEP\n")
    return first_node


def blocks_of_frd(text):
    """{name of a result: {node: values}} of the last increment."""
    found = {}
    for name, body in re.findall(r"^ -4  (\w+) .*?\n((?: -5.*\n)*(?: -1.*\n)*)", text, re.M):
        found[name] = {int(line[3:13]): [float(line[i:i + 12]) for i in range(13, len(line.rstrip("\n")) - 11, 12)]
                       for line in body.splitlines() if line.startswith(" -1")}
    return found


def run(write, cores):
    """write(file name) makes the deck; wall time, peak memory, iterations, blocks of results."""
    with tempfile.TemporaryDirectory(prefix="calculix-") as directory:
        write(str(pathlib.Path(directory) / "deck.inp"))
        environment = dict(os.environ, OMP_NUM_THREADS=str(cores), OPENBLAS_NUM_THREADS="1")
        start = time.monotonic()
        with open(pathlib.Path(directory) / "log", "w", encoding="utf-8") as log:
            process = subprocess.Popen(["ccx", "deck"], cwd=directory, env=environment, stdout=log, stderr=subprocess.STDOUT)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        wall = time.monotonic() - start
        log = (pathlib.Path(directory) / "log").read_text(encoding="utf-8", errors="replace")
        if process.returncode or "Job finished" not in log:
            raise runs.RunFailed(f"ccx status {process.returncode}: {log.strip()[-300:]}")
        increments = [line.split() for line in (pathlib.Path(directory) / "deck.sta").read_text(encoding="ascii").splitlines()[2:]]
        return {"total_s": wall, "memory_mb": usage.ru_maxrss / 1024, "iterations": sum(int(line[3]) for line in increments),
                "blocks": blocks_of_frd((pathlib.Path(directory) / "deck.frd").read_text(encoding="ascii"))}
