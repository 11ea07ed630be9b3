"""Scenes that no file of prm/ holds: one box of 10 x 10 mm, on the circle of box_on_circle.prm or without it."""

from program import new_path

CIRCLE = {'Slave': 'box/bottom', 'Master': 'disc', 'Law': 'Tresca', 'Slip bound': '500'}
HELD = {'Boundary': 'box/left', 'Displacement x': '0', 'Displacement y': '0'}
PRESSED = {'Boundary': 'box/top', 'Traction y': '-250'}
ELASTIC = {'Young modulus': '1e5', 'Poisson ratio': '0.35'}
BOX = {'Size': '10, 10', 'Material': 'elastic'}
DISC = {'Center': '5, -20', 'Radius': '20'}
SMALL = {'Method': 'blocks', 'Blocks': '2', 'Cells per block': '5'}


def text(**kinds):
    """kinds: supports={'held': {...}}, tractions=..., contacts=..., and sections of fixed name: Solver={...}; whatever
    is left out is a box without supports and loads on a small mesh."""
    kinds = {'materials': {'elastic': ELASTIC}, 'bodies': {'box': BOX}, 'Decomposition': SMALL, **kinds}
    if any('disc' == contact.get('Master') for contact in kinds.get('contacts', {}).values()):
        kinds.setdefault('obstacles', {'disc': DISC})
    lists = {'materials': 'Material', 'bodies': 'Body', 'obstacles': 'Obstacle', 'supports': 'Support',
             'foundations': 'Foundation', 'tractions': 'Traction', 'contacts': 'Contact', 'body_forces': 'Body force',
             'point_loads': 'Point load', 'probes': 'Probe', 'temperatures': 'Temperature'}
    lines = ['set Plane state = ' + kinds.pop('plane_state', 'plane stress')]
    sections = {}
    for kind, content in kinds.items():
        if kind in lists:
            lines.append('set {} = {}'.format(kind.capitalize().replace('_', ' '), ', '.join(content)))
            sections.update({lists[kind] + ' ' + name: values for name, values in content.items()})
        else:
            sections[kind] = content
    for name, values in sections.items():
        lines.append('subsection ' + name)
        lines += ['  set {} = {}'.format(key, value) for key, value in values.items()]
        lines.append('end')
    return '\n'.join(lines) + '\n'


def write(name, content):
    path = new_path(name + '.prm')
    path.write_text(content)
    return path


def box(name='scene', **kinds):
    """Path of a .prm with the scene of text()."""
    return write(name, text(**kinds))


SOFT = {'Young modulus': '1000', 'Poisson ratio': '0.25'}
CUT = {'Method': 'METIS', 'Subdomains': '3'}
SYMMETRIC = {'left': {'Boundary': 'box/left', 'Displacement x': '0'},
             'foot': {'Boundary': 'box/bottom', 'Displacement y': '0'}}


def stretched(**kinds):
    """A box between two planes of symmetry, pulled with 10 MPa and then with 20."""
    return box('stretched', **{
        'materials': {'elastic': SOFT}, 'bodies': {'box': {'Size': '10, 10', 'Cells': '7, 6', 'Material': 'elastic'}},
        'supports': SYMMETRIC, 'tractions': {'pull': {'Boundary': 'box/right', 'Traction x': '10*t'}}, 'Decomposition': CUT,
        'Load steps': {'Factors': '1, 2'}, 'Solver': {'Tolerance': '1e-10'}, **kinds})
