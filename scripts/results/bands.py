"""Title above and legend below, or both above, in bands outside the axes, so that they neither cover anything nor are cut off."""

import textwrap

LINE = 0.21  # inches a line of a title
PAD = 0.1  # inches
CHARACTERS_PER_INCH = 10.5  # of a title


def wrapped(lines, width):
    """Lines of a title for a figure of @p width inches."""
    return [part for line in lines for part in textwrap.wrap(line, max(20, int(width * CHARACTERS_PER_INCH)))]


def add(figure, lines, handles, legend_above=False):
    """To a figure with constrained layout that is not yet drawn."""
    width, height = figure.get_size_inches()
    lines = wrapped(lines, width)
    columns = max(1, min(len(handles), int(width / 1.7)))
    rows = -(-len(handles) // columns)
    legend = rows * LINE + PAD if handles else 0
    top = len(lines) * LINE + PAD + (legend if legend_above else 0)
    bottom = 0 if legend_above else legend
    figure.get_layout_engine().set(rect=(0, bottom / height, 1, 1 - (top + bottom) / height))
    figure.text(0.5, 1 - PAD / 2 / height, "\n".join(lines), ha="center", va="top", fontsize=11, linespacing=1.25)
    if handles:
        place = 1 - (len(lines) * LINE + PAD / 2) / height if legend_above else bottom / height
        figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, place), ncol=columns, fontsize=8,
                      frameon=False, borderaxespad=0.2, handlelength=1.6)
