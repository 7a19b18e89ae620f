#!/usr/bin/env python3
"""Runs decks of the test set of CalculiX in CalculiX and, imported, in Stoss, and prints a table of the differences.

Needs `ccx` and its decks (Debian: calculix-ccx, calculix-ccx-test); says so and ends without an error if they are missing. Only the standard library is used.

    scripts/import-decks.py [--stoss PATH] [--decks FOLDER] [--out FOLDER] [NAME ...]

Each deck gets a set of all nodes and prints their displacements and forces; the results are compared at the ends of the steps, nodes by their places. `u` is the largest difference of
displacements over the largest displacement of CalculiX at any time, `R` the same of the reaction forces of nodes that are held in all directions.
"""

import argparse
import base64
import gzip
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tomllib

# Decks with solids whose steps are static or dynamic, with contact and constraints first.
DECKS = """
beamnh beamog beamptied1 beamptied2 beamptied3 beamptied4 beamptied5 beamptied7 contactenergy friction2 changefric cubef2f1 cubespring cubef2f3 contact4
friction1 contact2 beamcontact changesurfbeh fricloop contact1 pret1 pret3 scheibe2n2f ball metalforming contdamp1 contact3 punch1 punch2 thread
beamnld beamnlp beamnlptp cube2 beamd achtelc c3d15 c3d6 beamdynamic achtelp beamp beamp2stage beam8p beam10p beam20p segment1 beamnldy beampfix
beamimpdy1 cubenewt beamdelay beampiso beamnldyp beammr beamrb inistrain dashpot5 disk2 beamnldye aniso
""".split()
LIMIT = 120  # seconds of processor time


def run(command, folder):
    """Exit code and text of a program with a limit of processor time."""
    line = f"ulimit -t {LIMIT}; exec \"$@\""
    done = subprocess.run(["bash", "-c", line, "-", *command], cwd=folder, capture_output=True, text=True, errors="replace")
    return done.returncode, done.stdout + done.stderr


def with_output(text):
    """The deck with a set of all nodes, printed in each step, and the places of the nodes of solids."""
    lines, out, in_step, biggest, nodes, in_nodes = text.splitlines(), [], False, 0, {}, False
    used, in_solids, pending = set(), None, []
    for line in lines:
        keyword = re.sub(r"\s", "", line.upper()) if line.startswith("*") and not line.startswith("**") else ""
        if keyword:
            in_nodes = re.match(r"\*NODE(,|$)", keyword) is not None
            in_solids = re.match(r"\*ELEMENT,.*TYPE=C3D(\d+)", keyword)
            pending = []
        elif in_nodes and line.strip() and not line.startswith("**"):
            parts = [part.strip() for part in line.split(",")]
            number = int(parts[0])
            nodes[number] = tuple(float(x or 0) for x in (parts[1:4] + ["0", "0", "0"])[:3])
            biggest = max(biggest, number)
        elif in_solids and line.strip() and not line.startswith("**"):
            # The first number of an element is its own.
            pending += [int(part) for part in line.split(",") if part.strip()]
            if len(pending) > int(in_solids[1]):
                used.update(pending[1:])
                pending = []
        if keyword.startswith("*STEP") and not in_step:
            if "*NSET,NSET=STOSSALL,GENERATE" not in out:
                out += ["*NSET,NSET=STOSSALL,GENERATE", f"1,{biggest}"]
            in_step = True
        if keyword.startswith("*ENDSTEP"):
            out += ["*NODE PRINT,NSET=STOSSALL,FREQUENCY=1,GLOBAL=YES", "U,RF"]
            in_step = False
        # Only one set is printed: others would hide it.
        out.append(line)
    return "\n".join(out) + "\n", {number: nodes[number] for number in used if number in nodes}


def read_dat(path):
    """By quantity and time the vectors of the nodes."""
    found, current = {}, None
    with open(path, errors="replace") as file:
        for line in file:
            head = re.match(r"\s*(displacements|forces) .* for set STOSSALL and time\s+(\S+)", line)
            if head:
                current = found.setdefault(head[1], {}).setdefault(float(head[2]), {})
                continue
            parts = line.split()
            if current is not None and len(parts) == 4 and parts[0].isdigit():
                current[int(parts[0])] = tuple(float(x) for x in parts[1:])
            elif parts:
                current = None
    return found


def read_vtu(path):
    """Time, points and vectors of a frame."""
    text = open(path).read()

    def array(name):
        found = re.search(rf'<DataArray type="(\w+)" Name="{name}"[^>]*>\s*([^<\s]*)', text)
        if not found:
            return None
        data = base64.b64decode(found[2])
        count = struct.unpack("<Q", data[:8])[0] // 8
        return struct.unpack(f"<{count}d", data[8:8 + 8 * count])

    def vectors(name):
        flat = array(name)
        return None if flat is None else [flat[k:k + 3] for k in range(0, len(flat), 3)]

    points = re.search(r'<Points>\s*<DataArray type="(\w+)"[^>]*>\s*([^<\s]*)', text)
    data = base64.b64decode(points[2])
    count = struct.unpack("<Q", data[:8])[0] // 8
    flat = struct.unpack(f"<{count}d", data[8:8 + 8 * count])
    return array("TimeValue")[0], [flat[k:k + 3] for k in range(0, len(flat), 3)], vectors("displacement"), vectors("reaction")


def size(vector):
    return math.sqrt(sum(x * x for x in vector))


def compare(folder, name, nodes, ends):
    """Differences of displacements and reactions over the largest ones of CalculiX."""
    dat = read_dat(f"{folder}/{name}.dat")
    ours = {}
    frames = f"{folder}/out/frames"
    for frame in sorted(os.listdir(frames)) if os.path.isdir(frames) else []:
        if frame.endswith(".vtu"):
            time, points, displacement, reaction = read_vtu(f"{frames}/{frame}")
            ours[time] = (points, displacement, reaction)
    worst = {}
    for quantity, column in (("displacements", 1), ("forces", 2)):
        theirs = dat.get(quantity, {})
        largest = max((size(v) for vectors in theirs.values() for v in vectors.values()), default=0.0)
        for end in ends:
            time = min(ours, key=lambda t: abs(t - end), default=None)
            other = min(theirs, key=lambda t: abs(t - end), default=None)
            if time is None or other is None or abs(time - end) > 1e-6 * end or abs(other - end) > 1e-5 * end or largest == 0.0:
                continue
            points, vectors = ours[time][0], ours[time][column]
            if vectors is None:
                continue
            scale = max(max(abs(x) for x in point) for point in nodes.values()) or 1.0
            index = {}
            for point, vector, moved in zip(points, vectors, ours[time][1]):
                # Points of frames are those of the reference configuration.
                index.setdefault(tuple(round(x / scale, 6) for x in point), []).append(vector)
            for number, theirs_at in theirs[other].items():
                key = tuple(round(x / scale, 6) for x in nodes.get(number, (math.nan,) * 3))
                if key in index:
                    if quantity == "forces":
                        own = [tuple(sum(v[i] for v in index[key]) for i in range(3))]
                        if 0.0 in own[0]:
                            continue  # not held in all directions: there may be a load, which CalculiX' forces contain
                    else:
                        own = index[key]
                    off = min(size([a - b for a, b in zip(v, theirs_at)]) for v in own)
                    worst[quantity] = max(worst.get(quantity, 0.0), off / largest)
    return worst.get("displacements"), worst.get("forces")


def deck(name, options):
    """A row of the table."""
    source = f"{options.decks}/{name}.inp"
    packed = not os.path.exists(source)
    folder = f"{options.out}/{name}"
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    with gzip.open(f"{source}.gz", "rt", errors="replace") if packed else open(source, errors="replace") as file:
        text, nodes = with_output(file.read())
    with open(f"{folder}/{name}.inp", "w") as file:
        file.write(text)
    for included in re.findall(r"INPUT\s*=\s*(\S+)", text, re.I):
        if os.path.exists(f"{options.decks}/{included}"):
            shutil.copy(f"{options.decks}/{included}", folder)
    run([options.ccx, name], folder)
    code, said = run([options.stoss, "import", f"{name}.inp", "-o", "scene.toml", "--force"], folder)
    if not os.path.exists(f"{folder}/scene.toml"):
        return [name, "refused", "", "", "", said.strip().splitlines()[0][:160] if said.strip() else ""]
    scene = open(f"{folder}/scene.toml").read()
    data = tomllib.loads(scene)
    ends = [stage["until"] for stage in data.get("stage", [])] or [data["time"]["end"]]
    with open(f"{folder}/scene.toml", "a") as file:
        fields = ["displacement"] + ["reaction"] * any("set" in item for item in data.get("prescribe", []))
        file.write(f"\n[output]\ntimes = {ends}\nfields = {fields}\n")
    ran, said = run([options.stoss, "run", "scene.toml", "--quiet", "--force", "--no-report", "--threads", "1", "--out", "out"], folder)
    verdict = ""
    if os.path.exists(f"{folder}/out/summary.json"):
        verdict = json.load(open(f"{folder}/out/summary.json"))["verdict"]["level"]
    u, forces = compare(folder, name, nodes, ends) if os.path.exists(f"{folder}/{name}.dat") else (None, None)
    left = [f"{entry['keyword']} ({entry['severity']})" for entry in data.get("left_out", []) if entry["severity"] != "note"]
    number = lambda x: "-" if x is None else f"{x:.1e}"
    return [name, "yes" if code == 0 else f"rc {code}", f"{verdict} ({ran})", number(u), number(forces), "; ".join(left)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stoss", default="target/debug/stoss")
    parser.add_argument("--ccx", default="ccx")
    parser.add_argument("--decks", default="/usr/share/doc/calculix-ccx-test/examples/test")
    parser.add_argument("--out", default="target/import-decks")
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    options.stoss = os.path.abspath(options.stoss)
    if shutil.which(options.ccx) is None or not os.path.isdir(options.decks):
        print("skipped: ccx or its decks are missing (Debian: calculix-ccx, calculix-ccx-test)")
        return 0
    print("| deck | imported | ran | u | R | left out |\n|---|---|---|---|---|---|")
    for name in options.names or DECKS:
        print("| " + " | ".join(deck(name, options)) + " |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
