"""Running scenes, stepping, steering, interrupting."""

import os
import signal
import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest
import stoss
from conftest import flying


def test_a_shipped_scene_runs(scenes):
    run = stoss.run(scenes / "two-blocks.toml", until=0.05, out="two.out")
    assert (run.outcome, run.verdict, run.reasons) == ("stopped", "sound", [])
    assert str(run.out) == "two.out" and (run.out / "summary.json").is_file()
    steps = run.balance["step"]
    assert steps.dtype == np.int64 and list(steps) == list(range(len(steps)))
    assert not run.balance["total"].flags.writeable
    assert "total" in run.balance and "nothing" not in run.balance
    with pytest.raises(KeyError, match="columns are step, time"):
        run.balance["nothing"]


def test_a_dict_runs_as_a_file_does(tmp_path):
    path = stoss.Scene(flying()).write(tmp_path / "files")
    of_file = stoss.run(path, out="file.out")
    of_dict = stoss.run(flying())
    assert np.array_equal(of_file.balance["total"], of_dict.balance["total"])
    assert of_dict.out.is_dir()
    out = of_dict.out
    del of_dict
    assert not out.exists()


def test_overrides_set_parameters_and_keys():
    scene = flying()
    scene["parameters"] = {"young": 1000.0}
    scene["body"][0]["material"]["young"] = "young"
    keys = {"young": 2250.0, "time.end": 0.05, "body[0].density": 2.0, "body.block.angular_velocity": np.array([0.0, 0.0, 1.0])}
    run = stoss.run(scene, overrides=keys)
    assert run.balance["time"][-1] == pytest.approx(0.05)
    # A cube of mass 2 and edge 1 that turns with 1 about its axis, with the consistent mass of its mesh: 1/2 (m/6) w^2.
    assert run.balance["kinetic"][0] == pytest.approx(1 / 6)
    assert scene["time"]["end"] == 0.1
    with pytest.raises(stoss.SceneError, match="one of: block"):
        stoss.check(scene, overrides={"body.ball.density": 1.0})


def test_steps_are_those_of_a_run():
    run = stoss.run(flying())
    with stoss.steps(flying()) as steps:
        assert steps.start.number == 0 and steps.start.positions.shape == (27, 3)
        kept = [(step.time, step.positions, step.velocities, step.balance["total"]) for step in steps]
    times = [time for time, *_ in kept]
    assert np.allclose(times, run.balance["time"][1:]) and len(kept) == 10
    assert [total for *_, total in kept] == list(run.balance["total"][1:])
    # Kept arrays keep their values, and cannot be written.
    assert not np.array_equal(kept[0][1], kept[1][1])
    with pytest.raises(ValueError):
        kept[0][1][0, 0] = 0.0
    assert np.allclose(kept[-1][1], run.frames[-1].positions)


def test_what_a_step_has():
    with stoss.steps(flying()) as steps:
        step = next(steps)
        assert step.number == 1 and step.stage == 1 and step.iterations > 0 and step.dt == pytest.approx(0.01)
        assert step.stresses.shape == (27, 6) and np.isfinite(step.stresses).all()
        assert step.contact is None and not step.contact_forces.any() and not step.reactions.any()
        assert step.bodies == {"block": slice(0, 27)}
        assert np.allclose(step.displacements, step.positions - step.reference)
        positions = step.positions
        momentum = step.balance["angular_momentum"]
        assert momentum.shape == (3,) and not momentum.flags.writeable
        next(steps)
        # It was asked for in time; this was not.
        assert np.array_equal(step.positions, positions)
        with pytest.raises(stoss.OptionError, match="was not asked for before the run went on"):
            step.velocities  # noqa: B018


def test_a_controller_sets_a_load():
    # A force that holds the velocity of the centre at 1: after the start the mean force is that of the mass times the acceleration.
    scene = flying(name="push", set="block.all", body_force=[0.0, 0.0, 0.0])
    scene["body"][0]["angular_velocity"] = [0.0, 0.0, 0.0]
    seen = []

    def controller(step):
        speed = step.balance["linear_momentum"][0]
        step.set("push", [20.0 * (1.0 - speed), 0.0, 0.0])
        seen.append(speed)

    run = stoss.run(scene, overrides={"time.end": 0.5}, steered=["push"], controller=controller)
    assert seen[0] == 0.0 and seen[-1] == pytest.approx(1.0, abs=1e-3)
    assert run.verdict == "sound"
    # Momentum is the integral of the force, which is linear in each step: 10 (1 - p) dt on the mean of both ends.
    forces = [20.0 * (1.0 - speed) for speed in seen]
    p, force = 0.0, 0.0
    for found, new in zip(seen[1:], forces):
        p, force = p + 0.01 * (force + new) / 2, new
        assert found == pytest.approx(p, abs=1e-12)


def test_what_cannot_be_set_is_named():
    scene = flying(name="push", set="block.all", body_force=[0.0, 0.0, 0.0])
    with pytest.raises(stoss.OptionError, match="known are: push"):
        stoss.steps(scene, steered=["pull"])
    with stoss.steps(scene) as steps, pytest.raises(stoss.OptionError, match="name it before the run starts"):
        steps.set("push", [0.0, 0.0, 1.0])
    with stoss.steps(scene, steered=["push"]) as steps:
        with pytest.raises(stoss.OptionError, match="1 values were given, and it has 3"):
            steps.set("push", 1.0)
        assert steps.start.get("push").shape == (3,)


def test_a_loop_that_is_left_can_be_resumed():
    whole = stoss.run(flying(), out="whole")
    for step in stoss.steps(flying(), out="part"):
        if step.number == 4:
            break
    part = stoss.Run("part")
    assert part.outcome == "stopped" and part.balance["step"][-1] == 4
    resumed = stoss.run(flying(), out="part", resume=True)
    assert resumed.outcome == "completed"
    assert np.array_equal(whole.balance["total"], resumed.balance["total"])
    with pytest.raises(stoss.ResumeError, match="without resume=True"):
        stoss.run(flying(), out="part", resume=True, overrides={"body[0].density": 3.0})


def test_ctrl_c_ends_after_a_step():
    code = f"""
    import stoss, sys
    sys.path.insert(0, {os.path.dirname(__file__)!r})
    from conftest import flying
    try:
        for step in stoss.steps(flying(end=1000.0), out="out"):
            if step.number == 3:
                print("running", flush=True)
    except stoss.Interrupted as stopped:
        print(stopped.run.outcome, stopped, flush=True)
    """
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(code)], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline().strip() == "running"
    process.send_signal(signal.SIGINT)
    told, _ = process.communicate(timeout=60)
    assert process.returncode == 0 and told.startswith("interrupted ended after step"), told
    last = stoss.Run("out").balance["step"][-1]
    assert last >= 3
    resumed = stoss.run(flying(end=1000.0), out="out", resume=True, until=0.01 * (last + 5))
    assert resumed.balance["step"][-1] == last + 5
    # Nothing else catches Ctrl-C afterwards.
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_the_interpreter_is_free_while_a_step_is_computed(scenes):
    ticks, done = [], threading.Event()

    def tick():
        while not done.wait(0.001):
            ticks.append(1)

    thread = threading.Thread(target=tick)
    with stoss.steps(scenes / "ball-plate.toml", out="ball.out") as steps:
        next(steps)
        thread.start()
        before = len(ticks)
        next(steps)
        during = len(ticks) - before
        done.set()
    thread.join()
    assert during > 3


def test_errors_are_those_of_the_program(tmp_path):
    scene = flying()
    scene["body"][0]["density"] = -1.0
    scene["body"][0]["material"]["poison"] = 0.3
    with pytest.raises(stoss.SceneError, match="density") as caught:
        stoss.check(scene)
    problems = {problem.key: problem for problem in caught.value.problems}
    density = problems["body[0].density"]
    assert density.line > 1 and "positive" in density.message and density.remedy
    assert isinstance(caught.value, (stoss.StossError, ValueError))
    with pytest.raises(stoss.OutputError, match="nowhere.toml"):
        stoss.run("nowhere.toml")
    with pytest.raises(stoss.OptionError, match=r"until=3"):
        stoss.run(flying(), until=3.0)
    with pytest.raises(TypeError, match=r"body\[0\].density: a object"):
        stoss.check({**scene, "body": [{"density": object()}]})
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "summary.json").write_text("mine")
    with pytest.raises(stoss.OutputError, match="overwrite=True"):
        stoss.run(flying(), out="out")


def test_a_failed_run_says_why():
    # A load far beyond what the block can take, at once.
    scene = flying(set="block.top", traction=[0.0, 0.0, -1e9])
    scene["scene"]["kind"] = "quasi-static"
    scene["time"].pop("integrator")
    scene["body"][0].pop("angular_velocity")
    scene["prescribe"] = [{"set": "block.bottom", "components": ["x", "y", "z"], "fixed": True}]
    with pytest.raises(stoss.SimulationError) as caught:
        stoss.run(scene, out="failed")
    assert caught.value.last_step == 0 and caught.value.diagnosis
    assert stoss.Run("failed").outcome == "failed" and stoss.Run("failed").diagnosis["findings"]


def test_check_hands_out_the_plan(scenes):
    plan = stoss.check(scenes / "ball-plate.toml")
    assert "unknowns" in plan and "no problems found" in plan and isinstance(plan.warnings, list)
