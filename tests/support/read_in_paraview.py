"""What ParaView finds in a series of files, as JSON: `pvbatch read_in_paraview.py around.pvd`."""

import json
import sys


def main(file):
    from paraview.simple import IntegrateVariables, OpenDataFile, UpdatePipeline

    reader = OpenDataFile(file)
    times = list(reader.TimestepValues)
    UpdatePipeline(time=times[-1], proxy=reader)
    data = reader.GetPointDataInformation()
    arrays = [data.GetArray(n) for n in range(data.GetNumberOfArrays())]
    whole = IntegrateVariables(Input=reader)
    UpdatePipeline(time=times[-1], proxy=whole)
    area = whole.GetCellDataInformation().GetArray("Area").GetRange()[0]
    return {"times": times, "ranges": {array.Name: array.GetRange() for array in arrays}, "area": area}


if __name__ == "__main__":
    print(json.dumps(main(sys.argv[1])))
