#!/usr/bin/python3
"""The program's readers against others: VTK's where it has one, exrheader, and readers of numpy's below.

usage: readers_test.py FACTS [FILE...]

FACTS is the program of facts.cpp. Without files it compares those of assets/ that are there and such as it writes
itself, whose content it knows. Status 1: a file is read differently. Status 77: numpy, VTK's module or exrheader is missing.
"""
import gzip
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

try:
    import numpy as np
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
except ImportError as error:
    print(f"skipped: {error} (Debian packages python3-numpy and python3-vtk9)")
    sys.exit(77)
if shutil.which("exrheader") is None:
    print("skipped: there is no exrheader (Debian package openexr)")
    sys.exit(77)

ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
vtk.vtkObject.GlobalWarningDisplayOff()


# ---- facts: what is compared ----


def mesh_facts(corners):
    """Of triangles: an array of n × 3 corners × 3 coordinates."""
    corners = np.asarray(corners, float)
    middle = corners.reshape(-1, 3).mean(0)
    a, b, c = (corners - middle).transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    flat = corners.reshape(-1, 3)
    return {
        "triangles": len(corners),
        "low": flat.min(0).tolist(),
        "high": flat.max(0).tolist(),
        "area": area.sum(),
        "moment": (area[:, None] * corners.mean(1)).sum(0).tolist(),
    }


def weighted(values):
    values = values.astype(float).ravel()
    return float((values * (np.arange(values.size) % 1009 + 1)).sum())


def volume_facts(values, spacing):
    """Of an array by z, y, x."""
    return {
        "size": list(values.shape[::-1]),
        "spacing": [float(s) for s in spacing],
        "range": [float(values.min()), float(values.max())],
        "sum": float(values.astype(float).sum()),
        "weighted": weighted(values),
    }


def picture_facts(pixels):
    """Of an array by row, column, channel."""
    planes = [pixels[:, :, c].astype(float) for c in range(pixels.shape[2])]
    return {
        "size": [pixels.shape[1], pixels.shape[0]],
        "sum": [float(plane.sum()) for plane in planes],
        "weighted": [weighted(plane) for plane in planes],
    }


# ---- other readers ----


def triangles_of(algorithm):
    """Triangles as VTK sees them; fans of larger faces, as the program cuts convex ones."""
    algorithm.Update()
    data = algorithm.GetOutput()
    if data.GetNumberOfStrips() > 0:
        triangulate = vtk.vtkTriangleFilter()
        triangulate.SetInputData(data)
        triangulate.Update()
        data = triangulate.GetOutput()
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    corners, ids = [], vtk.vtkIdList()
    polys = data.GetPolys()
    polys.InitTraversal()
    while polys.GetNextCell(ids):
        face = [ids.GetId(i) for i in range(ids.GetNumberOfIds())]
        corners += [points[[face[0], face[i], face[i + 1]]] for i in range(1, len(face) - 1)]
    return mesh_facts(corners)


def read_gltf(path):
    reader = vtk.vtkGLTFReader()
    reader.SetFileName(path)
    reader.Update()
    surface = vtk.vtkCompositeDataGeometryFilter()
    surface.SetInputConnection(reader.GetOutputPort())
    return triangles_of(surface)


def read_off(path):
    text = "\n".join(line.split("#")[0] for line in open(path, errors="replace"))
    words = text.replace("OFF", "OFF ", 1).split()
    if not words[0].isdigit():
        words = words[1:]
    numbers = np.array([float(word) for word in words])
    vertices, faces = int(numbers[0]), int(numbers[1])
    points = numbers[3 : 3 + 3 * vertices].reshape(-1, 3)
    rest, corners = numbers[3 + 3 * vertices :].astype(int), []
    at = 0
    for _ in range(faces):
        face = rest[at + 1 : at + 1 + rest[at]]
        at += 1 + rest[at]
        corners += [points[[face[0], face[i], face[i + 1]]] for i in range(1, len(face) - 1)]
    return mesh_facts(corners)


def read_3ds(path):
    """Objects with their vertices and faces, without keyframes; z points up in the file."""
    data, corners = open(path, "rb").read(), []

    def walk(at, end, points):
        while at + 6 <= end:
            kind, length = struct.unpack_from("<HI", data, at)
            if kind in (0x4D4D, 0x3D3D, 0x4100):
                points = walk(at + 6, at + length, points)
            elif kind == 0x4000:
                walk(data.index(b"\0", at + 6) + 1, at + length, None)
            elif kind == 0x4110:
                (count,) = struct.unpack_from("<H", data, at + 6)
                raw = np.frombuffer(data, "<f4", 3 * count, at + 8).reshape(-1, 3).astype(float)
                points = raw[:, [0, 2, 1]] * [1, 1, -1]
            elif kind == 0x4120:
                (count,) = struct.unpack_from("<H", data, at + 6)
                faces = np.frombuffer(data, "<u2", 4 * count, at + 8).reshape(-1, 4)[:, :3]
                corners.extend(points[faces])
            at += length
        return points

    walk(0, len(data), None)
    return mesh_facts(corners)


def read_image_data(reader, path):
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    array = image.GetPointData().GetScalars() or image.GetPointData().GetArray(0)
    size = list(image.GetDimensions())
    if array is None:
        array = image.GetCellData().GetArray(0)
        size = [n - 1 for n in size]
    return volume_facts(vtk_to_numpy(array).reshape(size[::-1]), image.GetSpacing())


def read_inr(path):
    data = open(path, "rb").read()
    header = dict(line.split("=", 1) for line in data[:256].decode().split("\n") if "=" in line)
    kinds = {"float": "f", "unsigned fixed": "u", "signed fixed": "i"}
    order = ">" if header["CPU"] in ("sun", "sgi") else "<"
    kind = order + kinds[header["TYPE"]] + str(int(header["PIXSIZE"].split()[0]) // 8)
    values = np.frombuffer(data[256:], kind).reshape([int(header[axis + "DIM"]) for axis in "ZYX"])
    return volume_facts(values, [float(header["V" + axis]) for axis in "XYZ"])


def read_png(path):
    reader = vtk.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars())
    full = np.iinfo(pixels.dtype).max
    width, height, _ = image.GetDimensions()
    return picture_facts(pixels.reshape(height, width, -1)[::-1] / full)


def read_exr(path):
    """exrheader's windows; the values, too, of one part of scan lines that are not compressed or by zlib."""
    text = subprocess.run(["exrheader", path], capture_output=True, text=True, errors="replace", check=True).stdout
    windows = {}
    for line in text.split("\n"):
        if line.startswith(("dataWindow", "displayWindow")):
            numbers = [int(word) for word in line.split(":")[1].replace("(", " ").replace(")", " ").replace("-", " -").split() if word != "-"]
            windows["data_window" if line.startswith("data") else "display_window"] = numbers
    low, high = windows["display_window"][:2], windows["display_window"][2:]
    facts = {"size": [high[0] - low[0] + 1, high[1] - low[1] + 1], **windows}
    blocks = [n for name, n in (("none", 1), ("zip, individual", 1), ("zip, multi", 16)) if f"(type compression): {name}" in text]
    if len(blocks) == 1 and "chromaticities" not in text and "partType" not in text and "tiles (" not in text:
        facts.update(picture_facts(exr_values(open(path, "rb").read(), windows, blocks[0])))
    return facts


def exr_values(data, windows, rows_of_block):
    """The display window's R, G, B (and A), after "Technical Introduction to OpenEXR" and "The OpenEXR File Layout"."""
    at, channels = 8, []
    while data[at]:
        name_end = data.index(b"\0", at)
        type_end = data.index(b"\0", name_end + 1)
        (length,) = struct.unpack_from("<i", data, type_end + 1)
        value = data[type_end + 5 : type_end + 5 + length]
        if data[at:name_end] == b"channels":
            while value[0]:
                name, rest = value.split(b"\0", 1)
                channels.append((name.decode(), {0: "<u4", 1: "<f2", 2: "<f4"}[struct.unpack_from("<i", rest)[0]]))
                value = rest[16:]
        at = type_end + 5 + length
    x0, y0, x1, y1 = windows["data_window"]
    planes = {name: np.zeros((y1 - y0 + 1, x1 - x0 + 1)) for name, _ in channels}
    row_bytes = sum(np.dtype(kind).itemsize for _, kind in channels) * (x1 - x0 + 1)
    count = -(-(y1 - y0 + 1) // rows_of_block)
    for offset in struct.unpack_from(f"<{count}Q", data, at + 1):
        first, length = struct.unpack_from("<ii", data, offset)
        rows = min(rows_of_block, y1 - first + 1)
        block = data[offset + 8 : offset + 8 + length]
        if length < rows * row_bytes:
            # Differences of bytes, whose even and odd ones lie in two halves.
            sums = np.frombuffer(zlib.decompress(block), np.uint8).astype(int)
            sums[1:] -= 128
            plain = (np.cumsum(sums) % 256).astype(np.uint8)
            half, mixed = (len(plain) + 1) // 2, np.empty_like(plain)
            mixed[0::2], mixed[1::2] = plain[:half], plain[half:]
            block = mixed.tobytes()
        position = 0
        for row in range(first - y0, first - y0 + rows):
            for name, kind in channels:
                planes[name][row] = np.frombuffer(block, kind, x1 - x0 + 1, position)
                position += np.dtype(kind).itemsize * (x1 - x0 + 1)
    left, top, right, bottom = windows["display_window"]
    names = [name for name in "RGBA" if name in planes] or ["Y"]
    out = np.zeros((bottom - top + 1, right - left + 1, len(names)))
    for c, name in enumerate(names):
        for y in range(max(top, y0), min(bottom, y1) + 1):
            a, b = max(left, x0), min(right, x1)
            out[y - top, a - left : b - left + 1, c] = planes[name][y - y0, a - x0 : b - x0 + 1]
    return out


def vtk_reader(kind):
    def read(path):
        reader = kind()
        reader.SetFileName(path)
        return triangles_of(reader)

    return read


READERS = {
    ".ply": vtk_reader(vtk.vtkPLYReader),
    ".obj": vtk_reader(vtk.vtkOBJReader),
    ".gltf": read_gltf,
    ".glb": read_gltf,
    ".off": read_off,
    ".3ds": read_3ds,
    ".vti": lambda path: read_image_data(vtk.vtkXMLImageDataReader(), path),
    ".mhd": lambda path: read_image_data(vtk.vtkMetaImageReader(), path),
    ".mha": lambda path: read_image_data(vtk.vtkMetaImageReader(), path),
    ".inr": read_inr,
    ".png": read_png,
    ".exr": read_exr,
}


def independent_facts(path):
    """In a process of its own: some of the others crash on files that the program reads."""
    reader = READERS.get(pathlib.Path(path).suffix.lower())
    if reader is None:
        return {"error": "there is no other reader"}
    source, sink = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            result = reader(path)
        except Exception as error:  # whatever it is, the other reader did not read the file
            result = {"error": f"{type(error).__name__}: {error}"}
        os.write(sink, json.dumps(result).encode())
        os._exit(0)
    os.close(sink)
    with os.fdopen(source) as pipe:
        text = pipe.read()
    os.waitpid(child, 0)
    return json.loads(text) if text else {"error": "the other reader crashed"}


# ---- files whose content is known ----


def write_meshes(folder):
    sphere = vtk.vtkSphereSource()
    sphere.SetThetaResolution(24)
    sphere.SetPhiResolution(13)
    sphere.SetCenter(1, -2, 0.5)
    sphere.Update()
    expected = triangles_of(sphere)
    for name, order, kind in (("ascii", 0, 1), ("little", 1, 2), ("big", 0, 2)):
        writer = vtk.vtkPLYWriter()
        writer.SetInputConnection(sphere.GetOutputPort())
        writer.SetDataByteOrder(order)
        writer.SetFileType(kind)
        writer.SetFileName(str(folder / f"{name}.ply"))
        writer.Write()
        yield folder / f"{name}.ply", expected
    writer = vtk.vtkOBJWriter()
    writer.SetInputConnection(sphere.GetOutputPort())
    writer.SetFileName(str(folder / "sphere.obj"))
    writer.Write()
    yield folder / "sphere.obj", expected

    points = vtk_to_numpy(sphere.GetOutput().GetPoints().GetData()).astype("<f4")
    faces = vtk_to_numpy(sphere.GetOutput().GetPolys().GetConnectivityArray()).astype("<u2")
    buffer = points.tobytes() + faces.tobytes()
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [1, 2, 3], "scale": [1, 2, -1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(buffer), "uri": "sphere.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": points.nbytes}, {"buffer": 0, "byteOffset": points.nbytes, "byteLength": faces.nbytes}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", "min": points.min(0).tolist(), "max": points.max(0).tolist()},
            {"bufferView": 1, "componentType": 5123, "count": len(faces), "type": "SCALAR"},
        ],
    }
    (folder / "sphere.bin").write_bytes(buffer)
    (folder / "sphere.gltf").write_text(json.dumps(document))
    placed = mesh_facts((points.astype(float) * [1, 2, -1] + [1, 2, 3])[faces.reshape(-1, 3)])
    yield folder / "sphere.gltf", placed


def write_volumes(folder):
    random = np.random.default_rng(1)
    spacing = (0.25, 0.5, 2.0)
    for number, kind in enumerate(("f4", "f8", "u1", "i1", "u2", "i2", "i4")):
        low, high = (-3, 3) if kind[0] == "f" else (np.iinfo(kind).min, np.iinfo(kind).max)
        values = (random.random((5, 6, 7)) * (high - low) + low).astype(kind)
        expected = volume_facts(values, spacing)
        image = vtk.vtkImageData()
        image.SetDimensions(7, 6, 5)
        image.SetSpacing(spacing)
        image.SetOrigin(100, 0, -3)
        array = numpy_to_vtk(values.ravel(), deep=True)
        array.SetName("density")
        image.GetPointData().SetScalars(array)
        writer = vtk.vtkXMLImageDataWriter()
        writer.SetInputData(image)
        writer.SetFileName(str(folder / f"{kind}.vti"))
        writer.SetDataMode(number % 3)  # ASCII, base64, appended
        if number % 2 == 0:
            writer.SetCompressorTypeToNone()
        writer.Write()
        yield folder / f"{kind}.vti", expected
        writer = vtk.vtkMetaImageWriter()
        writer.SetInputData(image)
        writer.SetFileName(str(folder / f"{kind}.mhd"))
        writer.SetRAWFileName(str(folder / f"{kind}.raw"))
        writer.SetCompression(number % 2 == 0)
        writer.Write()
        yield folder / f"{kind}.mhd", expected
        names = {"f4": "float", "f8": "double", "u1": "uchar", "i1": "int8", "u2": "ushort", "i2": "short", "i4": "int"}
        encoding = ("raw", "gzip", "ascii", "hex")[number % 4]
        order = "<>"[number // 4]
        raw = values.astype(order + kind).tobytes()
        stored = {
            "raw": lambda: raw,
            "gzip": lambda: gzip.compress(raw),
            "ascii": lambda: "\n".join(repr(v) for v in values.ravel().tolist()).encode(),
            "hex": lambda: raw.hex().encode(),
        }[encoding]()
        header = f"NRRD0004\ntype: {names[kind]}\ndimension: 3\nsizes: 7 6 5\nspacings: 0.25 0.5 2\nencoding: {encoding}\n"
        header += f"endian: {'little' if order == '<' else 'big'}\n\n"
        (folder / f"{kind}.nrrd").write_bytes(header.encode() + stored)
        yield folder / f"{kind}.nrrd", expected


def write_pictures(folder):
    random = np.random.default_rng(2)
    for channels, kind in ((1, np.uint8), (3, np.uint8), (4, np.uint8), (3, np.uint16)):
        pixels = (random.random((9, 12, channels)) * np.iinfo(kind).max).astype(kind)
        image = vtk.vtkImageData()
        image.SetDimensions(12, 9, 1)
        image.GetPointData().SetScalars(numpy_to_vtk(pixels[::-1].reshape(-1, channels), deep=True))
        path = folder / f"{channels}_{np.dtype(kind).itemsize}.png"
        writer = vtk.vtkPNGWriter()
        writer.SetInputData(image)
        writer.SetFileName(str(path))
        writer.Write()
        yield path, picture_facts(pixels / np.iinfo(kind).max)


# ---- the comparison ----


def differences(ours, other):
    for key, value in other.items():
        if key not in ours:
            yield f"{key}: ours has none"
            continue
        # Positions are 32-bit numbers about the mesh's middle, pixels 32-bit numbers; sums are taken in another order.
        scale = max(np.abs(other["low"]).max(), np.abs(other["high"]).max()) if key in ("low", "high") else np.abs(value).max()
        tolerance = 0 if key in ("size", "triangles", "range", "data_window", "display_window") else 2e-6 * scale
        if key == "moment":
            tolerance = 2e-6 * other["area"] * max(np.abs(other["low"]).max(), np.abs(other["high"]).max())
        if np.shape(ours[key]) != np.shape(value) or not np.all(np.abs(np.subtract(ours[key], value)) <= tolerance):
            yield f"{key}: ours {ours[key]}, other {value}"


def main():
    folder = tempfile.TemporaryDirectory()
    made = pathlib.Path(folder.name)
    known = {}
    files = sys.argv[2:]
    if not files:
        files = [p for p in sorted(ASSETS.glob("*/*")) if p.suffix in READERS]
        for write in (write_meshes, write_volumes, write_pictures):
            known.update({str(path): facts for path, facts in write(made)})
    files = [str(path) for path in files] + list(known)
    lines = subprocess.run([sys.argv[1], *files], capture_output=True, text=True, check=True).stdout.split("\n")
    counts = {"same": 0, "differs": 0, "refused by both": 0, "read by one only": 0}
    for path, line in zip(files, lines):
        ours = json.loads(line)
        others = [known[path]] if path in known else []
        if not others or pathlib.Path(path).suffix.lower() in READERS:
            others.insert(0, independent_facts(path))
        found = []
        if "error" in ours and "error" in others[0]:
            verdict = "refused by both"
        elif "error" in ours or "error" in others[0]:
            verdict = "read by one only"
            found = [f"ours: {ours.get('error', 'read')}", f"other: {others[0].get('error', 'read')}"]
        else:
            found = [difference for facts in others for difference in differences(ours, facts)]
            verdict = "differs" if found else "same"
        counts[verdict] += 1
        print(f"{verdict}: {path}" + "".join(f"\n    {text}" for text in found))
    print(", ".join(f"{count} {verdict}" for verdict, count in counts.items()))
    wrong = counts["differs"] + (counts["read by one only"] + counts["refused by both"] if known else 0)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
