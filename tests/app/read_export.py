#!/usr/bin/python3
"""read_export.py DATASET FORMAT PATH: reads an export as others would and compares it with the data set.

npz, pc2, obj, ply with Python; xdmf with ParaView's reader, under pvpython. The body is posed here once more, from the
contract's formulas alone. Prints the largest distance; exit status 1 where anything differs.
"""
import os
import struct
import sys

import h5py
import numpy as np

TOLERANCE = 2e-6  # float32 at the size of a body


def rotation(theta):
    angle = np.linalg.norm(theta)
    if angle == 0:
        return np.eye(4)
    x, y, z = theta / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(4)
    turn[:3, :3] += np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)
    return turn


def posed_body(data, pose):
    bind, parent = data["body/joint_bind"][:], data["body/joint_parent"][:]
    world = []
    for j, theta in enumerate(pose):
        local = bind[j] if parent[j] < 0 else np.linalg.inv(bind[parent[j]]) @ bind[j]
        world.append((np.eye(4) if parent[j] < 0 else world[parent[j]]) @ local @ rotation(theta))
    skin = np.array([g @ np.linalg.inv(b) for g, b in zip(world, bind)])
    rest = np.c_[data["body/rest_position"][:], np.ones(len(data["body/rest_position"]))]
    vertex, joint, value = (data["body/weight_" + name][:] for name in ("vertex", "joint", "value"))
    posed = np.zeros((len(rest), 3))
    np.add.at(posed, vertex, value[:, None] * np.einsum("nij,nj->ni", skin[joint][:, :3], rest[vertex]))
    return posed


class Expected:
    def __init__(self, path):
        self.data = h5py.File(path, "r")
        self.slot = np.flatnonzero(self.data["samples/status"][:] == 0)
        self.id = self.data["samples/id"][:][self.slot]
        self.cloth = self.data["samples/cloth"][:][self.slot]
        self.body = [posed_body(self.data, self.data["samples/pose"][s]) for s in self.slot]
        self.faces, self.body_faces = self.data["mesh/triangle"][:], self.data["body/triangle"][:]
        self.largest = 0.0

    def same(self, what, a, b):
        if np.shape(a) != np.shape(b):
            sys.exit(f"{what}: shape {np.shape(a)}, expected {np.shape(b)}")
        distance = float(np.max(np.abs(np.asarray(a, float) - np.asarray(b, float))))
        if not distance <= TOLERANCE:
            sys.exit(f"{what}: {distance} from the data set")
        self.largest = max(self.largest, distance)


def read_npz(path, want):
    with np.load(path) as z:
        want.same("vertices_seq", z["vertices_seq"], want.cloth)
        want.same("body_vertices_seq", z["body_vertices_seq"], want.body)
        want.same("faces", z["faces"], want.faces)
        want.same("body_faces", z["body_faces"], want.body_faces)
        want.same("uv", z["uv"], want.data["mesh/pattern_position"][:])
        want.same("uv_faces", z["uv_faces"], want.data["mesh/pattern_triangle"][:])
        want.same("id", z["id"], want.id)
        want.same("split", z["split"], want.data["samples/split"][:][want.slot])
        want.same("poses", z["poses"], want.data["samples/pose"][:][want.slot].reshape(len(want.id), -1))
        names = list(want.data["body/joint_name"][:])
        if list(z["joint_names"]) != names or z["vertices_seq"].dtype != np.float32 or z["faces"].dtype != np.int32:
            sys.exit("names or types differ")


def read_point_cache(path):
    with open(path, "rb") as file:
        magic, version, points, start, rate, samples = struct.unpack("<12siiffi", file.read(32))
        if magic != b"POINTCACHE2\0" or version != 1 or start != 0 or rate != 1:
            sys.exit(f"{path}: header")
        return np.frombuffer(file.read(), "<f4").reshape(samples, points, 3)


def read_obj(path):
    rows = {"v": [], "vt": [], "f": []}
    for line in open(path):
        word = line.split()
        if word[0] in rows:
            rows[word[0]].append(word[1:])
    corner = np.array([[[int(n) for n in c.split("/")] for c in f] for f in rows["f"]]) - 1
    return np.array(rows["v"], float), np.array(rows["vt"], float), corner


def read_ply(path):
    raw = open(path, "rb").read()
    head, body = raw.split(b"end_header\n", 1)
    vertices, faces = (int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element"))
    row = [("n", "u1"), ("v", "<i4", 3)]
    if b"texcoord" in head:
        row += [("m", "u1"), ("t", "<f4", 6)]
    position = np.frombuffer(body, "<f8", 3 * vertices).reshape(-1, 3)
    face = np.frombuffer(body, np.dtype(row), faces, 24 * vertices)
    if 24 * vertices + face.nbytes != len(body) or (face["n"] != 3).any():
        sys.exit(f"{path}: size")
    return position, face


def read_pc2(path, want):
    want.same("cloth.pc2", read_point_cache(os.path.join(path, "cloth.pc2")), want.cloth)
    want.same("body.pc2", read_point_cache(os.path.join(path, "body.pc2")), want.body)
    want.same("cloth.obj", read_obj(os.path.join(path, "cloth.obj"))[2][:, :, 0], want.faces)
    want.same("body.obj", read_obj(os.path.join(path, "body.obj"))[2][:, :, 0], want.body_faces)


def read_meshes(path, want, extension):
    pattern, pattern_faces = want.data["mesh/pattern_position"][:], want.data["mesh/pattern_triangle"][:]
    for k, number in enumerate(want.id):
        name = [os.path.join(path, f"{mesh}_{number:06d}{extension}") for mesh in ("cloth", "body")]
        if extension == ".obj":
            (cloth, uv, corner), (body, _, body_corner) = map(read_obj, name)
            want.same("vt", uv, pattern)
            want.same("texture corners", corner[:, :, 1], pattern_faces)
            faces, body_faces = corner[:, :, 0], body_corner[:, :, 0]
        else:
            (cloth, face), (body, body_face) = map(read_ply, name)
            want.same("texcoord", face["t"], pattern[pattern_faces].reshape(-1, 6))
            faces, body_faces = face["v"], body_face["v"]
        want.same(f"cloth of pose {number}", cloth, want.cloth[k])
        want.same(f"body of pose {number}", body, want.body[k])
        want.same("faces", faces, want.faces)
        want.same("body faces", body_faces, want.body_faces)


def read_xdmf(path, want):
    import paraview.servermanager as server
    from paraview.simple import XDMFReader
    from vtk.util.numpy_support import vtk_to_numpy

    reader = XDMFReader(FileNames=[path])
    reader.UpdatePipeline()
    want.same("times", list(reader.TimestepValues), want.id)
    order = list(range(len(want.id)))
    for k in order + order[::-1]:  # backwards too: a reader that keeps an old mesh is found out
        reader.UpdatePipeline(float(want.id[k]))
        scene = server.Fetch(reader)
        cloth, body = (scene.GetBlock(i) for i in range(2))
        want.same(f"cloth of pose {want.id[k]}", vtk_to_numpy(cloth.GetPoints().GetData()), want.cloth[k])
        want.same(f"body of pose {want.id[k]}", vtk_to_numpy(body.GetPoints().GetData()), want.body[k])
        displacement = vtk_to_numpy(cloth.GetPointData().GetArray("displacement"))
        want.same("displacement", displacement, want.data["samples/displacement"][want.slot[k]])
        number = {n: cloth.GetFieldData().GetArray(n).GetTuple(0)[0] for n in ("pose", "split", "status")}
        split = want.data["samples/split"][want.slot[k]]
        want.same("pose, split, status", [number[n] for n in ("pose", "split", "status")], [want.id[k], split, 0])
        for block, faces in ((cloth, want.faces), (body, want.body_faces)):
            cells = vtk_to_numpy(block.GetCells().GetConnectivityArray()).reshape(-1, 3)
            want.same("faces", cells, faces)


def main():
    dataset, kind, path = sys.argv[1:4]
    want = Expected(dataset)
    if kind == "npz":
        read_npz(path, want)
    elif kind == "pc2":
        read_pc2(path, want)
    elif kind == "xdmf":
        read_xdmf(path, want)
    else:
        read_meshes(path, want, "." + kind)
    print(f"{len(want.id)} samples, within {want.largest:.2g} m")


main()
