"""Whether the files of a run that converged show an answer: equilibrium of forces and moments, no tension, no penetration, no
pressure across a gap, friction within its bound, against the slip, and full where nodes slide. Nothing is taken from the program but
what it has written; places after loading are compared with the obstacles of the scene anew. Standard library only.
"""

import base64
import csv
import json
import math
import re
import struct
import xml.etree.ElementTree

BALANCE = 1e-3  # of the forces that act on the bodies


def settings_of(path):
    """{'Section/Name': value} of the parameters that a run has written."""
    settings, sections = {}, []
    for line in path.read_text(errors='replace').replace('\\\n', ' ').split('\n'):
        word, _, rest = line.strip().partition(' ')
        if word == 'subsection':
            sections.append(rest.strip())
        elif word == 'end' and sections:
            sections.pop()
        elif word == 'set' and '=' in rest:
            name, value = rest.split('=', 1)
            settings['/'.join(sections + [name.strip()])] = value.strip()
    return settings


def names_in(settings, key):
    return [name.strip() for name in settings.get(key, '').split(',') if name.strip()]


def number_in(settings, key):
    """None where it is a formula or a word."""
    try:
        return float(settings[key])
    except (KeyError, ValueError):
        return None


def vector_in(settings, key):
    return [float(part) for part in settings[key].split(',')]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def rows_of(path):
    with open(path, newline='') as stream:
        return [{key: float(value) if re.fullmatch(r'[-+0-9.einfa]+', value) and key not in ('pair', 'slave body', 'status')
                 else value for key, value in row.items()} for row in csv.DictReader(stream)]


def vectors_of(path):
    """Points, their displacements and numbers of pairs in a contact_NNN.vtp."""
    arrays = {}
    for array in xml.etree.ElementTree.parse(path).iter('DataArray'):
        data = base64.b64decode(array.text or '')
        kind = {'Float64': 'd', 'Int64': 'q'}[array.get('type')]
        values = struct.unpack('<{}{}'.format((len(data) - 8) // 8, kind), data[8:])
        n = int(array.get('NumberOfComponents'))
        arrays[array.get('Name')] = [values[i:i + n] for i in range(0, len(values), n)]
    return arrays


class Answer:

    def __init__(self, output):
        self.output = output
        self.summary = json.loads((output / 'summary.json').read_text())
        self.settings = settings_of(output / 'parameters.prm')
        self.results = self.summary['results']
        self.rows = rows_of(output / 'contact.csv') if (output / 'contact.csv').exists() else []
        self.is_solid = self.summary['problem']['dimension'] == 3
        self.obstacles = names_in(self.settings, 'Obstacles')
        self.displacement = self.results['max_displacement'] or 0
        # displacements below the rounding of coordinates are none
        self.displacement = max([self.displacement] + [1e-14 * abs(row[c]) for row in self.rows for c in 'xy'])
        self.stress = self.results['max_von_mises'] or 0
        # Residuals, of the largest force or displacement, that status 0 allows, and what they are beside single nodes.
        self.allowed = min(0.05, max(1e-3, 1000 * self.summary['solver']['tolerance']))
        self.part = max(1e-2, self.allowed)

    def problem(self):
        """'' when nothing is wrong."""
        if not self.summary['converged']:
            return 'status 0 of a run that did not converge'
        if any(value is None or value > self.allowed for value in self.summary['residuals'].values()):
            return 'status 0 with residuals ' + str(self.summary['residuals'])
        return self.balance() or self.contact() or self.places()

    def is_obstacle(self, pair):
        return self.settings.get('Contact {}/Master'.format(pair)) in self.obstacles

    def balance(self):
        """All that acts on the bodies from outside, relative to the sum of magnitudes, and to the rounding of stresses."""
        outside = [entry for kind in ('loads', 'supports', 'foundations') for entry in self.results.get(kind) or []]
        outside += [pair for pair in self.results.get('contact') or [] if self.is_obstacle(pair['pair'])]
        magnitude = sum(abs(c) for entry in outside for c in entry['force'])
        inside = [abs(c) for pair in self.results.get('contact') or [] for c in pair['force']]
        rounding = 1e-12 * max([self.stress] + [10 * force for force in inside])  # of stresses on 1 mm^2, of contact forces
        is_axisymmetric = self.summary['problem']['plane_state'] == 'axisymmetric'  # hoop stresses balance radial forces
        for components in list(zip(*(entry['force'] for entry in outside)))[is_axisymmetric:]:
            if abs(sum(components)) > BALANCE * sum(abs(c) for c in components) + 1e-6 * magnitude + rounding:
                return 'forces are out of balance: ' + str([entry['force'] for entry in outside])
        if is_axisymmetric:
            return ''
        moments = [entry['moment'] if self.is_solid else [entry['moment']] for entry in outside]
        lever = self.farthest()
        # The forces on the two sides of a pair that is not closed before loading act at different places.
        apart = sum(math.hypot(*(mismatch if self.is_solid else [mismatch])) for mismatch in
                    (pair['moment_mismatch'] for pair in self.results.get('contact') or [] if not self.is_obstacle(pair['pair'])))
        for components in zip(*moments):
            if abs(sum(components)) > BALANCE * (sum(abs(c) for c in components) + magnitude * lever) + rounding * lever + apart:
                return 'moments are out of balance: ' + str(moments)
        return ''

    def farthest(self):
        """Largest coordinate of a place where anything acts."""
        with open(self.output / 'conditions.csv', newline='') as stream:
            return max((abs(float(value)) for row in csv.DictReader(stream) for key, value in row.items()
                        if re.fullmatch('[xyz][1-4]', key or '') and value), default=0.)

    def contact(self):
        """What contact.csv says against the conditions of contact, relative to its largest numbers, which are rounding where they
        are a tiny part of the stress or of the displacements."""
        for step in sorted({row['step'] for row in self.rows}):
            for pair in sorted({row['pair'] for row in self.rows}):
                own = [row for row in self.rows if row['step'] == step and row['pair'] == pair]
                if not own or any(row['slip_bound'] == math.inf for row in own):  # bonded
                    continue
                largest = max(abs(row['pressure']) + abs(row['tangential_traction']) for row in own)
                if largest < 1e-5 * self.stress:
                    continue
                for row in own:
                    found = self.normal_laws(row, largest) or self.friction_laws(row, largest, pair)
                    if found:
                        return '{} at {}, {} of {} in step {}'.format(found, row['x'], row['y'], pair, step)
        return ''

    def normal_laws(self, row, largest):
        if row['pressure'] < -BALANCE * largest:
            return 'tension'
        if row['gap'] < -self.part * self.displacement:
            return 'penetration'
        if row['gap'] > self.part * self.displacement and row['pressure'] > self.part * largest:
            return 'pressure across a gap'
        return ''

    def friction_laws(self, row, largest, pair):
        traction, bound, slip = abs(row['tangential_traction']), row['slip_bound'], abs(row['slip'])
        if traction > bound + self.part * largest:
            return 'friction beyond its bound'
        law, prefix = self.settings.get('Contact {}/Law'.format(pair)), 'Contact {}/'.format(pair)
        coefficient, cohesion = (number_in(self.settings, prefix + key) for key in ('Friction coefficient', 'Cohesion'))
        if law == 'Coulomb' and coefficient is not None and cohesion in (None, 0.):
            if traction > coefficient * max(0., row['pressure']) + self.part * largest * max(1., coefficient):
                return 'friction beyond the coefficient of the scene'
        constant = number_in(self.settings, prefix + 'Slip bound')
        if law == 'Tresca' and constant is not None and traction > constant + self.part * largest:
            return 'friction beyond the slip bound of the scene'
        if law == 'frictionless' and traction > self.part * largest:
            return 'friction without a law'
        power = dot([row['traction_' + c] for c in 'xyz'], [row['slip_' + c] for c in 'xyz']) if self.is_solid \
            else row['tangential_traction'] * row['slip']
        if power > self.part * largest * self.displacement:
            return 'friction along the slip'
        if law == 'Coulomb' and slip > self.part * self.displacement and row['pressure'] > self.part * largest \
                and traction < bound - 2 * self.part * largest:
            return 'slip below the bound of friction'
        if self.is_solid and abs(dot([row['traction_' + c] for c in 'xyz'], [row['normal_' + c] for c in 'xyz'])) > self.part * largest:
            return 'friction along the normal'
        return ''

    def places(self):
        """Contact nodes after the last step against the obstacles of the scene."""
        files = sorted(self.output.glob('contact_*.vtp'))
        if not files or not self.rows:
            return ''
        arrays = vectors_of(files[-1])
        pairs = names_in(self.settings, 'Contacts')
        if 'displacement' not in arrays:
            return ''
        for x, u, (k,) in zip(arrays['Points'], arrays['displacement'], arrays['pair']):
            pair = pairs[k] if k < len(pairs) else ''
            prefix = 'Contact {}/'.format(pair)
            if (not self.is_obstacle(pair) or self.settings.get(prefix + 'Law') == 'bonded' or
                    number_in(self.settings, prefix + 'Offset') != 0 or self.settings.get(prefix + 'Gap') != 'geometry'):
                continue
            depth, radius = self.depth([a + b for a, b in zip(x, u)], self.settings[prefix + 'Master'])
            away = math.sqrt(dot(u, u))
            if depth > self.part * self.displacement + away * away / radius + 1e-9 * math.sqrt(dot(x, x)):
                return 'after loading ({:g}, {:g}, {:g}) is {:g} mm inside of {}'.format(*x, depth, self.settings[prefix + 'Master'])
        return ''

    def depth(self, x, obstacle):
        """Of a place inside of an obstacle, and the obstacle's radius; of other shapes no depth."""
        prefix = 'Obstacle {}/'.format(obstacle)
        shape = self.settings.get(prefix + 'Shape')
        if shape in ('half plane', 'half space'):
            normal, point = vector_in(self.settings, prefix + 'Normal'), vector_in(self.settings, prefix + 'Point')
            return -dot([a - b for a, b in zip(x, point)], normal) / math.sqrt(dot(normal, normal)), math.inf
        if shape in ('circle', 'hole', 'ball', 'hollow ball'):
            center, radius = vector_in(self.settings, prefix + 'Center'), number_in(self.settings, prefix + 'Radius')
            distance = math.sqrt(sum((a - b) ** 2 for a, b in zip(x, center)))
            return (radius - distance if shape in ('circle', 'ball') else distance - radius), radius
        return -math.inf, math.inf


def problem_of(output):
    """What is wrong with the answer in this output directory, '' when nothing is."""
    return Answer(output).problem()
