"""seeds.py CORPUS: the files of the tests as inputs of fuzz_parsers: a byte for the format, then the file. Standard library only."""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FORMATS = ['.msh', '.inp', '.vtk', '.unv', '.ucd', '.stl', '.prm']  # as in parsers.cc
LARGEST = 8192

corpus = pathlib.Path(sys.argv[1])
for folder in ('tests/mesh/meshes', 'meshes', 'prm'):
    for path in sorted((ROOT / folder).iterdir()):
        if path.suffix in FORMATS and path.stat().st_size < LARGEST:
            (corpus / path.name).write_bytes(bytes([FORMATS.index(path.suffix)]) + path.read_bytes())
