"""Sections and lists of a .prm, for the scripts beside this one that write scenes."""


def section(kind, **values):
    width = max(len(name) for name in values)
    lines = ['  set {} = {}'.format(name.replace('_', ' ').ljust(width), value) for name, value in values.items()]
    return '\n'.join(['', 'subsection ' + kind] + lines + ['end'])


def wrapped(name, values, last=120):
    """A list parameter; lines that end in a backslash go on."""
    lines = ['set {} ='.format(name)]
    for i, value in enumerate(values):
        word = ' ' + value + (',' if i + 1 < len(values) else '')
        if len(lines[-1]) + len(word) > last - 2:
            lines[-1] += ' \\'
            lines.append('   ')
        lines[-1] += word
    return '\n'.join(lines)
