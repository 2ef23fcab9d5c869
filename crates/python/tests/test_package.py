"""The package as a user meets it: calls, errors, models, cars, figures, the command."""

import inspect
import json
import re
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import maveric
from maveric import stats

CELLS = {"id": list("aabbccdd"), "w": list("xyxyxyxy"), "v": [1, 3, 2, 5, 2, 4, 3, 4.5]}


def command(*words, folder=None, ok=True):
    program = Path(sys.executable).with_name("maveric")
    ran = subprocess.run([program, *words], cwd=folder, capture_output=True, text=True, check=False)
    assert (ran.returncode == 0) is ok, ran.stderr
    return ran


def test_a_call_gives_what_the_command_gives(tmp_path):
    file = tmp_path / "d.csv"
    rows = zip(*CELLS.values())
    file.write_text("id,w,v\n" + "\n".join(",".join(map(str, row)) for row in rows))
    flags = ["--subject", "id", "--within", "w", "--value", "v"]
    for test in ["within", "compare", "posthoc", "friedman", "rm-anova"]:
        printed = command("stats", test, str(file), *flags).stdout.splitlines()
        written = json.loads(command("stats", test, str(file), *flags, "--format", "json").stdout)
        found = getattr(stats, test.replace("-", "_"))(CELLS, subject="id", within="w", value="v")
        assert found.report == printed
        assert found.warnings == written.pop("warnings")
        assert found.to_dict() == written


def test_every_call_of_the_command_is_a_function_with_its_flags():
    listed = command("stats", "--help").stdout.split("Commands:")[1].split("Options:")[0]
    calls = set(re.findall(r"^  ([a-z][a-z-]+) ", listed, re.M)) - {"help", "study"}
    assert len(calls) > 15
    for call in calls:
        said = command("stats", call, "--help").stdout.split("Options:", 1)[1]
        flags = set(re.findall(r"^ +(?:-\w, )?--([a-z][a-z-]*)", said, re.M))
        # How it is printed is the command's alone; not every table has conditions.
        flags -= {"help", "version", "style", "format", "apa", "latex", "markdown", "wide"}
        known = inspect.signature(getattr(stats, call.replace("-", "_"))).parameters
        # `with` is a word of the language.
        named = {name.rstrip("_") for name, p in known.items() if p.kind is p.KEYWORD_ONLY}
        assert flags == named - {"wide"}, call


def test_a_result_has_attributes_text_and_html():
    found = stats.within(CELLS, subject="id", within="w", value="v")
    assert found.n == 4 and found["k"] == 2 and "paired" in found
    assert 0 < found.paired["x|y"].p < 0.05
    assert "4 subjects" in repr(found) or "n = 4" in repr(found) or len(repr(found)) > 100
    assert found._repr_html_().startswith("<pre ") and "<b" not in found._repr_html_()
    with pytest.raises(AttributeError, match="no_such"):
        found.no_such


def test_what_is_refused_raises_the_commands_words():
    with pytest.raises(maveric.Error, match="did you mean|nearest|`vv`"):
        stats.within(CELLS, subject="id", within="w", value="vv")
    with pytest.raises(maveric.Error, match="two values"):
        stats.within({"id": ["a", "a"], "w": ["x", "x"], "v": [1, 2]}, subject="id", within="w", value="v")
    with pytest.raises(maveric.Error, match="finite"):
        stats.normality({"v": [1.0, float("nan")]}, value="v")
    with pytest.raises(maveric.Error, match="--adjust"):
        stats.posthoc(CELLS, subject="id", within="w", value="v", adjust="holmm")


def test_rows_and_columns_are_chosen_as_by_the_command(tmp_path):
    wide = {"a": [1, 2, 2, 3], "b": [3, 5, 4, 4.5], "who": [1, 1, 1, 2]}
    assert stats.within(wide, wide=["a", "b"]).n == 4
    assert stats.within(wide, wide=["a", "b"], where={"who": 1}).n == 3
    assert stats.groups(wide, wide=["a", "b"], group="condition", value="value").to_dict()["desc"].keys() == {"a", "b"}
    assert stats.normality(wide, wide=["a", "b"], value="value", group="condition", where={"who": 1})
    figure = tmp_path / "f.svg"
    stats.compare(wide, wide=["a", "b"], figure=figure)
    assert "<svg" in figure.read_text()


def people(count=8, seconds=300):
    def planner(mps, gap_s):
        def plan(scene):
            free = scene["lead_id"] is None or scene["lead_dx_m"] <= 0
            wish = "stay"
            near = scene["lead_dx_m"] < gap_s * scene["ego"][3]
            if not free and near and mps > scene["lead_speed_mps"] and scene["lane"] == 0:
                wish = "move_out"
            elif scene["lane"] > 0 and scene["lead_dx_m"] < -25:
                wish = "move_back"
            return mps, gap_s * scene["ego"][3], wish

        return plan

    driven = [
        maveric.simulate(planner(25 + i, 2.2 - 0.15 * i), duration_s=seconds, seed=i, name=f"P{i}") for i in range(count)
    ]
    return [d.drive for d in driven]


@pytest.fixture(scope="module")
def trained():
    drives = people()
    scores = {f"P{i}": 15.0 + 5 * i for i in range(8)}
    return drives, maveric.Model.train(drives, scores)


def test_the_dial_turns_in_points_of_the_scores_own_scale(trained, tmp_path):
    drives, model = trained
    sixth = maveric.Model.train(drives, {f"P{i}": 1 + (4.0 + 5 * i) / 44 * 5 for i in range(8)}, score_range=(1, 6))
    own, same = model.personalize(drives[4]), sixth.personalize(drives[4])
    assert same.embedding == pytest.approx(own.embedding, abs=1e-6)
    assert same.aggression == pytest.approx(1 + (own.aggression - 11) / 44 * 5)
    assert same.dial(1).embedding == pytest.approx(own.dial(8.8).embedding, abs=1e-6)
    sixth.save(tmp_path / "m")
    again = maveric.Model.load(tmp_path / "m")
    assert again.personalize(drives[4]).dial(1).aggression == pytest.approx(same.aggression + 1)
    on_adb = maveric.Model.load(tmp_path / "m", score_range=(11, 55))
    assert on_adb.personalize(drives[4]).aggression == pytest.approx(own.aggression)
    with pytest.raises(maveric.Error, match="1 to 6"):
        maveric.Model.train(drives, {"P0": 30.0}, score_range=(1, 6))
    with pytest.raises(maveric.Error, match="the lower one first"):
        maveric.Model.train(drives, None, score_range=(6, 1))


def test_a_style_outside_the_scale_has_no_score_and_says_that_it_is_beyond(trained):
    drives, model = trained
    own = model.personalize(drives[4])
    assert 11 <= own.aggression <= 55
    # Of a drive that shows few habits eight people can say whether they have met it; of others they are too few.
    assert own.beyond in (None, False) and own.beyond_why is None
    assert (own.support_p is None) == (own.beyond is None)
    far = [10 * x for x in model.personalize(drives[7]).embedding]
    for style in (model.style(far), model.style([-x for x in far])):
        assert (style.aggression, style.beyond, style.beyond_why) == (None, True, "scale")
        assert "points" not in repr(style)


def test_a_model_orders_drivers_and_the_dial_turns_the_car(trained, tmp_path):
    drives, model = trained
    assert model.knows_aggression and len(model.drivers) == 8
    read = [model.drivers[f"P{i}"].aggression for i in range(8)]
    assert read[0] < read[3] < read[7]
    own = model.personalize(drives[4])
    assert own.embedding == pytest.approx(model.personalize(drives[4], score=None).embedding)
    assert own.dial(8).aggression == pytest.approx(own.aggression + 8)
    speeds = [
        maveric.simulate(own.dial(points), duration_s=300, seed=3).drive.measures()["mean_velocity_mps"]
        for points in (-12, 0, 12)
    ]
    assert speeds[0] < speeds[1] < speeds[2]
    model.save(tmp_path / "m.maveric")
    again = maveric.Model.load(tmp_path / "m.maveric")
    assert again.personalize(drives[4]).embedding == own.embedding
    with pytest.raises(maveric.Error, match="coordinates"):
        model.style([1.0])
    (tmp_path / "no.maveric").write_text("no model")
    with pytest.raises(maveric.Error):
        maveric.Model.load(tmp_path / "no.maveric")


def test_the_same_seed_drives_the_same_and_a_planner_alone_asks_the_same(trained):
    _, model = trained
    style = model.mean_style
    one, two = (maveric.simulate(style, duration_s=60, seed=5) for _ in range(2))
    assert one.drive.signals.to_dict() == two.drive.signals.to_dict()
    planner = maveric.Planner(style)
    asked = planner(0.0, (0, 0.0, 0.0, 25.0, 4.7), [(1, 60.0, 0.0, 22.0, 4.7)])
    assert asked[0] > 20 and asked[1] > 0 and asked[2] in ("stay", "move_out", "move_back")
    with pytest.raises(maveric.Error, match="finite"):
        planner(0.05, (0, float("nan"), 0.0, 25.0, 4.7), [])


def test_a_style_drives_in_a_world_that_python_moves(trained):
    _, model = trained
    lead = {"x": 90.0}

    def world(ego):
        lead["x"] += 22.0 * 0.05
        # One lane: nobody can be passed.
        return [(1, lead["x"], 0.0, 22.0, 4.7), (2, ego[0] + 5.0, 3.66, 22.0, 4.7)]

    driven = maveric.drive_in(world, model.mean_style, duration_s=90)
    assert driven.report["collisions"] == 0
    assert driven.drive.signals.to_dict()["ego_speed_mps"][-1] == pytest.approx(22.0, abs=0.5)


def test_what_a_planner_or_a_world_raises_comes_through():
    def broken(scene):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        maveric.simulate(broken, duration_s=10)
    with pytest.raises(ZeroDivisionError, match="mine"):
        maveric.drive_in(lambda ego: broken(ego), lambda scene: (20.0, 30.0, "stay"), duration_s=10)
    with pytest.raises(maveric.Error, match="jump"):
        maveric.simulate(lambda scene: (20.0, 30.0, "jump"), duration_s=10)
    with pytest.raises(maveric.Error, match="speed_mps"):
        maveric.simulate(lambda scene: (float("nan"), 30.0, "stay"), duration_s=10)
    with pytest.raises(maveric.Error, match="each vehicle once"):
        twice = [(1, 50.0, 0.0, 20.0, 4.7)] * 2
        maveric.drive_in(lambda ego: twice, lambda scene: (20.0, 30.0, "stay"), duration_s=10)


def test_a_world_may_end_the_drive():
    left = iter(range(100))
    driven = maveric.drive_in(lambda ego: [] if next(left, None) is not None else None, lambda s: (25.0, 30.0, "stay"))
    assert len(driven.drive) == 100


def test_other_threads_run_while_a_style_drives(trained):
    _, model = trained
    ticks = []
    done = threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(1)
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    maveric.simulate(model.mean_style, duration_s=3600)
    done.set()
    thread.join()
    assert len(ticks) > 5


def test_a_log_is_read_measured_and_drawn(tmp_path):
    command("init", "--paper", str(tmp_path / "paper"))
    made = ["run", "pipelines/smoke.toml", "generate", "--set", "duration=40"]
    maveric.run(*made[1:3], *made[3:], folder=tmp_path / "paper")
    log = sorted((tmp_path / "paper").rglob("*.mcap"))[0]
    (drive,) = maveric.read_log(log)
    assert drive.rate_hz == 20 and len(drive) > 700 and drive.measures()["mean_velocity_mps"] > 10
    assert drive.plot().svg.startswith("<svg") and drive.plot().png(72)[1:4] == b"PNG"
    with pytest.raises(maveric.Error, match="nowhere"):
        maveric.read_log(tmp_path / "nowhere.mcap")
    with pytest.raises(maveric.Error):
        maveric.run("pipelines/none.toml", folder=tmp_path / "paper")


def test_figures_say_what_they_lack():
    figure = maveric.figures.scatter(x="A", y="B", points=[(1, 2), (2, 3), (3, 5)], test="r", people=[])
    assert figure.title and figure.caption and figure.png()[1:4] == b"PNG"
    with pytest.raises(maveric.Error, match="missing field `people`"):
        maveric.figures.scatter(x="A", y="B", points=[(1, 2)], test="r")
    with pytest.raises(AttributeError, match="no figure"):
        maveric.figures.pie
    with pytest.raises(maveric.Error, match="no field `colour`"):
        maveric.figures.scatter(x="A", y="B", points=[(1, 2), (2, 3)], test="", people=[], colour="red")
    with pytest.raises(maveric.Error, match="NaN"):
        maveric.figures.scatter(x="A", y="B", points=[(1, float("nan"))], test="", people=[])
    assert "synthetic" in maveric.figures.draw(
        "scatter", synthetic=3, x="A", y="B", points=[(1, 2), (2, 3)], test="", people=[]
    ).caption.lower()


def test_conditions_of_ones_own_have_their_labels_and_colours():
    panel = {
        **{"title": "Speed", "axis": "Speed (m/s)", "conditions": ["truck", "bus"], "omnibus": ""},
        "rows": [[20, 25], [21, 26], [19, 27], [22, 25]],
        "pairs": [{"first": "truck", "second": "bus", "p_holm": 0.01}],
    }
    draw = maveric.figures.difference_panels
    drawn = draw(conditions=[{"id": "truck", "label": "Lorry", "color": "#123456"}, {"id": "bus"}], panels=[panel])
    assert "Lorry" in drawn.svg and "#123456" in drawn.svg.lower()
    assert "Lorry" not in draw(panels=[panel]).svg
    with pytest.raises(maveric.Error, match="color"):
        draw(conditions=[{"id": "truck", "color": "blueish"}], panels=[panel])


def test_every_figure_says_what_it_needs():
    for name in maveric.figures.names:
        with pytest.raises(maveric.Error, match="missing field"):
            getattr(maveric.figures, name)()


def test_sheets_are_scored_and_impossible_answers_named():
    sheets = {"participant": ["P1", "P2"], **{f"adb_{i}": [3, None if i == 1 else 5] for i in range(1, 12)}}
    table, warnings = maveric.score(sheets, "adb")
    rows = dict(zip(zip(*(table.to_dict()[c] for c in ("participant", "score"))), table.to_dict()["value"]))
    assert rows[("P1", "adb.total")] == 33 and rows[("P2", "adb.total")] == 55
    with pytest.raises(maveric.Error, match="P1"):
        maveric.score({**sheets, "adb_3": [9, 5]}, "adb")
    with pytest.raises(maveric.Error):
        maveric.score(sheets, "no_such_scale")


def test_the_command_is_the_program(tmp_path):
    assert command("--version").stdout.startswith(f"maveric {maveric.__version__}")
    assert "maveric init" in command("run", folder=tmp_path, ok=False).stderr
    by_module = subprocess.run([sys.executable, "-m", "maveric", "cite"], capture_output=True, text=True, check=True)
    assert by_module.stdout == command("cite").stdout


@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends no SIGINT to one process")
def test_ctrl_c_ends_a_long_call_and_python_goes_on():
    import signal

    text = (
        "import maveric\n"
        "print('begun', flush=True)\n"
        "try:\n"
        "    while True:\n"
        "        maveric.simulate(lambda scene: (27.0, 40.0, 'stay'), duration_s=3600)\n"
        "except KeyboardInterrupt:\n"
        "    print('ended')\n"
    )
    with subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None and child.stdout.readline() == "begun\n"
        time.sleep(1)
        child.send_signal(signal.SIGINT)
        assert child.stdout.readline() == "ended\n"
