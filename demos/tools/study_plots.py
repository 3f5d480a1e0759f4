#!/usr/bin/env python3
"""Plots of `oilskin study` and `oilskin validate`: study_plots.py DIR [OUT].

Reads study.csv, validation.csv, leaks.csv, stability.csv, floating.csv and sizes.csv in DIR, those that are there, and
writes accuracy_cost.svg, accuracy_order.svg, leaks.svg, stability.svg, floating.svg and sizes.svg to OUT (default DIR).
Needs matplotlib.
"""

import csv
import math
import os
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "oilskin", "font.size": 9, "axes.grid": True, "grid.color": "#dddddd"})
import matplotlib.pyplot as plt  # noqa: E402 the backend must be chosen first


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(text):
    try:
        return float(text)
    except ValueError:
        return math.nan


def save(figure, out, name, tight=True):
    if tight:
        figure.tight_layout()
    path = os.path.join(out, name)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
    print(path)


def groups(rows, key):
    found = {}
    for row in rows:
        found.setdefault(row[key], []).append(row)
    return found


def panels(count, width=4.6, height=3.7, columns=2):
    columns = min(columns, count)
    lines = math.ceil(count / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(width * columns, height * lines), squeeze=False)
    for axis in axes.flat[count:]:
        axis.axis("off")
    return figure, list(axes.flat[:count])


def accuracy_cost(rows, out):
    """Error over cost per case; the Pareto front as a line."""
    cases = groups(rows, "case")
    figure, axes = panels(len(cases))
    colours = {name: f"C{k}" for k, name in enumerate(groups(rows, "sweep"))}
    for axis, (case, points) in zip(axes, cases.items()):
        for sweep, of_sweep in groups(points, "sweep").items():
            good = [p for p in of_sweep if number(p["error"]) > 0 and p["crossings"] == "0"]
            axis.plot([number(p["seconds_per_simulated_second"]) for p in good],
                      [100 * number(p["error"]) for p in good], "o", markersize=4, color=colours[sweep], label=sweep)
        front = sorted((number(p["seconds_per_simulated_second"]), 100 * number(p["error"]))
                       for p in points if p["front"] == "1")
        axis.plot(*zip(*front), "-", color="black", linewidth=1, label="Pareto front", zorder=0)
        axis.set(xscale="log", yscale="log", xlabel="wall seconds per simulated second", ylabel="error [%]",
                 title=f"{case}: {points[0]['quantity']}")
        axis.title.set_fontsize(8)
    axes[0].legend(fontsize=7, ncol=2)
    save(figure, out, "accuracy_cost.svg")


def accuracy_order(rows, out):
    """Error over spacing for every judged quantity, with its tolerance."""
    cases = groups([r for r in rows if r["tolerance"]], "case")
    figure, axes = panels(len(cases), 3.4, 2.9, 4)
    for axis, (case, points) in zip(axes, cases.items()):
        for k, (quantity, levels) in enumerate(groups(points, "quantity").items()):
            x = [1e3 * number(p["spacing"]) for p in levels]
            axis.plot(x, [max(100 * number(p["error"]), 1e-6) for p in levels], "o-", markersize=3, color=f"C{k}",
                      label=quantity)
            axis.plot(x, [100 * number(p["tolerance"]) for p in levels], ":", color=f"C{k}", linewidth=1)
        axis.set(xscale="log", yscale="log", xlabel="spacing [mm]", ylabel="error [%]", title=case)
        spacings = sorted({1e3 * number(p["spacing"]) for p in points})
        axis.set_xticks(spacings, [f"{s:.3g}" for s in spacings])
        axis.set_xticks([], minor=True)
        axis.legend(fontsize=5)
    save(figure, out, "accuracy_order.svg")


def leaks(rows, out):
    """Particles that pass the sheet over the step, per speed and method; dashed: with eight sub-steps."""
    held = list(groups(rows, "held"))
    speeds = sorted({number(r["speed"]) for r in rows})
    methods = list(groups(rows, "method"))
    plain = [m for m in methods if "," not in m]
    figure, axes = panels(len(held) * len(speeds), 3.2, 2.7, len(speeds))
    for axis, (hold, speed) in zip(axes, [(h, v) for h in held for v in speeds]):
        of_panel = groups([r for r in rows if r["held"] == hold and number(r["speed"]) == speed], "method")
        for method in methods:
            points = sorted(of_panel.get(method, []), key=lambda p: number(p["step"]))
            ours = method == "oilskin"
            axis.plot([1e3 * number(p["step"]) for p in points], [100 * number(p["leaked_fraction"]) for p in points],
                      "o--" if "," in method else "o-", markersize=5 if ours else 3, linewidth=3 if ours else 1,
                      zorder=3 if ours else 2, color=f"C{plain.index(method.split(',')[0])}", label=method)
        axis.set(xscale="log", xlabel="step [ms]", ylabel="leaked [%]", ylim=(-4, 104), title=f"{speed:g} m/s, sheet {hold}")
        axis.title.set_fontsize(8)
    lines, labels = axes[0].get_legend_handles_labels()
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.legend(lines, labels, loc="lower center", ncol=4, fontsize=8)
    save(figure, out, "leaks.svg", tight=False)


def stability(rows, out):
    """Energy made and stretch of the cloth, over step and mass of the cloth."""
    steps = sorted({number(r["step"]) for r in rows})
    masses = sorted({number(r["areal_density"]) for r in rows})
    value = {(number(r["step"]), number(r["areal_density"])): r for r in rows}
    figure, axes = panels(2, 5.4, 3.9)
    for axis, key, title in ((axes[0], "energy_risen", "energy made [% of its scale]"),
                             (axes[1], "stretch", "largest stretch of a link [%], (dry cloth)")):
        axis.grid(False)
        grid = [[100 * number(value[(s, m)][key]) for s in steps] for m in masses]
        image = axis.imshow(grid, origin="lower", aspect="auto", cmap="viridis", vmin=0)
        for j, mass in enumerate(masses):
            for i, step in enumerate(steps):
                dry = 100 * number(value[(step, mass)]["stretch_of_dry_cloth"])
                text = f"{grid[j][i]:.2g}" + (f"\n({dry:.2g})" if key == "stretch" else "")
                bright = grid[j][i] > 0.6 * max(max(line) for line in grid)
                axis.text(i, j, text, ha="center", va="center", color="black" if bright else "white", fontsize=7)
        axis.set_xticks(range(len(steps)), [f"{1e3 * s:.3g}" for s in steps])
        axis.set_yticks(range(len(masses)), [f"{m:g}" for m in masses])
        axis.set(xlabel="step [ms]", ylabel="areal density of the cloth [kg/m²]", title=title)
        axis.title.set_fontsize(9)
        figure.colorbar(image)
    save(figure, out, "stability.svg")


def floating(rows, out):
    """Energy made by a box that falls into water, over step and density."""
    figure, (axis,) = panels(1, 5.4, 3.7)
    for ratio, points in groups(rows, "density_ratio").items():
        axis.plot([1e3 * number(p["step"]) for p in points], [100 * number(p["energy_risen"]) for p in points], "o-",
                  markersize=3, label=f"{number(ratio):g}")
    axis.set(xscale="log", xlabel="step [ms]", ylabel="energy made [% of its scale]")
    axis.set_yscale("symlog", linthresh=0.1)
    axis.set_ylim(bottom=0)
    axis.legend(fontsize=7, title="density / water's", title_fontsize=7, ncol=2)
    save(figure, out, "floating.svg")


def sizes(rows, out):
    """Milliseconds a step over particles, faces and contacts."""
    columns = {"particles": "particles", "faces": "faces", "contacts": "contacts_per_substep"}
    varied_here = [v for v in columns if any(r["varied"] == v for r in rows)]
    figure, axes = panels(len(varied_here), columns=3)
    for axis, varied in zip(axes, varied_here):
        points = [r for r in rows if r["varied"] == varied]
        x = [number(p[columns[varied]]) for p in points]
        for key, label in (("ms_per_step", "sum"), ("ms_fluid", "fluid"), ("ms_walls", "walls and occlusion"),
                           ("ms_contact", "contact")):
            axis.plot(x, [number(p[key]) for p in points], "o-", markersize=3, label=label)
        axis.set(xscale="log", yscale="log", xlabel=varied, ylabel="ms a step")
    axes[0].legend(fontsize=7)
    save(figure, out, "sizes.svg")


def main(arguments):
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    directory, out = arguments[1], arguments[-1]
    os.makedirs(out, exist_ok=True)
    plots = {"study": accuracy_cost, "validation": accuracy_order, "leaks": leaks, "stability": stability,
             "floating": floating, "sizes": sizes}
    made = 0
    for name, plot in plots.items():
        path = os.path.join(directory, name + ".csv")
        if os.path.exists(path):
            plot(rows_of(path), out)
            made += 1
    if made == 0:
        sys.exit(f"{directory}: there is no table of a study in it")


if __name__ == "__main__":
    main(sys.argv)
