#!/usr/bin/env python3
"""The examples of headers (@code ... @endcode in docstrings) as tests, one each, named after its header.

usage: extract_examples.py OUTPUT NAMESPACE HEADER...   fails for a header without an example

An assert() of an example becomes an EXPECT_TRUE. Python's standard library only.
"""

import pathlib
import re
import sys

BLOCK = re.compile(r"^[ \t]*/// @code\n(.*?)^[ \t]*/// @endcode$", re.MULTILINE | re.DOTALL)


def examples(header):
    found = BLOCK.findall(header.read_text())
    if not found:
        sys.exit(f"{header}: no example (@code ... @endcode in a docstring)")
    return ["\n".join(re.sub(r"^[ \t]*/// ?", "", line) for line in block.splitlines()) for block in found]


def main(output, namespace, *headers):
    lines = ["// Made by extract_examples.py.", "#undef assert", "#define assert(...) EXPECT_TRUE((__VA_ARGS__))",
             f"namespace {namespace}", "{"]
    for header in map(pathlib.Path, headers):
        for k, example in enumerate(examples(header)):
            lines += [f"TEST(Examples, {header.stem}{k or ''})", "{", f'#line 1 "example of {header.name}"', example, "}"]
    pathlib.Path(output).write_text("\n".join([*lines, "}", ""]))


if __name__ == "__main__":
    main(*sys.argv[1:])
