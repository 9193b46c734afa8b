"""`import sulcus` as it was built. Run by ctest, which says where the module and the program are."""

import ast
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import sulcus

ROOT = pathlib.Path(__file__).resolve().parents[3]
GOLDEN = ROOT / "tests" / "golden"
PROGRAM = os.environ["SULCUS_PROGRAM"]
AIR = """
[workpiece]
shape = "box"
voxel_mm = 0.1
cells = [16, 24, 32]
box.size_mm = [1, 2, 2]
[burr]
diameter_mm = 1.0
field = [32, 64, 32]
[trajectory]
points_mm = [[0, 0, 5]]
"""
UP = [0, 0, 5e-3, 0.5 ** 0.5, 0.5 ** 0.5, 0, 0]


def golden(name):
    return json.loads((GOLDEN / f"{name}.json").read_text())


class Runs(unittest.TestCase):
    def test_hashes_are_those_of_the_program(self):
        for name in ("press_hand", "cut_full", "cut_loose", "cut_fractions"):
            run = sulcus.Simulation(GOLDEN / f"{name}.toml")
            trace = run.run()
            self.assertEqual(run.volume_hash, golden(name)["volume_hash"])
            self.assertEqual(run.force_hash, golden(name)["force_hash"])
            self.assertEqual(run.state_hash, golden(name)["state_hash"])
            self.assertEqual(len(trace["tick"]), golden(name)["ticks"])
            self.assertEqual(trace["wrench"].shape, (run.ticks, 6))
            self.assertEqual(int(trace["contacts"].sum()), golden(name)["contacts"])

    def test_steps_parts_and_poses_come_to_the_same(self):
        whole = sulcus.Simulation(GOLDEN / "cut_full.toml")
        trace = whole.run()
        parts = sulcus.Simulation(GOLDEN / "cut_full.toml")
        for tick in range(100):
            np.testing.assert_array_equal(parts.step(), trace["wrench"][tick])
        for tick in range(100, 200):
            np.testing.assert_array_equal(parts.step(trace["device_pose"][tick]),
                                          trace["wrench"][tick])
        parts.run(300)
        parts.run(trace["device_pose"][500:])
        self.assertEqual(parts.force_hash, whole.force_hash)
        np.testing.assert_array_equal(parts.edits, whole.edits)
        np.testing.assert_array_equal(trace["device_pose"][700], whole.scene_pose(700 * (1 / whole.rate_hz)))

    def test_the_volume_is_the_start_without_what_was_cut(self):
        run = sulcus.Simulation(GOLDEN / "cut_full.toml")
        before = run.volume
        run.run()
        after, edits = run.volume, run.edits
        self.assertEqual(len(edits), golden("cut_full")["edits"])
        nx, ny, _ = before.shape
        v = edits["voxel"].astype(int)
        before[v % nx, v // nx % ny, v // (nx * ny)] = False
        np.testing.assert_array_equal(before, after)
        bits = np.unpackbits(run.packed_volume, axis=2, bitorder="little").astype(bool)
        np.testing.assert_array_equal(bits.transpose(2, 1, 0), after)

    def test_contacts_lie_on_the_solid_and_carry_the_force(self):
        run = sulcus.Simulation(GOLDEN / "probe_ldm.toml")
        while len(run.contacts) < 20:
            run.step()
        contacts, solid = run.contacts, run.volume
        cells = np.rint((contacts["position_m"] - run.origin_m) / run.voxel_m).astype(int)
        self.assertTrue(solid[tuple(cells.T)].all())
        np.testing.assert_allclose(np.linalg.norm(contacts["normal"], axis=1), 1, atol=1e-5)
        pushed = (contacts["normal"] * contacts["force_N"][:, None]).sum(axis=0)
        np.testing.assert_allclose(pushed, run.step(run.scene_pose((run.tick - 1) / run.rate_hz))[:3],
                                   rtol=1e-3, atol=1e-4)

    def test_a_saved_state_is_gone_on_from(self):
        run = sulcus.Simulation(GOLDEN / "cut_full.toml")
        run.run(700)
        state = run.save()
        run.run()
        edits = run.edits
        run.restore(state)
        self.assertEqual(run.tick, 700)
        run.run()
        self.assertEqual(run.force_hash, golden("cut_full")["force_hash"])
        np.testing.assert_array_equal(run.edits, edits)
        with self.assertRaisesRegex(ValueError, "saved state"):
            run.restore(state[:-1])

    def test_edits_are_those_of_the_way_that_led_here(self):
        run = sulcus.Simulation(GOLDEN / "cut_full.toml")
        start = run.save()
        run.run(700)
        on_one_way, edits = run.save(), run.edits
        self.assertGreater(len(edits), 10)
        run.restore(start)
        self.assertEqual(len(run.edits), 0)
        for tick in range(900):  # slower, so that other voxels go
            run.step(run.scene_pose(0.0009 * tick))
        self.assertFalse(np.array_equal(run.edits[:len(edits)], edits))
        run.restore(on_one_way)
        self.assertEqual(len(run.edits), 0, "not those of the other way")

    def test_own_voxels_are_the_workpiece(self):
        solid = np.random.default_rng(7).random((32, 24, 16)) < 0.5
        run = sulcus.Simulation(AIR, voxels=solid.astype(np.uint8).ravel())
        np.testing.assert_array_equal(run.volume, solid.transpose(2, 1, 0))

    def test_pictures_show_what_was_cut(self):
        run = sulcus.Simulation(GOLDEN / "cut_full.toml")
        before = run.render("occlusal", 160, 120)
        run.run()
        after = run.render("occlusal", 160, 120)
        self.assertEqual(after.shape, (120, 160, 3))
        self.assertGreater((before != after).any(axis=2).sum(), 50)
        self.assertTrue((run.render((0.0, 90.0), 160, 120) == 0).sum() < 160 * 120)


class WrongUse(unittest.TestCase):
    def test_is_an_error_and_changes_nothing(self):
        run = sulcus.Simulation(AIR)
        run.step(UP)
        state = run.state_hash
        for bad in ([0] * 6, [0] * 7, [float("nan")] + UP[1:], [11.0] + UP[1:], "pose"):
            with self.assertRaises((ValueError, TypeError)):
                run.step(bad)
        for bad in (-1, np.zeros((3, 6)), [[float("inf")] * 7], "x", [[0] * 7, [0] * 6]):
            with self.assertRaises((ValueError, TypeError)):
                run.run(bad)
        for bad in (2**63, 10**30, -(10**30)):
            with self.assertRaisesRegex(ValueError, "ticks"):
                run.run(bad)
        for bad in ("nowhere", (0.0, 91.0), (float("nan"), 0.0), 7):
            with self.assertRaises((ValueError, TypeError, RuntimeError)):
                run.render(bad)
        self.assertEqual(run.state_hash, state)
        with self.assertRaisesRegex(ValueError, "nowhere.toml: found"):
            sulcus.Simulation("nowhere.toml")
        with self.assertRaisesRegex(ValueError, "wrong"):
            sulcus.Simulation(AIR + "wrong = 1\n")
        with self.assertRaisesRegex(ValueError, "voxels"):
            sulcus.Simulation(AIR, voxels=np.ones(5, np.uint8))
        for kind in (np.int64, np.float32):  # 256 would be 0, and 0.7, too
            with self.assertRaisesRegex(ValueError, "expected uint8 or bool"):
                sulcus.Simulation(AIR, voxels=np.ones(32 * 24 * 16, kind))

    def test_a_second_thread_is_refused(self):
        run = sulcus.Simulation(AIR)
        running, refused = threading.Event(), []

        def work():
            running.set()
            try:
                run.run(300000)
            except RuntimeError as why:
                refused.append(str(why))

        thread = threading.Thread(target=work)
        thread.start()
        running.wait()
        while thread.is_alive():
            try:
                run.step(UP)
            except RuntimeError as why:
                refused.append(str(why))
                break
        thread.join()
        self.assertIn("another thread", " ".join(refused))

    def test_nothing_is_read_during_a_tick(self):
        run = sulcus.Simulation(AIR)
        names = ["volume_hash", "force_hash", "state_hash", "tick", "ticks", "rate_hz", "voxel_m",
                 "origin_m", "contacts", "edits", "volume", "packed_volume"]
        refused = set()

        def work():
            done = False
            while not done:  # it, too, may be refused
                try:
                    run.run(300000)
                    done = True
                except RuntimeError:
                    pass

        thread = threading.Thread(target=work)
        thread.start()
        while thread.is_alive() and len(refused) < len(names):
            for name in names:
                try:
                    getattr(run, name)
                except RuntimeError as why:
                    if "another thread" in str(why):
                        refused.add(name)
        thread.join()
        self.assertEqual(refused, set(names))
        for name in names:
            getattr(run, name)

    def test_other_threads_go_on_during_a_run(self):
        run, over, gaps = sulcus.Simulation(AIR), threading.Event(), [0.0]

        def watch():
            before = time.monotonic()
            while not over.is_set():
                time.sleep(0.001)
                now = time.monotonic()
                gaps[0], before = max(gaps[0], now - before), now

        thread = threading.Thread(target=watch)
        thread.start()
        begin, ticks = time.monotonic(), 0
        while time.monotonic() - begin < 1.0 and ticks < 10 ** 8:  # the last call is the longest
            last = time.monotonic()
            ticks = 4 * ticks or 10000
            run.run(ticks)
        took = time.monotonic() - last
        over.set()
        thread.join()
        self.assertLess(gaps[0], 0.8 * took)

    def test_ctrl_c_ends_a_run(self):
        script = ("import sys, sulcus\n"
                  f"run = sulcus.Simulation('''{AIR}''')\n"
                  "print('running', flush=True)\n"
                  "try:\n    run.run(10**9)\n"
                  "except KeyboardInterrupt:\n    print(run.tick, flush=True)\n")
        with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE,
                              text=True) as child:
            self.assertEqual(child.stdout.readline().strip(), "running")
            threading.Event().wait(0.3)
            child.send_signal(signal.SIGINT)
            ticks = int(child.stdout.readline())
            self.assertEqual(child.wait(), 0)
        self.assertGreater(ticks, 0)


class Recordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        out = pathlib.Path(cls.folder.name, "out")
        subprocess.run([PROGRAM, "run", GOLDEN / "cut_full.toml", "--no-render", "-o", out], check=True,
                       capture_output=True)
        cls.recording = sulcus.Recording(out / "recording.h5")
        cls.live = sulcus.Simulation(GOLDEN / "cut_full.toml")
        cls.trace = cls.live.run()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_any_time_is_as_it_was(self):
        live = sulcus.Simulation(GOLDEN / "cut_full.toml")
        live.run(601)
        then = live.volume
        last, moment = self.recording[1.4], self.recording[0.6004]
        self.assertEqual(last.tick, 1400)
        self.assertEqual(moment.tick, 600)
        np.testing.assert_array_equal(moment.wrench, self.trace["wrench"][600])
        np.testing.assert_array_equal(moment.contact_wrench, self.trace["contact_wrench"][600])
        np.testing.assert_array_equal(moment.tool_pose, self.trace["tool_pose"][600])
        np.testing.assert_array_equal(moment.device_pose, self.trace["device_pose"][600])
        self.assertEqual(moment.contacts, self.trace["contacts"][600])
        self.assertFalse(np.array_equal(last.volume, then))
        np.testing.assert_array_equal(moment.volume, then)  # back from later
        self.assertEqual(len(self.recording), len(self.trace["tick"]))
        np.testing.assert_array_equal(self.recording.ticks["force_N"], self.trace["wrench"][:, :3])
        self.assertEqual(moment.render("occlusal", 160, 120).shape, (120, 160, 3))
        for bad in (-0.1, 99.0, float("nan")):
            with self.assertRaises(IndexError):
                _ = self.recording[bad]

    def test_it_is_assessed_as_by_the_program(self):
        limits = pathlib.Path(self.folder.name, "limits.toml")
        limits.write_text('[assessment]\npreset = "class_one"\n')
        out = pathlib.Path(self.folder.name, "assessed")
        recording = pathlib.Path(self.folder.name, "out", "recording.h5")
        subprocess.run([PROGRAM, "assess", "--no-render", recording, "--assessment", limits, "-o", out], check=True,
                       capture_output=True)
        by_program = json.loads((out / "assessment.json").read_text())
        self.assertEqual(self.recording.assess(limits)["measures"], by_program["measures"])
        with self.assertRaisesRegex(ValueError, r"\[assessment\]"):
            self.recording.assess()


class Stubs(unittest.TestCase):
    def test_they_name_what_there_is(self):
        stub = ast.parse(pathlib.Path(sulcus.__file__).with_name("sulcus.pyi").read_text())
        for node in stub.body:
            if not isinstance(node, ast.ClassDef):
                continue
            said = {f.name for f in node.body if isinstance(f, ast.FunctionDef)}
            there = {name for name in vars(getattr(sulcus, node.name))
                     if not name.startswith("_") or name in said}
            self.assertEqual(said | {"__init__"}, there | {"__init__"}, node.name)
        for name in ("step", "run", "volume_hash", "contacts", "render"):
            self.assertTrue(getattr(sulcus.Simulation, name).__doc__)


if __name__ == "__main__":
    unittest.main()
