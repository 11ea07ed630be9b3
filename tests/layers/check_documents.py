#!/usr/bin/env python3
"""What the documents refer to is there: links between .md files, units and names in doc/method.md, numbers of decisions.

usage: check_documents.py ROOT        checks the tree, one line per fault, status 1 if there is any
       check_documents.py --self-test checks this script on small trees

Python's standard library only.
"""

import pathlib
import re
import sys
import tempfile

LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")
LAYERS = "base|scene|mesh|mechanics|interface|tfeti|qp|contact|output|app"
UNIT = re.compile(rf"(?<![\w/])((?:{LAYERS})/[a-z_]+)(\.h|\.cc)?\b")
NAME = re.compile(r"`([A-Za-z_]\w*(?:::\w+)*)(?:\(\))?`")  # `name`, `Class::name`, `name()`
DECISION = re.compile(r"doc/decisions/(\d{4})")
HEADING = re.compile(r"# (\d{4})\. (.+)")
SOURCES = ("include", "source", "tests", "benchmarks", "scripts", "prm")
FOLDERS = ("doc", "benchmarks")


def documents(root):
    yield from sorted(root.glob("*.md"))
    for folder in FOLDERS:
        yield from sorted((root / folder).rglob("*.md"))


def dead_links(root):
    for path in documents(root):
        for target in LINK.findall(path.read_text()):
            if "://" not in target and not (path.parent / target).exists():
                yield f"{path.relative_to(root)}: link to {target}, which does not exist"


def missing_units(root):
    path = root / "doc" / "method.md"
    if not path.exists():
        return
    for unit, ending in sorted(set(UNIT.findall(path.read_text()))):
        found = {".h": root / "include" / "slipstick" / f"{unit}.h", ".cc": root / "source" / f"{unit}.cc"}
        if not any(file.exists() for end, file in found.items() if ending in ("", end)):
            yield f"doc/method.md: there is no {unit}{ending}"


def missing_names(root):
    path = root / "doc" / "method.md"
    if not path.exists():
        return
    words = set()
    for folder in ("include", "source"):
        for file in (root / folder).rglob("*.*"):
            words.update(re.findall(r"\w+", file.read_text(errors="replace")))
    for name in sorted(set(NAME.findall(path.read_text()))):
        if not words.issuperset(name.split("::")):
            yield f"doc/method.md: there is no {name} in the sources"


def wrong_decisions(root):
    folder = root / "doc" / "decisions"
    if not folder.exists():
        return
    index = (folder / "README.md").read_text()
    numbers = []
    for path in sorted(folder.glob("[0-9]*.md")):
        number = path.name[:4]
        numbers.append(number)
        heading = HEADING.match(path.read_text())
        if not heading or heading.group(1) != number:
            yield f"doc/decisions/{path.name}: does not begin with '# {number}. TITLE'"
        elif f"| [{number}]({path.name}) | {heading.group(2)} |" not in index:
            yield f"doc/decisions/README.md: has no line '| [{number}]({path.name}) | {heading.group(2)} | ...'"
    for found, expected in zip(numbers, range(1, len(numbers) + 1)):
        if int(found) != expected:
            yield f"doc/decisions: {found} where {expected:04d} is expected"
            break
    for folder in SOURCES:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and path.suffix in (".h", ".cc", ".py", ".sh", ".prm", ".md", ""):
                for number in DECISION.findall(path.read_text(errors="replace")):
                    if number not in numbers:
                        yield f"{path.relative_to(root)}: there is no decision {number}"


def faults(root):
    root = pathlib.Path(root)
    return [*dead_links(root), *missing_units(root), *missing_names(root), *wrong_decisions(root)]


# The self test: files of a small tree, and a word of the fault that they must cause (None: they must pass).
INDEX = "| [0001](0001-a.md) | A | date | accepted |"
FIXTURES = {
    "clean tree": ({"README.md": "[x](doc/method.md#1-a) [y](https://z)", "doc/method.md": "mesh/mesh, mesh/mesh.h",
                    "include/slipstick/mesh/mesh.h": "// doc/decisions/0001", "doc/decisions/README.md": INDEX,
                    "doc/decisions/0001-a.md": "# 0001. A"}, None),
    "dead link": ({"doc/a.md": "[x](b.md)"}, "link to b.md"),
    "unit that moved": ({"doc/method.md": "see mesh/mesh"}, "no mesh/mesh"),
    "header that is none": ({"doc/method.md": "mesh/mesh.h", "source/mesh/mesh.cc": ""}, "no mesh/mesh.h"),
    "names": ({"doc/method.md": "`a::b` and `c()`", "include/slipstick/qp/a.h": "struct a { int b; };",
               "source/qp/a.cc": "void c();"}, None),
    "name that is gone": ({"doc/method.md": "`a::d`", "include/slipstick/qp/a.h": "struct a { int b; };"}, "no a::d"),
    "title that differs": ({"doc/decisions/README.md": INDEX, "doc/decisions/0001-a.md": "# 0001. B"}, "has no line"),
    "gap in the numbers": ({"doc/decisions/README.md": "| [0002](0002-a.md) | A |", "doc/decisions/0002-a.md": "# 0002. A"},
                           "0001 is expected"),
    "unknown decision": ({"doc/decisions/README.md": "", "source/qp/x.cc": "// doc/decisions/0001"}, "no decision 0001"),
}


def self_test():
    failures = 0
    for name, (files, word) in FIXTURES.items():
        with tempfile.TemporaryDirectory() as folder:
            for path, text in files.items():
                file = pathlib.Path(folder, path)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text)
            found = faults(folder)
        if (found != []) if word is None else not any(word in fault for fault in found):
            failures += 1
            print(f"{name}: found {found}, expected {word!r}")
    print(f"{len(FIXTURES)} fixtures, {failures} failures")
    return failures


def main(arguments):
    if arguments == ["--self-test"]:
        return 1 if self_test() else 0
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    found = faults(arguments[0])
    for fault in found:
        print(fault)
    print(f"{len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
