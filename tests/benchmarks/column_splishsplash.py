#!/usr/bin/env python3
"""A column of water at rest in SPlisHSPlasH, measured as print_comparator_tables measures ours.

use: column_splishsplash.py SPHSimulator [threads = 1]

SPHSimulator: see compare_splishsplash.py. 5 mm between particles, 8 × 8 × 25 of them. Its particles have 0.8 of the mass of
a cube of the spacing, so that the water is 20 spacings deep in a tank of 8 × 8. It starts as a lattice and first falls
together: means are over 1.5 s to 2 s. The walls are boundary particles [Akinci2012], half a spacing farther out, or volume
maps [Bender2019]. 0.1 % of mean density error, steps of half the CFL number and at most the given one, and a
viscosity of 5e-4 m²/s: that of its own scenes, 0.01, is not stable here at 0.5 ms.
"""
import array
import math
import os
import subprocess
import sys
import tempfile

from compare_splishsplash import DFSPH, PCISPH, run_simulator, solver_settings, unit_box

SPACING, G, DENSITY = 0.005, 9.81, 1000.0
WIDTH, DEPTH = 8 * SPACING, 20 * SPACING
FRAMES = 20  # a second
PATIENCE = 240  # seconds for the 2 s of a run
BOUNDARY_PARTICLES, VOLUME_MAPS = 0, 2
WALL = {BOUNDARY_PARTICLES: 0.5 * SPACING, VOLUME_MAPS: 0.0}  # how far outside the water's volume


def scene(method, boundary, step, folder):
    pressure = "p / rho^2" if method == DFSPH else "pressure"
    wall, height = WALL[boundary], 3 * DEPTH
    return {
        "Configuration": {
            "particleRadius": 0.5 * SPACING, "simulationMethod": method, "boundaryHandlingMethod": boundary,
            "gravitation": [0, -G, 0], "timeStepSize": step, "cflMethod": 1, "cflFactor": 0.5,
            "cflMinTimeStepSize": 1e-5, "cflMaxTimeStepSize": step, "stopAt": 2.001, "enableVTKExport": True,
            "dataExportFPS": FRAMES, "particleAttributes": "velocity;density;" + pressure, **solver_settings(method)},
        "Materials": [{"id": "Fluid", "density0": DENSITY, "viscosityMethod": 1, "Standard viscosity": {"viscosity": 5e-4}}],
        "RigidBodies": [{"geometryFile": unit_box(folder), "translation": [0, 0.5 * height - wall, 0],
                         "scale": [WIDTH + 2 * wall, height, WIDTH + 2 * wall], "isDynamic": False, "isWall": True,
                         "samplingMode": 1, "mapInvert": True, "mapThickness": 0.0, "mapResolution": [20, 60, 20]}],
        "FluidBlocks": [{"denseMode": 0, "start": [-0.5 * WIDTH - 0.5 * SPACING, -0.5 * SPACING, -0.5 * WIDTH - 0.5 * SPACING],
                         "end": [0.5 * WIDTH + 0.5 * SPACING, 25.5 * SPACING, 0.5 * WIDTH + 0.5 * SPACING]}]}


def read_frame(path):
    """Arrays by name of a legacy VTK file of points; positions as "POINTS"."""
    with open(path, "rb") as given:
        data = given.read()
    values, at = {}, 0
    while at < len(data):
        end = data.find(b"\n", at)
        words = data[at:end if end >= 0 else len(data)].decode("latin-1").split()
        at = end + 1 if end >= 0 else len(data)
        if not words:
            continue
        name, kind, count = words[0], words[-1], 0
        if name == "POINTS":
            count = 3 * int(words[1])
        elif name == "CELLS":
            kind, count = "int", int(words[2])
        elif name == "CELL_TYPES":
            kind, count = "int", int(words[1])
        elif name == "SCALARS":
            name, kind, count = words[1], words[2], len(values["POINTS"]) // 3
            at = data.find(b"\n", at) + 1  # LOOKUP_TABLE
        elif len(words) == 4 and words[1].isdigit():
            count = int(words[1]) * int(words[2])
        if count:
            item = array.array({"float": "f", "double": "d"}.get(kind, "I"))
            item.frombytes(data[at:at + count * item.itemsize])
            item.byteswap()
            values[name], at = item, at + count * item.itemsize
    return values


class RestSums:
    def __init__(self):
        self.level = self.speed2 = self.count = self.inner = self.error2 = self.density = 0.0
        self.d = self.p = self.dd = self.dp = 0.0
        self.frames = self.outside = 0

    def add(self, frame, head_scale):
        y = frame["POINTS"][1::3]
        surface = 2 * sum(y) / len(y)
        self.frames, self.level = self.frames + 1, self.level + surface
        heads = frame.get("pressure", frame.get("p_/_rho^2"))
        self.count, self.speed2 = self.count + len(y), self.speed2 + sum(v * v for v in frame["velocity"])
        for i, (x, height, z) in enumerate(zip(*(frame["POINTS"][k::3] for k in range(3)))):
            self.outside += height < -SPACING or max(abs(x), abs(z)) > 0.5 * WIDTH + SPACING
            if 2 * SPACING <= height <= DEPTH - 2 * SPACING:
                below, head = surface - height, head_scale * heads[i]
                self.inner, self.error2 = self.inner + 1, self.error2 + (head - below) ** 2
                self.density += frame["density"][i] / DENSITY
                self.d, self.p, self.dd, self.dp = self.d + below, self.p + head, self.dd + below ** 2, self.dp + below * head

    def row(self):
        if self.outside or not self.inner:
            return f"– | – | – | – | – | {self.outside // max(1, self.frames)}"
        slope = (self.inner * self.dp - self.d * self.p) / (self.inner * self.dd - self.d ** 2)
        return (f"{100 * (self.level / self.frames / DEPTH - 1):+.1f} % | {100 * math.sqrt(self.error2 / self.inner) / DEPTH:.1f} % "
                f"| {slope:.3f} | {self.density / self.inner:.4f} | {math.sqrt(self.speed2 / self.count):.3f} "
                f"| {self.outside // self.frames}")


def measure(program, method, boundary, step, threads):
    with tempfile.TemporaryDirectory() as folder:
        try:
            seconds = run_simulator(program, folder, scene(method, boundary, step, folder), 1600, threads, PATIENCE)
        except subprocess.TimeoutExpired:  # its steps have become tiny
            return f"– | – | – | – | – | – | more than {PATIENCE / 2:g}"
        sums = RestSums()
        for k in range(int(1.5 * FRAMES) + 1, 2 * FRAMES + 1):
            # Its p/ρ² of DFSPH is in units of the step, at rest the longest; the pressure of PCISPH is over ρ0.
            sums.add(read_frame(os.path.join(folder, "vtk", f"ParticleData_Fluid_{k}.vtk")),
                     1 / G / (step * step if method == DFSPH else 1))
        return f"{sums.row()} | {seconds / 2:.2f}"


def main(arguments):
    if not arguments:
        sys.exit(__doc__)
    threads = int(arguments[1]) if len(arguments) > 1 else 1
    print("| solver | walls | step [ms] | level | pressure rms | slope | density | rms speed [m/s] | outside | time |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, method in (("DFSPH", DFSPH), ("PCISPH", PCISPH)):
        for walls, boundary in (("particles", BOUNDARY_PARTICLES), ("volume maps", VOLUME_MAPS)):
            for step in (0.0005, 0.001, 0.002, 0.004):
                print(f"| {name} | {walls} | {1e3 * step:g} | {measure(arguments[0], method, boundary, step, threads)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
