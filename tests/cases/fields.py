"""Reads the .vtu files that deal.II writes (inline base64, zlib, one block a chunk): fields by position."""

import base64
import re
import struct
import zlib

FORMATS = {'Float32': ('f', 4), 'Float64': ('d', 8), 'Int32': ('i', 4), 'UInt8': ('B', 1), 'Int64': ('q', 8)}

ARRAY = re.compile(r'<DataArray ([^>]*)>([^<]*)</DataArray>')


def attribute(text, name, default=None):
    found = re.search(name + r'="([^"]*)"', text)
    return found.group(1) if found else default


def decode(text):
    """Bytes of a vtkZLibDataCompressor array: header of 32-bit numbers (blocks, size, last size, sizes), blocks."""
    words = base64.b64decode(text[:4 * ((4 * 4 + 2) // 3)])
    n_blocks = struct.unpack('<I', words[:4])[0]
    header_bytes = 4 * (3 + n_blocks)
    header_text = 4 * ((header_bytes + 2) // 3)
    sizes = struct.unpack('<{}I'.format(n_blocks), base64.b64decode(text[:header_text])[12:header_bytes])
    content, data, begin = base64.b64decode(text[header_text:]), b'', 0
    for size in sizes:
        data += zlib.decompress(content[begin:begin + size])
        begin += size
    return data


def read_vtu(path):
    """Name of each array ('Points' for the positions) -> list of tuples."""
    text = path.read_text()
    assert 'compressor="vtkZLibDataCompressor"' in text and 'byte_order="LittleEndian"' in text, path
    arrays = {}
    for attributes, content in ARRAY.findall(text):
        letter, size = FORMATS[attribute(attributes, 'type')]
        n = int(attribute(attributes, 'NumberOfComponents', '1'))
        data = decode(''.join(content.split()))
        values = struct.unpack('<{}{}'.format(len(data) // size, letter), data)
        arrays[attribute(attributes, 'Name', 'Points')] = [values[i:i + n] for i in range(0, len(values), n)]
    return arrays


def read_vtp(path):
    """The same of contact_NNN.vtp, whose arrays are not compressed."""
    arrays = {}
    for attributes, content in ARRAY.findall(path.read_text()):
        letter, size = FORMATS[attribute(attributes, 'type')]
        n, data = int(attribute(attributes, 'NumberOfComponents', '1')), base64.b64decode(content)[8:]
        values = struct.unpack('<{}{}'.format(len(data) // size, letter), data)
        arrays[attribute(attributes, 'Name')] = [values[i:i + n] for i in range(0, len(values), n)]
    return arrays


def pieces(directory):
    """The files that solution.pvd leads to, in their order."""
    pvd = (directory / 'solution.pvd').read_text()
    records = re.findall(r'file="([^"]*)"', pvd)
    return [directory / piece for record in records
            for piece in re.findall(r'Piece Source="([^"]*)"', (directory / record).read_text())]


def field(directory, name, digits=4):
    """Position (rounded) -> all values of a point field there, one for each copy of the node."""
    values = {}
    for piece in pieces(directory):
        arrays = read_vtu(piece)
        for position, value in zip(arrays['Points'], arrays[name]):
            key = tuple(round(x, digits) + 0. for x in position)
            values.setdefault(key, []).append(value)
    return values


def largest(values):
    return max(abs(x) for copies in values.values() for value in copies for x in value)


def largest_difference(a, b):
    """Between any two copies of a node, relative to the largest value."""
    if a.keys() != b.keys():
        raise AssertionError('{} and {} positions, {} in common'.format(len(a), len(b), len(a.keys() & b.keys())))
    return max(abs(x - y) for key in a for one in a[key] for other in b[key]
               for x, y in zip(one, other)) / largest(a)
