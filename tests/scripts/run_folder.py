"""The folder of a run as slipstick writes it, small and with known contents: two bodies of one cell each, two load steps."""

import json

# Two squares of 1 mm side by side; the displacement along x is 0.1 t x, stress xx = 100 t, yy = 20 t, xy = 0 MPa.
POINTS = [(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (2, 0), (2, 1), (1, 1)]
FACTORS = (0.5, 1)

PARAMETERS = '''
set Title = squares
set Obstacles = floor
set Contacts = joint
set Supports = wall, tip
set Tractions = pull
subsection Obstacle floor
  set Shape = half plane
  set Point = 0, -0.01
  set Normal = 0, 1
end
subsection Support wall
  set Displacement x = 0
  set Displacement y = 0
end
subsection Support tip
  set Displacement x = free
  set Displacement y = 0.01*t
end
subsection Traction pull
  set Traction x = 100*t*(y > 0.4 ? 1 : 0)
  set Traction y = 0
  set Pressure = 0
end
subsection Contact joint
  set Offset = 0
  set Gap = geometry
end
subsection Load steps
  set Factors = 0.5, 1
end
'''

# A line across both squares and its end: what the fields above have there.
PROBES = 'step,t,probe,s,x,y,u_x,u_y,stress_xx,stress_yy,stress_xy,stress_zz,von_mises\n' + ''.join(
    '{0},{1},{2},{3},{4},0.5,{5},0,{6},{7},1e-14,0,{8}\n'.format(step, t, name, x - first, x, 0.1 * t * x, 100 * t, 20 * t, t * (10 + x))
    for step, t in enumerate(FACTORS) for name, first, places in (('across', 0, (0, 1, 2)), ('end', 2, (2, ))) for x in places)

CONDITIONS = '''kind,name,side,body,x1,y1,x2,y2
support,wall,,left,0,1,0,0
traction,pull,,right,2,0,2,1
support,tip,,right,2,1,2,1
contact,joint,slave,left,1,0,1,1
contact,joint,master,right,1,1,1,0
'''


def array(name, numbers, components=1, kind='Float32'):
    return '<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="ascii">{}</DataArray>\n'.format(
        kind, name, components, ' '.join(str(number) for number in numbers))


def grid(t, strain):
    flat = lambda rows: [number for row in rows for number in row]
    return ('<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="2">\n'
            '<Points>' + array('', flat((x, y, 0) for x, y in POINTS), 3) + '</Points>\n<Cells>' +
            array('connectivity', range(8), kind='Int32') + array('offsets', (4, 8), kind='Int32') +
            array('types', (9, 9), kind='UInt8') + '</Cells>\n<PointData>' +
            array('displacement', flat((strain * t * x, 0, 0) for x, y in POINTS), 3) +
            array('stress', flat((100 * t, 0, 0, 0, 20 * t, 0, 0, 0, 0) for _ in POINTS), 9) +
            array('stress_zz', [0] * 8) + array('von_mises', [t * (10 + x) for x, y in POINTS]) +
            '</PointData>\n<CellData>' + array('body', (0, 1)) + array('subdomain', (0, 1)) + '</CellData>\n'
            '</Piece></UnstructuredGrid></VTKFile>\n')


def write(folder, statuses=('stick', 'stick'), strain=0.1):
    """@p statuses of the two nodes of the only contact pair, in every step."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / 'parameters.prm').write_text(PARAMETERS)
    (folder / 'conditions.csv').write_text(CONDITIONS)
    rows = ['pair,slave body,x,y,s,gap,pressure,tangential_traction,slip,status,step,slip_bound']
    for step, t in enumerate(FACTORS):
        (folder / 'step{}.vtu'.format(step)).write_text(grid(t, strain))
        rows += ['joint,left,1,{0},{0},0,{1},{2},0,{3},{4},30'.format(y, 100 * t, 10 * y, statuses[y], step) for y in (0, 1)]
    (folder / 'solution.pvd').write_text('<VTKFile type="Collection"><Collection>{}</Collection></VTKFile>'.format(''.join(
        '<DataSet timestep="{}" file="step{}.vtu"/>'.format(t, step) for step, t in enumerate(FACTORS))))
    (folder / 'contact.csv').write_text('\n'.join(rows) + '\n')
    (folder / 'history.csv').write_text('step,t,traction pull Fx,traction pull Fy,traction pull moment\n'
                                        '0,0.5,30,0,-21\n1,1,60,0,-42\n')
    forces = lambda t: {'loads': [{'load': 'pull', 'kind': 'traction', 'force': [60 * t, 0], 'moment': -42 * t}],
                        'supports': [{'support': 'wall', 'force': [-60 * t, 0], 'moment': 42 * t},
                                     {'support': 'tip', 'force': [0, 0], 'moment': 0}], 'foundations': [],
                        'contact': [{'pair': 'joint', 'normal_force': 100 * t, 'tangential_force': 5 * t, 'force': [-100 * t, 0],
                                     'moment': 50 * t, 'max_pressure': 100 * t, 'contact_length': 1, 'contact_nodes': 2,
                                     'open_nodes': 0, 'stick_nodes': 2, 'slip_nodes': 0}],
                        'max_displacement': 0.2 * t, 'strain_energy': 3 * t * t}
    (folder / 'summary.json').write_text(json.dumps({
        'case': 'squares', 'version': '0', 'ranks': 1, 'status': 'converged', 'converged': True,
        'warnings': ['Contact joint: <something> & more'], 'problem': {'bodies': 2, 'subdomains': 2, 'primal_dofs': 16, 'cells': 2},
        'solver': {'algorithm': 'semismooth newton', 'tolerance': 1e-4, 'hessian_multiplications': 5}, 'residuals': {'force_balance': 1e-9},
        'error': {'estimate_energy_relative': 0.05, 'algebraic_relative': 1e-6},
        'results': {**forces(1), 'max_von_mises': 12}, 'steps': [{'load_factor': t, **forces(t)} for t in FACTORS],
        'time_s': {'total': 1.5, 'mesh': 0.5, 'solve': 0.75, 'other': 0.25}, 'memory_mb': {'peak_rank_max': 170, 'peak_total': 170}}))
    return folder


def write_solid(folder):
    """A cube of 1 mm in two load steps: the displacement along x is 0.1 t x, von Mises stress t (10 + y), principal stress 1 is 7 but for
    rounding."""
    folder.mkdir(parents=True, exist_ok=True)
    points = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    flat = lambda rows: [number for row in rows for number in row]
    (folder / 'parameters.prm').write_text('set Dimension = 3\n')
    for step, t in enumerate(FACTORS):
        (folder / 'step{}.vtu'.format(step)).write_text(
            '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="1">\n'
            '<Points>' + array('', flat(points), 3) + '</Points>\n<Cells>' + array('connectivity', range(8), kind='Int32') +
            array('offsets', (8,), kind='Int32') + array('types', (12,), kind='UInt8') + '</Cells>\n<PointData>' +
            array('displacement', flat((0.1 * t * x, 0, 0) for x, y, z in points), 3) +
            array('von_mises', [t * (10 + y) for x, y, z in points]) + array('principal_stress_1', [7 + 1e-7 * y for x, y, z in points]) +
            '</PointData>\n<CellData>' + array('body', (0,)) + '</CellData>\n</Piece></UnstructuredGrid></VTKFile>\n')
    (folder / 'solution.pvd').write_text('<VTKFile type="Collection"><Collection>{}</Collection></VTKFile>'.format(''.join(
        '<DataSet timestep="{}" file="step{}.vtu"/>'.format(t, step) for step, t in enumerate(FACTORS))))
    (folder / 'summary.json').write_text(json.dumps({
        'case': 'cube', 'problem': {'dimension': 3}, 'steps': [{'load_factor': t} for t in FACTORS]}))
    return folder
