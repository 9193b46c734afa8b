"""What a step costs from Python and from C, in turn, with the same poses: of each ten steps the least of
all rounds. PYTHONPATH=build/release/python /usr/bin/python3 tools/examples/steps.py \
    build/release/sulcus_steps SCENE.toml... [steps=500] [rounds=30]"""
import subprocess, sys, time
import sulcus

TEN = 10
program, *given = sys.argv[1:] or sys.exit(__doc__)
options = {"steps": 500, "rounds": 30}
options.update((name, int(value)) for name, _, value in (g.partition("=") for g in given) if value)
print("scene,steps,c_us,python_us,python_minus_c_us,ratio")
for scene in [g for g in given if "=" not in g]:
    run = sulcus.Simulation(scene)
    tens = min(options["steps"], run.ticks) // TEN
    poses = [[run.scene_pose((i * TEN + k) * (1.0 / run.rate_hz)) for k in range(TEN)] for i in range(tens)]
    start, least_ns, step = run.save(), [10 ** 12] * tens, run.step
    c = subprocess.Popen([program, scene, str(tens * TEN)], text=True, bufsize=1,
                         stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    for _ in range(options["rounds"]):
        run.restore(start)
        for i, ten in enumerate(poses):
            from_ns = time.perf_counter_ns()
            for pose in ten:
                step(pose)
            least_ns[i] = min(least_ns[i], time.perf_counter_ns() - from_ns)
        c.stdin.write("\n")
        c_us, forces = c.stdout.readline().split() or sys.exit(1)
        if forces != run.force_hash:
            sys.exit(f"{scene}: forces of C {forces}, of Python {run.force_hash}")
    c.communicate()
    c_us, python_us = float(c_us), sum(least_ns) / (1e3 * tens * TEN)
    print(f"{scene},{tens * TEN},{c_us:.2f},{python_us:.2f},{python_us - c_us:.2f},{python_us / c_us:.2f}")
