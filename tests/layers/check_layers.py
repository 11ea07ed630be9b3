#!/usr/bin/env python3
"""Who may include whom: reads the #include lines of include/slipstick and source and fails on a violation.

usage: check_layers.py ROOT        checks the tree, one line a violation, status 1 when there is any
       check_layers.py --self-test checks this script on small trees

The rules are those of doc/architecture.md. Folder = layer = namespace; a unit is LAYER/STEM, its header and source
together. Python's standard library only.
"""

import pathlib
import re
import sys
import tempfile
from dataclasses import dataclass, field

ALL_OF_DEALII = {"base", "distributed", "dofs", "fe", "grid", "hp", "lac", "matrix_free", "meshworker", "multigrid",
                 "numerics", "physics"}


@dataclass
class Rule:
    """What files of a layer may include besides the standard library and their own layer."""

    layers: set = field(default_factory=set)  # whole layers
    headers: set = field(default_factory=set)  # single headers of other layers, LAYER/NAME.h
    dealii: set = field(default_factory=set)  # sub-folders of deal.II
    libraries: set = field(default_factory=set)  # names from LIBRARIES


RULES = {
    "base": Rule(dealii={"base"}, libraries={"MPI", "Boost", "POSIX"}),
    "qp": Rule(),
    "tfeti": Rule(layers={"base", "qp"}, dealii={"base", "lac"},
                  libraries={"MPI", "Boost", "Eigen", "Trilinos", "CHOLMOD", "POSIX"}),
    "scene": Rule(layers={"base"}, headers={"qp/node_set.h", "qp/options.h", "tfeti/options.h"}, dealii={"base"},
                  libraries={"MPI", "Boost", "muParser"}),
    "mesh": Rule(layers={"base", "scene"}, dealii={"base", "grid"}, libraries={"MPI", "Boost", "METIS"}),
    "mechanics": Rule(layers={"base", "mesh", "scene"},
                      # of tfeti the plain data: matrices that it fills, unknowns that subdomains share
                      headers={"tfeti/constraints.h", "tfeti/subdomain_matrices.h"},
                      dealii={"base", "dofs", "fe", "grid", "lac"}, libraries={"MPI", "Boost", "Eigen"}),
    "interface": Rule(layers={"base", "mechanics", "mesh", "scene"},
                      headers={"tfeti/constraints.h", "tfeti/dense.h"},  # the rows that it fills; decompositions
                      dealii={"base"}, libraries={"MPI", "Boost", "Eigen"}),
    "contact": Rule(layers={"base", "qp", "scene", "tfeti"}, dealii={"base", "lac"}, libraries={"MPI", "Eigen"}),
    "output": Rule(layers={"base", "contact", "mechanics", "mesh"}, dealii=ALL_OF_DEALII, libraries={"MPI", "JSON", "POSIX", "zlib"}),
    "app": Rule(layers={"base", "contact", "interface", "mechanics", "mesh", "output", "qp", "scene", "tfeti"}, dealii=ALL_OF_DEALII,
                libraries={"MPI", "Boost", "JSON", "CLI11", "POSIX", "Trilinos"}),
}

# First match counts; a header that matches none is an unknown library.
LIBRARIES = [
    ("MPI", r"mpi\.h$"),
    ("Eigen", r"(unsupported/)?Eigen/"),
    ("JSON", r"nlohmann/"),
    ("CLI11", r"CLI/"),
    ("Boost", r"boost/"),  # as deal.II uses it: serialization over MPI, property trees
    ("muParser", r"muParser\.h$"),
    ("METIS", r"metis\.h$"),
    ("CHOLMOD", r"(suitesparse/)?(cholmod|SuiteSparse_config|amd|colamd|camd|ccolamd)\.h$"),
    ("Trilinos", r"(trilinos/)?(Amesos2|Tpetra|Teuchos|Kokkos|Belos|Epetra|Amesos|Xpetra|Trilinos)"),
    ("zlib", r"zlib\.h$"),
    ("POSIX", r"(sys/|unistd\.h$|fcntl\.h$|dlfcn\.h$|ext/stdio_filebuf\.h$)"),  # the last: a stream on a file descriptor
]

# A matter of the build, not of a layer.
EXEMPT = {"source/base/precompiled.h"}

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)
STANDARD = re.compile(r"^[a-z_]+$")
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)


def unit_of(layer, name):
    return layer + "/" + pathlib.PurePosixPath(name).with_suffix("").as_posix().removesuffix(".templates")


def check_include(layer, header):
    """Why files of the layer may not include <header>; None when they may."""
    rule = RULES[layer]
    parts = header.split("/")
    if STANDARD.match(header):
        return None
    if parts[0] == "slipstick":
        other = parts[1]
        if len(parts) < 3 or other not in RULES:
            return "no such layer"
        if other == layer or other in rule.layers or "/".join(parts[1:]) in rule.headers:
            return None
        single = sorted(name for name in rule.headers if name.startswith(other + "/"))
        return f"{layer} may not include {other}" + (f", only {', '.join(single)}" if single else "")
    if parts[0] == "deal.II":
        if parts[1] in rule.dealii:
            return None
        allowed = "of deal.II only " + ", ".join(sorted(rule.dealii)) if rule.dealii else "nothing of deal.II"
        return f"{layer} may include {allowed}"
    for library, pattern in LIBRARIES:
        if re.match(pattern, header):
            return None if library in rule.libraries else f"{layer} may not include {library}"
    return "unknown library: add it to tests/layers/check_layers.py and doc/dependencies.md"


def find_cycles(edges):
    """One cycle of every strongly connected group of units, as lists of units."""
    cycles, done = [], set()
    for start in sorted(edges):
        if start in done:
            continue
        path = path_back(edges, start)
        if path:
            cycles.append(path)
            done.update(path)
    return cycles


def path_back(edges, start):
    """A shortest path from start to itself; empty when there is none."""
    previous, queue = {}, [start]
    for unit in queue:
        for other in sorted(edges.get(unit, ())):
            if other == start:
                path = [start]
                while unit != start:
                    path.insert(1, unit)
                    unit = previous[unit]
                return path + [start]
            if other not in previous:
                previous[other] = unit
                queue.append(other)
    return []


def source_files(root):
    """(path relative to root, layer, name in the layer) of every C++ file."""
    for folder in ("include/slipstick", "source"):
        for path in sorted((root / folder).rglob("*")):
            relative = path.relative_to(root / folder)
            if path.suffix in (".h", ".hpp", ".cc", ".cpp", ".inst") and path.is_file():
                layer = relative.parts[0] if len(relative.parts) > 1 else ""
                yield path.relative_to(root).as_posix(), layer, "/".join(relative.parts[1:])


def check(root):
    """All violations in the tree, and the number of files read."""
    root = pathlib.Path(root)
    violations, edges, n_files = [], {}, 0
    for path, layer, name in source_files(root):
        n_files += 1
        if path in EXEMPT:
            continue
        if layer not in RULES:
            violations.append(f"{path}: '{layer}' is no layer; layers: {', '.join(RULES)}")
            continue
        text = COMMENT.sub(lambda comment: "\n" * comment.group().count("\n"), (root / path).read_text(errors="replace"))
        for match in INCLUDE.finditer(text):
            header = match.group(2)
            line = text.count("\n", 0, match.start()) + 1
            reason = check_include(layer, header) if match.group(1) == "<" else "write <slipstick/LAYER/NAME.h>"
            if reason:
                violations.append(f"{path}:{line}: {match.group(0).strip()}: {reason}")
            if header.startswith("slipstick/") and header.count("/") >= 2:
                _, other_layer, other_name = header.split("/", 2)
                unit, other = unit_of(layer, name), unit_of(other_layer, other_name)
                if unit != other:
                    edges.setdefault(unit, set()).add(other)
    violations += ["cycle of units: " + " -> ".join(cycle) for cycle in find_cycles(edges)]
    return violations, n_files


# The self test: files of a small tree, and a word of the violation that they must cause (None: they must pass).
FIXTURES = {
    "clean tree": ({"include/slipstick/qp/box.h": "#include <vector>",
                    "include/slipstick/tfeti/dual.h": "#include <slipstick/qp/box.h>\n#include <deal.II/lac/vector.h>",
                    "source/tfeti/dual.cc": "#include <slipstick/tfeti/dual.h>\n#include <cholmod.h>",
                    "source/app/main.cc": "#include <slipstick/tfeti/dual.h>\n#include <CLI/CLI.hpp>"}, None),
    "qp with deal.II": ({"include/slipstick/qp/box.h": "#include <deal.II/base/point.h>"}, "nothing of deal.II"),
    "qp with MPI": ({"include/slipstick/qp/box.h": "#include <mpi.h>"}, "qp may not include MPI"),
    "qp with base": ({"include/slipstick/qp/box.h": "#include <slipstick/base/log.h>"}, "qp may not include base"),
    "tfeti with a mesh": ({"source/tfeti/dual.cc": "#include <deal.II/grid/tria.h>"}, "of deal.II only base, lac"),
    "tfeti with scene": ({"source/tfeti/dual.cc": "#include <slipstick/scene/scene.h>"}, "may not include scene"),
    "Trilinos in mesh": ({"source/mesh/mesh.cc": "#include <Tpetra_Core.hpp>"}, "mesh may not include Trilinos"),
    "CHOLMOD in contact": ({"source/contact/x.cc": "#include <suitesparse/cholmod.h>"}, "may not include CHOLMOD"),
    "contact with a mesh": ({"source/contact/x.cc": "#  include <deal.II/dofs/dof_handler.h>"}, "base, lac"),
    "contact with mesh": ({"source/contact/x.cc": "#include <slipstick/mesh/mesh.h>"}, "may not include mesh"),
    "mesh with elements": ({"source/mesh/x.cc": "#include <slipstick/mechanics/spaces.h>"}, "may not include mechanics"),
    "mesh with spaces of deal.II": ({"source/mesh/x.cc": "#include <deal.II/dofs/dof_handler.h>"}, "base, grid"),
    "mesh with rows": ({"source/mesh/x.cc": "#include <slipstick/tfeti/constraints.h>"}, "may not include tfeti"),
    "mechanics with contact": ({"source/mechanics/x.cc": "#include <slipstick/interface/mortar.h>"},
                               "may not include interface"),
    "mechanics with METIS": ({"source/mechanics/x.cc": "#include <metis.h>"}, "may not include METIS"),
    "interface with elements of deal.II": ({"source/interface/x.cc": "#include <deal.II/fe/fe_q.h>"}, "of deal.II only base"),
    "interface with matrices": ({"source/interface/x.cc": "#include <slipstick/tfeti/subdomain_matrices.h>"},
                                "only tfeti/constraints.h, tfeti/dense.h"),
    "scene with a solver": ({"source/scene/x.cc": "#include <slipstick/qp/mpgp.h>"}, "only qp/node_set.h"),
    "scene with options": ({"source/scene/x.cc": "#include <slipstick/qp/options.h>"}, None),
    "mechanics with an operator": ({"source/mechanics/x.cc": "#include <slipstick/tfeti/dual_operator.h>"}, "only tfeti/"),
    "interface with plain data": ({"source/interface/x.cc": "#include <slipstick/tfeti/constraints.h>"}, None),
    "output in contact": ({"source/contact/x.cc": "#include <slipstick/output/csv.h>"}, "may not include output"),
    "app in output": ({"source/output/x.cc": "#include <slipstick/app/simulation.h>"}, "may not include app"),
    "base with qp": ({"source/base/x.cc": "#include <slipstick/qp/box.h>"}, "base may not include qp"),
    "unknown library": ({"source/app/x.cc": "#include <petsc.h>"}, "unknown library"),
    "unknown layer": ({"source/util/x.cc": "#include <vector>"}, "is no layer"),
    "file outside the layers": ({"source/main.cc": "#include <vector>"}, "is no layer"),
    "quotes": ({"source/app/x.cc": '#include "../mesh/mesh.h"'}, "write <slipstick/LAYER/NAME.h>"),
    "comments": ({"include/slipstick/qp/box.h": "// #include <mpi.h>\n/*\n#include <mpi.h>\n*/"}, None),
    "cycle of headers": ({"include/slipstick/mesh/a.h": "#include <slipstick/mesh/b.h>",
                          "include/slipstick/mesh/b.h": "#include <slipstick/mesh/c.h>",
                          "include/slipstick/mesh/c.h": "#include <slipstick/mesh/a.h>"},
                         "cycle of units: mesh/a -> mesh/b -> mesh/c -> mesh/a"),
    "cycle through a source": ({"include/slipstick/mesh/a.h": "", "include/slipstick/mesh/b.h": "",
                                "source/mesh/a.cc": "#include <slipstick/mesh/a.h>\n#include <slipstick/mesh/b.h>",
                                "source/mesh/b.cc": "#include <slipstick/mesh/a.h>"},
                               "cycle of units: mesh/a -> mesh/b -> mesh/a"),
}


def self_test():
    failures = 0
    for name, (files, expected) in FIXTURES.items():
        with tempfile.TemporaryDirectory() as folder:
            for path, text in files.items():
                file = pathlib.Path(folder, path)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text + "\n")
            violations, _ = check(folder)
        # One planted violation, one report: a second one would be a false alarm.
        right = not violations if expected is None else len(violations) == 1 and expected in violations[0]
        if not right:
            failures += 1
            print(f"{name}: expected {expected!r}, found {violations}")
    print(f"self test: {len(FIXTURES)} trees, {failures} failures")
    return 1 if failures else 0


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    if len(arguments) != 1:
        print(__doc__)
        return 2
    violations, n_files = check(arguments[0])
    for violation in violations:
        print(violation)
    print(f"{n_files} files, {len(violations)} violations")
    if n_files == 0:
        print(f"nothing to check below {arguments[0]}: is it the root of the tree?")
        return 2
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
