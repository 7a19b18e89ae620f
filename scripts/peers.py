#!/usr/bin/env python3
"""Runs other programs on problems of docs/verification/work-precision and writes peers.csv there.

    apt-get install calculix-ccx time        # CalculiX 2.20
    scripts/peers.py

Meshes, loads and the measured quantity are those of the problems (crates/verification/src/verify/work_precision/problems); errors are relative to the same references. `cargo xtask verify work-precision` draws what is
in the file. One thread; CPU seconds are those of the whole process.
"""
import csv
import math
import os
import pathlib
import re
import subprocess
import tempfile

HOME = pathlib.Path(__file__).resolve().parent.parent / "docs/verification/work-precision"

# Corners and middles of the edges of a hexahedron in CalculiX's order, in halves of its size.
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
MIDDLES = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
           (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]


class Mesh:
    """A block of n[0] x n[1] x n[2] hexahedra, whose unit cube `place` maps. Nodes are numbered from `first`."""

    def __init__(self, n, place, quadratic, first=1, first_element=1):
        self.n, self.quadratic, self.first_element = n, quadratic, first_element
        pattern = CORNERS + (MIDDLES if quadratic else [])
        self.number, self.elements = {}, []
        for k in range(n[2]):
            for j in range(n[1]):
                for i in range(n[0]):
                    of = [(2 * i + a, 2 * j + b, 2 * k + c) for a, b, c in pattern]
                    self.elements.append([self.number.setdefault(node, first + len(self.number)) for node in of])
        self.place = {}
        for (i, j, k), number in self.number.items():
            # A node on an edge is in its middle, as in the problems: cells stay straight.
            ends = [(2 * (x // 2), 2 * ((x + 1) // 2)) for x in (i, j, k)]
            points = [place(a / (2 * n[0]), b / (2 * n[1]), c / (2 * n[2]))
                      for a, b, c in ((ends[0][0], ends[1][0], ends[2][0]), (ends[0][1], ends[1][1], ends[2][1]))]
            self.place[number] = [0.5 * (p + q) for p, q in zip(*points)]

    def side(self, axis, end):
        """Nodes of a side of the block: axis 0, 1, 2 at its start (0) or end (1)."""
        at = 2 * self.n[axis] * end
        return sorted(number for key, number in self.number.items() if key[axis] == at)

    def loads(self, axis, end, force):
        """Consistent forces of a uniform traction whose sum is `force`, for sides that are flat, of facets of one size."""
        shares = {}
        at = 2 * self.n[axis] * end
        weights = lambda middle: (1 / 3 if middle else -1 / 12) if self.quadratic else 1 / 4
        for nodes in self.elements:
            for number in nodes:
                key = self.key[number]
                if key[axis] == at:
                    middle = any(x % 2 for x in key)
                    shares[number] = shares.get(number, 0.0) + weights(middle)
        total = sum(shares.values())
        return {number: force * share / total for number, share in shares.items()}

    @property
    def key(self):
        if not hasattr(self, "_key"):
            self._key = {number: key for key, number in self.number.items()}
        return self._key

    def deck(self, kind, name):
        lines = ["*NODE"] + ["%d, %.15g, %.15g, %.15g" % (n, *x) for n, x in sorted(self.place.items())]
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for k, nodes in enumerate(self.elements):
            row = [self.first_element + k] + nodes
            lines += [", ".join(map(str, row[i:i + 10])) + ("," if i + 10 < len(row) else "") for i in range(0, len(row), 10)]
        return lines


def listed(numbers):
    return [", ".join(map(str, numbers[i:i + 12])) for i in range(0, len(numbers), 12)]


def calculix(lines):
    """CPU seconds, peak memory in MB, and the vectors that were printed: by quantity and time (three digits), then node."""
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "job.inp").write_text("\n".join(lines) + "\n")
        environment = dict(os.environ, OMP_NUM_THREADS="1", CCX_NPROC_STIFFNESS="1", CCX_NPROC_RESULTS="1", CCX_NPROC_EQUATION_SOLVER="1")
        # A process begins with the peak of the one that starts it: GNU time's is small.
        status = subprocess.call(["/usr/bin/time", "-f", "%U %S %M", "-o", "cost", "ccx", "job"], cwd=folder, env=environment,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        user, system, memory = map(float, (pathlib.Path(folder) / "cost").read_text().split()[-3:])
        text = (pathlib.Path(folder) / "job.dat").read_text()
    found = {}
    for line in text.splitlines():
        head = re.match(r"\s*(\w+) \(.*\).* time\s+(\S+)", line)
        words = line.split()
        if head:
            rows = found.setdefault((head.group(1), round(float(head.group(2)), 6)), {})
        elif len(words) == 4:
            rows[int(words[0])] = [float(word) for word in words[1:]]
    if status or not found:
        raise RuntimeError("ccx did not end well")
    # The clock has two digits.
    return max(user + system, 0.01), memory / 1024, found


def neo_hooke(mu, bulk):
    return ["*MATERIAL, NAME=M", "*HYPERELASTIC, NEO HOOKE", f"{mu / 2:.15g}, {2 / bulk:.15g}"]


def step(size, loads):
    return ["*STEP, NLGEOM, INC=1000", "*STATIC, DIRECT", f"{size}, 1.", *loads, "*NODE PRINT, NSET=P", "U", "*END STEP"]


def node_set(name, numbers):
    return [f"*NSET, NSET={name}", *listed(numbers)]


def distance(a, b):
    return math.sqrt(sum((x - y) ** 2 for x, y in zip(a, b)) / sum(y * y for y in b))


def reference(problem):
    return {row[0]: [float(x) for x in row[1:]] for row in csv.reader(open(HOME / f"{problem}-reference.csv"))}


def cook(kind, n):
    def place(x, y, z):
        return [48 * x, (44 + 16 * x) * y + 44 * x * (1 - y), z]

    mesh = Mesh([n, n, 1], place, kind.startswith("C3D20"))
    corner = next(number for number, x in mesh.place.items() if max(abs(a - b) for a, b in zip(x, (48, 60, 0))) < 1e-9)
    mu, lame = 80.1938, 400942.0
    loads = ["*CLOAD"] + [f"{node}, 2, {force:.15g}" for node, force in mesh.loads(0, 1, 100.0).items()]
    lines = [*mesh.deck(kind, "E"), *node_set("ALL", sorted(mesh.place)), *node_set("LEFT", mesh.side(0, 0)), *node_set("P", [corner]),
             *neo_hooke(mu, lame + 2 / 3 * mu), "*SOLID SECTION, ELSET=E, MATERIAL=M", "*BOUNDARY", "ALL, 3, 3", "LEFT, 1, 2",
             *step(0.2, loads)]
    seconds, memory, found = calculix(lines)
    return seconds, memory, [distance(found["displacements", 1.0][corner][:2], reference("cook")["displacement of the corner"])]


def tied_bars(kind, n):
    finer = n + (n + 1) // 2
    quadratic = kind.startswith("C3D20")

    def bar(start):
        return lambda x, y, z: [start + 4 * x, 0.5 * y, z]

    root = Mesh([2 * n, (n + 1) // 2, n], bar(0), quadratic)
    arm = Mesh([2 * finer, (finer + 1) // 2, finer], bar(4), quadratic, first=len(root.place) + 1, first_element=len(root.elements) + 1)
    at = lambda mesh, place: next(number for number, x in mesh.place.items() if max(abs(a - b) for a, b in zip(x, place)) < 1e-9)
    tip, middle = at(arm, (8, 0, 1)), at(root, (4, 0, 1))
    faces = lambda mesh, name, i: [f"*SURFACE, NAME={name}"] + [
        f"{mesh.first_element + k}, {face}" for k in range(len(mesh.elements)) for face in [["S6", "S4"][i]] if k % mesh.n[0] == [0, mesh.n[0] - 1][i]]
    loads = ["*CLOAD"] + [f"{node}, 3, {force:.15g}" for node, force in arm.loads(0, 1, -0.25).items()]
    young, nu = 1000.0, 0.3
    lines = [*root.deck(kind, "R"), *arm.deck(kind, "A"), *node_set("LEFT", root.side(0, 0)), *node_set("FRONT", root.side(1, 0) + arm.side(1, 0)),
             *node_set("P", [tip, middle]), *faces(arm, "SLAVE", 0), *faces(root, "MASTER", 1),
             *neo_hooke(young / 2 / (1 + nu), young / 3 / (1 - 2 * nu)), "*SOLID SECTION, ELSET=R, MATERIAL=M", "*SOLID SECTION, ELSET=A, MATERIAL=M",
             "*TIE, NAME=T, POSITION TOLERANCE=0.01", "SLAVE, MASTER", "*BOUNDARY", "LEFT, 1, 3", "FRONT, 2, 2", *step(0.25, loads)]
    seconds, memory, found = calculix(lines)
    return seconds, memory, [distance(found["displacements", 1.0][tip][::2], reference("tied-bars")["displacement of the tip"])]


def bar_impact(kind, n):
    """Penalty of 50 moduli an element, 192 steps and more where the program cuts them, and its own damping of high frequencies (alpha = -0.05)."""
    wide, speed, start, end = 1 / n, 1e-4, 0.5, 3.0
    bar = Mesh([1, 1, n], lambda x, y, z: [wide * x, wide * y, speed * start + z], False)
    wall = Mesh([1, 1, 1], lambda x, y, z: [2 * x - 1, 2 * y - 1, z - 1], False, first=len(bar.place) + 1, first_element=n + 1)
    lines = [*bar.deck(kind, "BAR"), *wall.deck(kind, "WALL"), *node_set("P", sorted(bar.place)), *node_set("W", sorted(wall.place)),
             "*SURFACE, NAME=SLAVE", "1, S1", "*SURFACE, NAME=MASTER", f"{n + 1}, S2", "*MATERIAL, NAME=M", "*ELASTIC", "1., 0.", "*DENSITY", "1.",
             "*SOLID SECTION, ELSET=BAR, MATERIAL=M", "*SOLID SECTION, ELSET=WALL, MATERIAL=M",
             "*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{50 * n}., 1e-12",
             "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER", "*INITIAL CONDITIONS, TYPE=VELOCITY", f"P, 3, {-speed}",
             "*BOUNDARY", "W, 1, 3", "*STEP, NLGEOM, INC=100000", "*DYNAMIC", f"{end / 192}, {end}, 1e-9, {end / 192}", "*NODE PRINT, NSET=P", "V", "*END STEP"]
    seconds, memory, found = calculix(lines)
    layers = {number: key[2] // 2 for number, key in bar.key.items()}

    def momentum(time):
        # Linear between the two steps about it.
        times = sorted(t for what, t in found if what == "velocities")
        of = lambda t: sum(v[2] * (1 if 0 < layers[k] < n else 0.5) for k, v in found["velocities", t].items()) / (4 * n * speed)
        below, above = max([t for t in times if t <= time], default=times[0]), min([t for t in times if t >= time], default=times[-1])
        return of(below) if above == below else of(below) + (of(above) - of(below)) * (time - below) / (above - below)

    def wave(t):
        return -1 if t < 0 else 1 if t > 2 else t - 1

    times = [end * k / 12 for k in range(1, 13)]
    return seconds, memory, [distance([momentum(t) for t in times], [wave(t - start) for t in times])]


PROBLEMS = [
    ("bar-impact", bar_impact, ["C3D8"], [8, 16, 32]),
    ("cook", cook, ["C3D8", "C3D8I", "C3D20R", "C3D20"], [2, 4, 8, 16]),
    ("tied-bars", tied_bars, ["C3D8I", "C3D20R", "C3D20"], [1, 2, 4]),
]


def main():
    rows = [["problem", "program", "cell", "mesh", "ending", "cpu_seconds", "memory_mb", "error"]]
    for name, run, kinds, meshes in PROBLEMS:
        for kind in kinds:
            for mesh in meshes:
                try:
                    seconds, memory, errors = run(kind, mesh)
                    rows.append([name, "CalculiX", kind, mesh, "ok", f"{seconds:.3e}", f"{memory:.1f}", f"{errors[0]:.4e}"])
                except (RuntimeError, KeyError) as error:
                    rows.append([name, "CalculiX", kind, mesh, f"failed: {error}".replace(",", ";"), "", "", ""])
                print(rows[-1])
    with open(HOME / "peers.csv", "w") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
