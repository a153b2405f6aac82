"""What Python asks of a module: errors, threads, Ctrl-C, memory, pickles."""

import copy
import multiprocessing
import os
import pickle
import resource
import signal
import threading
import time

import numpy as np
import pytest
import taxel

SENSOR = taxel.Sensor()
FIGURE = taxel.Figure("hexagon", side=3, thickness=1)
OUTLINE = taxel.Outline([np.array([[0, 0], [6, 0], [6, 4.5]]), {"cx": 4.5, "cy": 1.5, "rx": 0.5, "ry": 1}], pitch=2.5)
MASK = SENSOR.touch(FIGURE, x0=4, y0=4)
MODEL = taxel.train([FIGURE], positions=2, angle="0:50:10")
FRAMES = np.zeros((2, 4, 4))

WRONG = [
    (lambda: taxel.Sensor(65), "columns: 65 is above 64"),
    (lambda: taxel.Sensor(2.5), "columns: 2.5 is not a whole number"),
    (lambda: taxel.Sensor(threshold=0), "threshold: 0 is not above 0"),
    (lambda: taxel.Sensor(pitch=np.nan), "pitch_mm: NaN is not a number"),
    (lambda: taxel.Figure("circle", radius=3), "circle"),
    (lambda: taxel.Figure("hexagon"), "side: missing"),
    (lambda: taxel.Figure("hexagon", side=3, width=2), "width"),
    (lambda: taxel.Figure("hexagon", side=65), "side: 65 is above 64"),
    (lambda: taxel.Figure("hexagon", side=np.nan), "not a number"),
    (lambda: taxel.Figure("hexagon", side=3, x0=1), "x0"),
    (lambda: taxel.Picture(np.ones((3, 3))), "expected an imprint: an array of bool"),
    (lambda: taxel.Picture(np.ones((3, 65), bool)), r"shaped \(3, 65\)"),
    (lambda: taxel.Picture(np.ones((2, 3, 3), bool)), "expected one"),
    (lambda: taxel.Outline([[(0, 0), (1, 1)]]), "2 points, expected at least 3"),
    (lambda: taxel.Outline([[(0, 0), (4, 4), (4, 0), (0, 4)]]), "cross"),
    (lambda: taxel.Outline([[(0, 0), (1, 0), (1, 1)]], pitch=0), "pitch_mm: 0 is not above 0"),
    (lambda: SENSOR.touch(FIGURE, x0=17), "x0: 17 is above 16"),
    (lambda: SENSOR.touch(FIGURE, x0=np.nan), "x0: NaN is not a number"),
    (lambda: SENSOR.touch(FIGURE, x0=[1, 2, np.nan, 99]), "element 2: x0: NaN is not a number"),
    (lambda: SENSOR.touch(FIGURE, x0="1"), "x0: found an array of <U1, expected numbers"),
    (lambda: SENSOR.touch(FIGURE, x0=[1j]), "expected numbers"),
    (lambda: SENSOR.touch(FIGURE, x0=[1, 2], y0=[1, 2, 3]), "broadcast"),
    (lambda: SENSOR.touch(FIGURE, zoom_x=2), "zoom_x: a parameter that the hexagon does not have"),
    (lambda: SENSOR.touch(FIGURE, turn=2), 'parameter "turn" is unknown'),
    (lambda: SENSOR.touch(taxel.Figure("hexagon", side=20)), "side: 20 is above 16"),
    (lambda: taxel.Sensor(4, 4).touch(OUTLINE, zoom_x=3), "longer than the sensor"),
    (lambda: taxel.describe(MASK.astype(int)), "an array of int64"),
    (lambda: taxel.describe(MASK[0]), r"shaped \(16,\)"),
    (lambda: SENSOR.sweep(FIGURE, x0="5:6"), 'x0: "5:6" is not a range'),
    (lambda: SENSOR.sweep(FIGURE, x0=99), "x0: 99 is above 16"),
    (lambda: SENSOR.sweep(FIGURE, anchor="edge"), 'anchor "edge"'),
    (lambda: taxel.train([]), "0 shapes, expected 1 to"),
    (lambda: taxel.train([FIGURE, FIGURE]), "hexagon"),
    (lambda: taxel.train([FIGURE], positions=3), "positions: expected 1, 2, 4"),
    (lambda: taxel.train([FIGURE], SENSOR, x0=0, y0="0:14:1", positions=1), "cuts off"),
    (lambda: MODEL.recognise(MASK, noise=0.5), "noise 0.5"),
    (lambda: MODEL.recognise(MASK, noise=0, tolerance=2), "noise=0"),
    (lambda: MODEL.recognise(MASK, reject=2), "reject 2: expected a probability"),
    (lambda: MODEL.recognise(MASK, dead=MASK[1:]), r"dead is shaped \(15, 16\), the imprint \(16, 16\)"),
    (lambda: MODEL.separate(scale="1", pitch="1"), "expected a range as scale, or as pitch"),
    (lambda: taxel.threshold(FRAMES), "expected one rule"),
    (lambda: taxel.threshold(FRAMES, at_least=1, percent=5), "expected one rule"),
    (lambda: taxel.threshold(FRAMES, percent=101), "percent: 101 is out of range"),
    (lambda: taxel.threshold(FRAMES, deviations=3), "needs a tare"),
    (lambda: taxel.threshold(FRAMES, at_least=1, tare=FRAMES[:, 1:]), "the tare has 4 columns and 3 rows"),
    (lambda: taxel.threshold(np.zeros((65, 4)), at_least=1), "64"),
    (lambda: taxel.threshold(FRAMES[0, 0], at_least=1), r"shaped \(4,\)"),
    (lambda: taxel.threshold(FRAMES.astype(str), at_least=1), "expected numbers"),
    (lambda: taxel.read(__file__), "test_module.py: "),
    (lambda: taxel.load(__file__), "test_module.py: "),
    (lambda: taxel.read(__file__, rows=4), "rows and columns are given together"),
    (lambda: taxel.Outline.read(__file__), "test_module.py: "),
    (lambda: taxel.watch(__file__, baud=9600), "baud has no effect"),
    (lambda: taxel.watch(__file__, format="morse"), 'format "morse" is unknown'),
    (lambda: next(taxel.watch("empty", once=True)), "empty: "),
    (lambda: SENSOR.sweep(FIGURE, angle=0, x0=5, y0=5).save("atlas.txt"), "expected a name that ends in"),
]


@pytest.mark.parametrize(("call", "sentence"), WRONG)
def test_a_wrong_value_is_a_value_error_that_says_what_is_expected(call, sentence):
    open("empty", "w").close()
    with pytest.raises(ValueError, match=sentence):
        call()


@pytest.mark.parametrize("call", [taxel.read, taxel.load, taxel.Outline.read, taxel.watch])
def test_a_missing_file_is_a_file_not_found_error(call):
    with pytest.raises(FileNotFoundError, match="none.npz: "):
        call("none.npz")
    with pytest.raises(OSError, match="none/model.npz: cannot write"):
        MODEL.save("none/model.npz")


def test_what_is_no_shape_is_a_type_error_and_what_is_too_large_a_memory_error():
    with pytest.raises(TypeError, match="Shape"):
        SENSOR.touch("hexagon")
    with pytest.raises((MemoryError, ValueError)):
        SENSOR.touch(FIGURE, x0=np.broadcast_to(1.0, (1 << 40,)))


def test_a_damaged_recording_gives_the_frames_before_the_damage(folder):
    (folder / "cut.csv").write_text("r0c0,r0c1,r1c0,r1c1\n1,2,3,4\n5,6,7,8\n9,x,1,2\n")
    with pytest.raises(ValueError, match="line 4") as caught:
        taxel.read("cut.csv")
    assert caught.value.recording.frames.tolist() == [[[1, 2], [3, 4]], [[5, 6], [7, 8]]]


@pytest.mark.parametrize("own", [SENSOR, taxel.Sensor(20, 10, 0.3, pitch=2.5), FIGURE, taxel.Picture(MASK), OUTLINE])
def test_a_copy_and_a_pickle_are_equal_and_a_repr_says_what_it_is(own):
    for other in (copy.deepcopy(own), *(pickle.loads(pickle.dumps(own, protocol)) for protocol in range(2, 6))):
        assert other == own and repr(other) == repr(own) and type(other) is type(own)
    assert own != taxel.Figure("hexagon", side=2) and type(own).__name__ in repr(own)
    if isinstance(own, (taxel.Sensor, taxel.Figure)):
        assert eval(repr(own), vars(taxel)) == own


def test_a_picture_leaves_its_own_imprint_and_weights_and_lists_name_shapes():
    assert (SENSOR.touch(taxel.Picture(MASK)) == MASK).all()
    model = taxel.train({"a": FIGURE, "b": taxel.Figure("hexagon", side=3)}, positions=2, angle=0, weights={"a": 3})
    assert model.confusion().sum(axis=1).tolist() == [12, 4]
    assert repr(MODEL) == "<taxel.Model: hexagon>" and MODEL.recognise(MASK).name == "hexagon"
    empty = MODEL.recognise(np.zeros((16, 16), bool))
    assert (empty.name, empty.fit, empty.pose) == (None, None, None)
    assert MODEL.recognise(MASK[None, :, :][:0]) == []


def test_arrays_in_any_layout_give_the_same(folder):
    stack = np.stack([MASK, MASK.T, ~MASK])
    assert taxel.describe(stack[::-1, ::-1]) == [taxel.describe(own[::-1]) for own in stack[::-1]]
    assert taxel.describe(np.asfortranarray(stack)) == taxel.describe(stack)
    frames = np.arange(48).reshape(3, 4, 4)
    same = [frames, frames.astype(">f4"), np.asfortranarray(frames), frames.tolist()]
    for other in same:
        assert (taxel.threshold(other, at_least=20) == (frames >= 20)).all()
    gap = np.array([[np.nan, 5], [5, np.inf]])
    assert taxel.threshold(gap, at_least=1).tolist() == [[False, True], [True, False]]


ANGLES = np.tile(np.arange(360.0), 8000)
LONG = {
    "touch": lambda: SENSOR.touch(FIGURE, x0=5, y0=5, angle=ANGLES),
    "sweep": lambda: SENSOR.sweep(FIGURE, angle="0:359.999:0.001"),
    "train": lambda: taxel.train([FIGURE], angle="0:359.999:0.001"),
    "watch": lambda: next(taxel.watch("fifo")),
}


@pytest.mark.parametrize("work", LONG)
def test_ctrl_c_stops_long_work_while_other_threads_run(folder, work):
    os.mkfifo("fifo")
    ticks, begun = [], time.monotonic()

    def interrupt():
        while time.monotonic() < begun + 0.5:
            ticks.append(time.monotonic())
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        LONG[work]()
    took = time.monotonic() - begun
    thread.join()
    assert took < 2, "it stops within a fraction of a second"
    assert len(ticks) > 5, "the interpreter is free meanwhile"


def test_threads_and_processes_touch_side_by_side():
    angles = np.arange(0, 360, 0.5)
    expected = SENSOR.touch(FIGURE, x0=4, y0=4, angle=angles)
    found = [None] * 8

    def touch(number):
        one = np.array([SENSOR.touch(FIGURE, x0=4, y0=4, angle=angle) for angle in angles[:50]])
        found[number] = SENSOR.touch(FIGURE, x0=4, y0=4, angle=angles)
        assert (one == expected[:50]).all()

    threads = [threading.Thread(target=touch, args=(number,)) for number in range(len(found))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((own == expected).all() for own in found)
    # A child made by fork has none of its parent's threads.
    with multiprocessing.get_context("fork").Pool(2) as pool:
        for own in pool.map_async(several, [angles] * 4).get(timeout=60):
            assert (own == expected).all()


def several(angles):
    return SENSOR.touch(FIGURE, x0=4, y0=4, angle=angles)


def test_a_million_touches_leave_nothing_behind():
    def touches(count):
        for number in range(count):
            SENSOR.touch(FIGURE, x0=4, y0=4, angle=number % 360)
        taxel.describe(SENSOR.touch(OUTLINE, angle=np.arange(360)))
        MODEL.recognise(MASK)
        with pytest.raises(ValueError):
            SENSOR.touch(FIGURE, x0=99)

    touches(50_000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    touches(1_000_000)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert grown < 4096, f"{grown} KiB, which is four bytes a touch"


def test_a_live_source_is_closed_at_its_end(folder):
    os.mkfifo("fifo")

    def write():
        with open("fifo", "w") as stream:
            for value in range(5):
                print(value, value, value, value, file=stream, flush=True)
            print("1 2 3", file=stream)

    threading.Thread(target=write).start()
    with taxel.watch("fifo", format="lines", rows=2, columns=2) as watch:
        frames = list(watch)
    assert [frame.values[0, 0] for frame in frames] == [0, 1, 2, 3, 4]
    assert [frame.number for frame in frames] == list(range(5)) and watch.dropped == 1
    watch = taxel.watch("fifo")
    watch.close()
    assert list(watch) == []
