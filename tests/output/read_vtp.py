"""Prints what VTK reads in a contact_NNN.vtp, for tests/output/contact_line.cc. Status 77: no VTK here."""

import sys

try:
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
    sys.exit(77)

reader = vtkXMLPolyDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
if reader.GetErrorCode():
    sys.exit(1)
data = reader.GetOutput()
print("points", data.GetNumberOfPoints(), "verts", data.GetNumberOfVerts(), "lines", data.GetNumberOfLines())
for cell in range(data.GetNumberOfCells()):
    points = data.GetCell(cell).GetPointIds()
    print("cell", *(points.GetId(i) for i in range(points.GetNumberOfIds())))
for i in range(data.GetNumberOfPoints()):
    values = [data.GetPointData().GetArray(name).GetTuple1(i) for name in ("s", "pressure", "status")]
    print("point", *data.GetPoint(i), *values)
