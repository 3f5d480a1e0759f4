#!/usr/bin/env python3
"""DAM(n) of dam_benchmark beside SPlisHSPlasH, in turn on the same machine.

use: compare_splishsplash.py SPHSimulator dam_benchmark [n = 50] [steps = 170] [threads = 2]

SPHSimulator is the program of SPlisHSPlasH (https://github.com/InteractiveComputerGraphics/SPlisHSPlasH), which is
not part of this project. Build it as its pages say, with AVX:
    cmake -B build -DCMAKE_BUILD_TYPE=Release -DUSE_AVX=ON && cmake --build build --target SPHSimulator

Both have spacing 1/n, dt = spacing/20, 0.1 % of mean density error, viscosity 0.01 and the same box. Its walls are
volume maps [Bender2019], which need no boundary particles; ours are contact alone. Times are those of the second half
of the steps: of two of its runs, the shorter one is taken off the longer one.
"""
import json
import os
import re
import subprocess
import sys
import tempfile

DFSPH, PCISPH = 4, 1  # its numbers of methods


def solver_settings(method):
    """Of 0.1 % of mean density error."""
    if method == DFSPH:
        return {"DFSPH": {"minIterations": 2, "maxIterations": 100, "maxError": 0.1, "maxIterationsV": 100, "maxErrorV": 0.1,
                          "enableDivergenceSolver": True}}
    return {"PCISPH": {"minIterations": 3, "maxIterations": 100, "maxError": 0.1}}


def scene(n, method, steps):
    spacing = 1 / n
    configuration = {
        "particleRadius": spacing / 2, "simulationMethod": method, "gravitation": [0, -9.81, 0],
        "timeStepSize": spacing / 20, "cflMethod": 0, "boundaryHandlingMethod": 2, "stopAt": steps * spacing / 20}
    configuration.update(solver_settings(method))
    size = [3, 2, (n + 1.3) * spacing]
    low = 0.65 * spacing
    return {
        "Configuration": configuration,
        "Materials": [{"id": "Fluid", "density0": 1000, "viscosityMethod": 1, "Standard viscosity": {"viscosity": 0.01}}],
        "RigidBodies": [{"translation": [0.5 * x for x in size], "scale": size, "isDynamic": False, "isWall": True,
                         "mapInvert": True, "mapThickness": 0.0, "mapResolution": [20, 20, 10]}],
        "FluidBlocks": [{"denseMode": 0, "start": [low] * 3, "end": [1 + low + 0.5 * spacing] * 3}]}


def unit_box(folder):
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    path = os.path.join(folder, "box.obj")
    with open(path, "w", encoding="utf-8") as out:
        for corner in corners:
            out.write("v {} {} {}\n".format(*corner))
        for a, b, c, d in faces:
            out.write(f"f {a} {b} {c}\nf {a} {c} {d}\n")
    return path


def run_simulator(program, folder, given, particles, threads, patience=None):
    """Runs the scene `given`, of so many particles, in `folder`; returns the seconds of all its steps."""
    path = os.path.join(folder, "scene.json")
    with open(path, "w", encoding="utf-8") as out:
        json.dump(given, out)
    ran = subprocess.run([program, "--no-gui", "--no-initial-pause", "--no-cache", "--output-dir", folder, path], text=True,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, timeout=patience,
                         env=dict(os.environ, OMP_NUM_THREADS=str(threads), HOME=folder))
    count = re.search(r"Number of fluid particles: (\d+)", ran.stdout)
    times = re.findall(r"Time sum: SimStep: ([0-9.e+]+) ms", ran.stdout)
    if not count or int(count[1]) != particles or not times:
        sys.exit(f"{program} did not run the scene of {particles} particles:\n{ran.stdout[-2000:]}")
    return float(times[-1]) / 1e3


def its_seconds(program, folder, n, method, steps, threads):
    """Of all steps of a run."""
    given = scene(n, method, steps)
    given["RigidBodies"][0]["geometryFile"] = unit_box(folder)
    return run_simulator(program, folder, given, n ** 3, threads)


def our_milliseconds(program, n, steps, threads, solver):
    ran = subprocess.run([program, str(n), str(threads), str(steps), solver], text=True, stdout=subprocess.PIPE, check=True)
    return float(re.search(r"whole step ([0-9.]+) ms", ran.stdout)[1])


def main(arguments):
    if len(arguments) < 2:
        sys.exit(__doc__)
    theirs, ours = arguments[:2]
    n, steps, threads = (int(a) for a in (arguments[2:] + ["50", "170", "2"][len(arguments) - 2:])[:3])
    print(f"DAM({n}), {n ** 3} particles, {threads} threads, steps {steps // 2 + 1} to {steps}, ms a step")
    print("solver   SPlisHSPlasH  Oilskin  ratio")
    for name, method in (("PCISPH", PCISPH), ("DFSPH", DFSPH)):
        with tempfile.TemporaryDirectory() as folder:
            half = steps // 2
            spent = [its_seconds(theirs, folder, n, method, k, threads) for k in (half, steps)]
        peer = 1e3 * (spent[1] - spent[0]) / (steps - half)
        own = our_milliseconds(ours, n, steps, threads, name.lower())
        print(f"{name:8} {peer:12.1f} {own:8.1f} {peer / own:6.1f}")


if __name__ == "__main__":
    main(sys.argv[1:])
