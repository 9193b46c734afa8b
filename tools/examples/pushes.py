"""500 pushes of a burr over a molar: how far each method's force is from that by exact normals.
PYTHONPATH=build/release/python /usr/bin/python3 tools/examples/pushes.py [pushes.png]; by gnuplot"""
import subprocess, sys
import numpy as np
import sulcus

SCENE = """[workpiece]\nshape = "molar"\nvoxel_mm = 0.08\ncells = [176, 176, 216]
[burr]\ndiameter_mm = 1.2\n[trajectory]\npoints_mm = [[0, 0, 20]]\n"""
runs = {method: sulcus.Simulation(SCENE, set=[f"haptics.normals={method}"])
        for method in ("exact", "ldm", "ldm_fast", "weighted_sum")}
tooth = runs["exact"]
solid = tooth.volume
columns = np.random.default_rng(1).permutation(np.argwhere(solid[..., 108:].any(axis=2)))[:500]
top = solid.shape[2] - 1 - solid[..., ::-1].argmax(axis=2)[tuple(columns.T)]
tips = tooth.origin_m + tooth.voxel_m * np.c_[columns, top] - [0, 0, 60e-6]  # so deep, straight down
poses = np.c_[tips, np.tile([0.5 ** 0.5, 0.5 ** 0.5, 0, 0], (500, 1))]
force = {method: run.run(poses)["contact_wrench"][:, :3] for method, run in runs.items()}
unit = {m: f / np.linalg.norm(f, axis=1, keepdims=True) for m, f in force.items()}
data, plots = "", []
for method in list(runs)[1:]:
    angle = np.degrees(np.arccos(np.clip((unit[method] * unit["exact"]).sum(axis=1), -1, 1)))
    print(f"{method}: {np.nanmean(angle):.2f} degrees in the mean, {np.nanmedian(angle):.2f} median")
    data += "\n".join(f"{f} {a}" for f, a in zip(np.linalg.norm(force["exact"], axis=1), angle)) + "\ne\n"
    plots.append(f"'-' title '{method}' noenhanced")
subprocess.run(["gnuplot"], text=True, check=True, input=f"""set terminal png size 900,600
set output '{(sys.argv + ["pushes.png"])[1]}'; set xlabel 'force by exact normals, N'; set logscale y
set key outside top horizontal; set ylabel 'angle to it, degrees'; plot {", ".join(plots)}\n{data}""")
