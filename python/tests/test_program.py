"""The module answers as the program does on the same input."""

import os
import signal
import subprocess
import time

import numpy as np
import pytest
import taxel
from conftest import PROGRAM

RANDOM = np.random.default_rng(55)
RINGS = [[[0, 0], [6, 0], [6, 4], [0, 4]], {"cx": 2, "cy": 2, "rx": 1, "ry": 0.8, "angle": 30}]
PICTURE = ["##.", "###"]
SHAPES = [
    ({"figure": "hexagon"}, {"side": 3, "thickness": 1}),
    ({"figure": "ellipse"}, {"radius_x": 4, "radius_y": 2.5}),
    ({"figure": "rectangle"}, {"length": 6, "width": 3}),
    ({"picture": PICTURE}, {"zoom_x": 1.5, "zoom_y": 2}),
    ({"outline": RINGS}, {"zoom_x": 1.2, "zoom_y": 1}),
]
GRID = {"x0": "7:7.8:0.2", "y0": "7:7.8:0.2", "angle": "0:355:5"}
FLAGS = [text for axis, given in GRID.items() for text in (f"--{axis}", given)]


def mask_of(rows):
    return np.array([[taxel == "#" for taxel in row] for row in rows])


def shape_of(keys, sizes):
    if "figure" in keys:
        return taxel.Figure(keys["figure"], **sizes)
    return taxel.Picture(mask_of(keys["picture"])) if "picture" in keys else taxel.Outline(keys["outline"])


@pytest.mark.parametrize(("keys", "sizes"), SHAPES)
def test_touches_and_descriptors_are_those_of_batch(program, keys, sizes):
    poses = [dict(zip(("x0", "y0", "angle"), pose)) for pose in RANDOM.uniform([-2, -2, 0], [12, 12, 360], (40, 3)).tolist()]
    # Ties, which only exact arithmetic decides.
    poses += [{"x0": 4.5, "y0": 3.25, "angle": angle} for angle in (0, 30, 45, 90)]
    own = {"columns": 20, "rows": 12, "threshold": 0.4}
    answers = program("batch", lines=[{**keys, **sizes, **pose, "sensor": own} for pose in poses])
    sensor, shape = taxel.Sensor(**own), shape_of(keys, sizes)
    zooms = {} if "figure" in keys else sizes
    masks = sensor.touch(shape, **zooms, **{key: [pose[key] for pose in poses] for key in poses[0]})
    assert masks.shape == (44, 12, 20) and masks.dtype == bool
    assert [mask_of(answer["imprint"]).tolist() for answer in answers] == masks.tolist()
    assert [answer["regions"] for answer in answers] == taxel.describe(masks)
    for mask, answer, pose in zip(masks, answers, poses):
        assert (sensor.touch(shape, **zooms, **pose) == mask).all()
        assert taxel.describe(mask) == answer["regions"]


def test_coverages_add_up_to_the_area_and_decide_the_imprint():
    sensor, disc = taxel.Sensor(), taxel.Figure("ellipse", radius_x=3, radius_y=3)
    cover = sensor.coverage(disc, x0=np.linspace(1, 9, 7), y0=4)
    assert np.allclose(cover.sum(axis=(1, 2)), 9 * np.pi, atol=1e-9)
    assert ((cover >= 0.5) == sensor.touch(disc, x0=np.linspace(1, 9, 7), y0=4)).all()


def test_arrays_are_broadcast_as_numpy_does():
    sensor, figure = taxel.Sensor(9, 7), taxel.Figure("triangle", side=3)
    x0, angle, side = np.arange(3.0), np.array([[0], [90]]), np.float32(2.5)
    masks = sensor.touch(figure, x0=x0, angle=angle, side=side)
    assert masks.shape == (2, 3, 7, 9)
    assert (masks[1, 2] == sensor.touch(taxel.Figure("triangle", side=2.5), x0=2, y0=0, angle=90)).all()
    assert sensor.touch(figure, x0=[]).shape == (0, 7, 9)


def test_an_atlas_is_that_of_sweep(program, folder):
    (summary,) = program("sweep", "hexagon", "--side", 3, *FLAGS, "--anchor", "centre", "--json", "--atlas", "theirs.npz", "--quiet")
    atlas = taxel.Sensor().sweep(taxel.Figure("hexagon", side=3), **GRID, anchor="centre")
    atlas.save("own.npz")
    assert (folder / "own.npz").read_bytes() == (folder / "theirs.npz").read_bytes()
    assert atlas.statistics() == summary["descriptors"]
    assert (len(atlas.imprints), atlas.counts.sum()) == (summary["distinct"], summary["poses"])
    theirs, loaded = np.load("theirs.npz"), taxel.load("theirs.npz")
    for key, values in atlas.descriptors.items():
        assert np.array_equal(values, theirs[key], equal_nan=True), key
    assert (loaded.imprints == atlas.imprints).all() and atlas.imprints is atlas.imprints
    words = (atlas.imprints << np.arange(16, dtype=np.uint64)).sum(axis=2)
    assert (words == theirs["rows"]).all()


@pytest.mark.parametrize("given", [{}, {"noise": 0.02, "tolerance": 1}, {"noise": 0}, {"reject": 0.9}])
def test_models_and_answers_are_those_of_train_and_recognise(program, folder, given):
    shapes = {f"shape {number}": shape for number, shape in enumerate(SHAPES)}
    lines = [
        {"name": name, **keys, **({} if "zoom_x" in sizes else sizes)} for name, (keys, sizes) in shapes.items()
    ]
    (folder / "set.jsonl").write_text("".join(f"{line}\n".replace("'", '"') for line in lines))
    (limit,) = program("model", "train", "set.jsonl", "--positions", 5, "--angle", "0:355:5", "--out", "theirs.npz", "--json", "--quiet")
    model = taxel.train({name: shape_of(*shape) for name, shape in shapes.items()}, positions=5, angle="0:355:5")
    model.save("own.npz")
    assert (folder / "own.npz").read_bytes() == (folder / "theirs.npz").read_bytes()
    assert model.error == limit["error"] and model.labels == list(shapes)
    (confusion,) = program("model", "confusion", "own.npz", "--json")
    assert model.confusion().tolist() == confusion["confusion"]

    masks = model.sensor.touch(shape_of(*SHAPES[0]), x0=RANDOM.uniform(5, 6, 12), y0=5.3, angle=RANDOM.uniform(0, 360, 12))
    masks[3:] ^= RANDOM.random(masks[3:].shape) < 0.01
    rows = [["".join(".#"[taxel] for taxel in row) for row in mask.astype(int)] for mask in masks]
    flags = [text for key, value in given.items() for text in (f"--{key}", value)]
    answers = program("recognise", "-", "--model", "own.npz", *flags, lines=[{"imprint": own} for own in rows])
    for answer, own in zip(answers, taxel.load("theirs.npz").recognise(masks, **given), strict=True):
        fit = answer["fit"]
        assert (own.name, own.state, own.at_rim) == (answer["answer"], answer["state"], answer["at_rim"])
        assert own.ranking == [(rank["name"], rank["probability"]) for rank in answer["ranking"]]
        assert (own.fit, own.differs) == ((fit["name"], fit["differs"]) if fit else (None, None))
        assert own.pose == ({key: fit[key] for key in fit if key not in ("name", "differs")} if fit else None)


def test_dead_taxels_are_left_out(program, folder):
    model = taxel.train([taxel.Figure("hexagon", side=3), taxel.Figure("triangle", side=5)], positions=5, angle="0:355:5")
    model.save("model.npz")
    mask = model.sensor.touch(taxel.Figure("hexagon", side=3), x0=5, y0=5)
    dead = np.zeros_like(mask)
    dead[6:8, 6:8] = True
    np.save("mask.npy", dead)
    np.save("touch.npy", mask & ~dead)
    (answer,) = program("recognise", "touch.npy", "--model", "model.npz", "--mask", "mask.npy", "--json")
    own = model.recognise(mask & ~dead, dead=dead)
    assert (own.name, own.differs) == (answer["answer"], 0) == ("hexagon", answer["fit"]["differs"])


def test_separation_is_that_of_separate(program):
    model = taxel.train([taxel.Figure("rectangle", length=4, width=3), taxel.Figure("hexagon", side=2)], positions=4, angle="0:355:5")
    model.save("model.npz")
    for flags in ({"scale": "1:2:0.5"}, {"pitch": "0.5:1:0.25", "threshold": 0.4}):
        named = [text for key, value in flags.items() for text in (f"--{key}", value)]
        (theirs,) = program("model", "separate", "model.npz", *named, "--json", "--quiet")
        own = model.separate(**flags)
        keys = theirs["points"][0].keys()
        assert [{key: point[key] for key in keys} for point in own] == theirs["points"]


def test_outlines_are_read_as_by_the_program(program, samples):
    (theirs,) = program("picture", "parts/cam.svg", "--pitch", 2.5, "--x0", 3, "--y0", 2, "--angle", 20, "--json")
    part = taxel.Outline.read("parts/cam.svg", pitch=2.5)
    assert (taxel.Sensor().touch(part, x0=3, y0=2, angle=20) == mask_of(theirs["imprint"])).all()
    # On a sensor with another pitch, it has another size.
    finer = taxel.Sensor(32, 32, pitch=1.25)
    assert finer.coverage(part, x0=4, y0=4).sum() == pytest.approx(4 * taxel.Sensor().coverage(part, x0=2, y0=2).sum())


RULES = [{"at_least": 10}, {"percent": 25, "least": 3}, {"low": 5, "high": 20}, {"deviations": 5}]


@pytest.mark.parametrize("rule", RULES)
def test_imprints_of_frames_are_those_of_frames(program, samples, rule):
    flags = [text for key, value in rule.items() for text in (f"--{key.replace('_', '-')}", value)]
    answers = program("frames", "recording.csv", "--all", "--tare", 3, *flags, "--json")
    recording = taxel.read("recording.csv")
    assert recording.frames.shape == (len(answers), 16, 16)
    assert recording.times.tolist() == [answer["time"] for answer in answers]
    masks = taxel.threshold(recording.frames, **rule, tare=recording.frames[:3])
    assert [mask_of(answer["imprint"]).tolist() for answer in answers] == masks.tolist()
    if rule == RULES[0]:
        (listed,) = program("frames", "recording.csv", "--json")
        channel = listed["channels"][0]
        assert (recording.channel, recording.unit, recording.pitch) == (channel["name"], channel["unit"], channel["pitch_mm"])
        watched = list(taxel.watch("recording.csv", once=True))
        assert [frame.time for frame in watched] == recording.times.tolist()
        assert (np.array([frame.values for frame in watched]) == recording.frames).all()


def test_labels_channels_and_sizes_are_read_as_asked(folder):
    (folder / "labelled.csv").write_text("1,2,3,4,washer\n5,6,7,8,9\n")
    recording = taxel.read("labelled.csv", rows=2, columns=2, label_column="5")
    assert (recording.labels, recording.times) == (["washer", 9], None)
    assert recording.frames.tolist() == [[[1, 2], [3, 4]], [[5, 6], [7, 8]]]
    np.savez("two.npz", left=np.zeros((3, 2, 2)), right=np.ones((4, 2, 2)))
    assert (taxel.read("two.npz", channel="right").frames == 1).all()
    with pytest.raises(ValueError, match="2 channels, choose one with channel=: left, right"):
        taxel.read("two.npz")
    with pytest.raises(ValueError, match='no channel named "middle"'):
        taxel.read("two.npz", channel="middle")


def test_the_program_ends_on_ctrl_c_as_without_python():
    running = subprocess.Popen([PROGRAM, "frames", "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    time.sleep(2)
    running.send_signal(signal.SIGINT)
    assert running.communicate(timeout=30) == (b"", b"")
    assert running.returncode == -signal.SIGINT


def test_the_program_says_what_is_wrong_and_its_version():
    done = subprocess.run([PROGRAM, "describe", "none.txt"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (1, "") and done.stderr.startswith("error: ")
    done = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
    assert done.returncode == 0 and done.stdout.startswith("taxel ")
