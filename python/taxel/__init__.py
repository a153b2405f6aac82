"""Exact tactile imprints of flat shapes, their descriptors, and what one touch can tell.

Arrays are numpy's: an imprint is bool, rows × columns; frames are float64, frames × rows × columns, NaN where there is
no cell. Lengths are in cells, x to the right, y down; angles in degrees. What is wrong with a value is a ValueError, with
a file an OSError, in the program's words. Long work uses all cores, releases the interpreter and stops on Ctrl-C.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import warnings
from collections import namedtuple
from functools import cached_property

import numpy as np

from . import _taxel

__all__ = [
    "Answer", "Atlas", "Figure", "Frame", "Model", "Outline", "Picture", "Recording", "Sensor", "Watch",
    "describe", "load", "read", "threshold", "train", "watch",
]


def _json(**keys):
    try:
        # Arrays become lists.
        return json.dumps(keys, default=lambda array: array.tolist(), allow_nan=False)
    except ValueError:
        raise ValueError("a length is infinite or not a number") from None


def _numbers(values, what):
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{what}: found an array of {array.dtype}, expected numbers")
    return np.require(array, np.float64, "C")


def _stack(array, most, expected):
    if array.ndim not in (2, 3) or not all(1 <= side <= most for side in array.shape[-2:]):
        raise ValueError(f"found an array of {array.dtype} shaped {array.shape}, expected {expected}")
    return array[None] if array.ndim == 2 else array


def _masks(imprint):
    array = np.asarray(imprint)
    expected = "an imprint: an array of bool, rows × columns from 1 × 1 to 64 × 64, or a stack of them"
    # Of numbers, no size is right.
    return _stack(array, 64 if array.dtype == bool else 0, expected)


def _frames(values, what):
    return _stack(_numbers(values, what), 512, f"{what} × rows × columns, or rows × columns, with 1 to 512 of both")


def _poses(values):
    if all(isinstance(value, (float, int)) for value in values.values()):
        return list(values), np.array([list(values.values())], np.float64), ()
    arrays = np.broadcast_arrays(*(_numbers(value, key) for key, value in values.items()))
    return list(values), np.stack(arrays, -1).reshape(-1, len(arrays)), arrays[0].shape


def _ranges(**ranges):
    return {axis: str(given) for axis, given in ranges.items() if given is not None}


class _Made:
    """What is printed, copied and pickled as the arguments that it was made of."""

    def __getnewargs_ex__(self):
        return (), vars(self)

    def __repr__(self):
        arguments = (f"{key}={value!r}" for key, value in vars(self).items() if value is not None)
        return f"{type(self).__name__}({', '.join(arguments)})"


class Figure(_taxel.Shape, _Made):
    """One of seven figures: Figure(kind, **sizes).

    kind is "ellipse" (radius_x, radius_y), "rectangle" (length, width), or "triangle", "pentagon", "hexagon", "heptagon"
    or "octagon" (side). With thickness it has one concentric hole. Lengths are in cells, above 0, up to 64. A figure
    turns clockwise; x0 and y0 are the top left corner of its bounding rectangle before that.

    Raises ValueError for another kind, or for a size that is missing, foreign or out of range.
    """

    def __new__(cls, kind, **sizes):
        return super().__new__(cls, _json(name=kind, figure=kind, **sizes), None)

    def __init__(self, kind, **sizes):
        vars(self).update(kind=kind, **sizes)


class Picture(_taxel.Shape, _Made):
    """A stored imprint as a shape: Picture(mask).

    mask is a bool array, rows × columns, 1 × 1 to 64 × 64; each active taxel is a square of one cell. A picture is scaled
    by zoom_x and zoom_y about the origin, its place included, and turns counter-clockwise. Without a place it leaves its
    own imprint.
    """

    def __new__(cls, mask):
        if np.ndim(mask) == 3:
            raise ValueError("found a stack of imprints, expected one")
        rows = ["".join(".#"[taxel] for taxel in row) for row in _masks(mask)[0].tolist()]
        return super().__new__(cls, _json(name="picture", imprint=rows), None)

    def __init__(self, mask):
        self.mask = mask


class Outline(_taxel.Shape, _Made):
    """A shape of closed rings: Outline(rings, pitch=None).

    A ring is a polygon, as points (x, y) in a list or an array n × 2, or an ellipse, as a dict with cx, cy, rx, ry and
    perhaps angle. Rings may be nested, but not cross; material lies inside an odd number of them. y runs down. Lengths are
    in cells; with pitch, in mm, and that is the side of a cell in mm. It is placed like a Picture; its own place is the
    origin.

    Raises ValueError for what is no outline.
    """

    def __new__(cls, rings, pitch=None, name="outline"):
        unit = "cells" if pitch is None else "mm"
        return super().__new__(cls, _json(name=name, outline=rings, unit=unit), pitch)

    def __init__(self, rings, pitch=None, name="outline"):
        self.rings, self.pitch, self.name = rings, pitch, name

    @classmethod
    def read(cls, path, *, pitch=None, mm_per_unit=None, y_up=False, flatness=0.001):
        """Reads an SVG, or points as CSV.

        What is in mm is divided by pitch, the side of a cell in mm. mm_per_unit is the size of a unit in mm where the
        file does not say it (default: a unit is a cell); y_up is for points from CAD; curves become chords at most
        flatness cells away. Warns of what is no filled shape.

        Raises OSError if the file cannot be read, ValueError if it is no outline, or in mm without a pitch.
        """
        rings, pitch, left_out = _taxel.read_outline(path, pitch, mm_per_unit, y_up, flatness)
        if left_out:
            warnings.warn(f"{path}: left out: {', '.join(left_out)}", stacklevel=2)
        return cls(rings, pitch, os.path.splitext(os.path.basename(path))[0])


class Sensor(_taxel.Sensor, _Made):
    """A sensor: Sensor(columns=16, rows=16, threshold=0.5, pitch=None).

    columns and rows are from 1 to 64; threshold, above 0 and up to 1, is the share of a cell that must be covered for its
    taxel to be active; pitch is the side of a cell in mm, which only outlines in mm need.

    Raises ValueError for a value out of range.
    """

    def __init__(self, columns=16, rows=16, threshold=0.5, pitch=None):
        self.columns, self.rows, self.threshold, self.pitch = int(columns), int(rows), threshold, pitch

    def touch(self, shape, **values):
        """Touches a shape: touch(shape, *, x0, y0, angle, ...) -> bool array, rows × columns.

        x0 and y0 are in cells, angle in degrees from 0 to below 360; a Picture or an Outline also takes zoom_x and zoom_y, a
        Figure other sizes. What is not given is the shape's own: the origin, angle 0, zoom 1. Each may be an array: they are
        broadcast as numpy does, and their shape comes before rows × columns.

        Raises ValueError for an unknown keyword and for a value out of range.
        """
        keys, poses, sides = _poses(values)
        imprints = np.zeros((*sides, self.rows, self.columns), bool)
        super().touch(shape, keys, poses, imprints)
        return imprints

    def coverage(self, shape, **values):
        """The share of each cell that a shape covers, from 0 to 1: a float64 array. Takes what touch takes."""
        keys, poses, sides = _poses(values)
        coverages = np.zeros((*sides, self.rows, self.columns))
        super().coverage(shape, keys, poses, coverages)
        return coverages

    def sweep(self, shape, *, x0=None, y0=None, angle=None, zoom_x=None, zoom_y=None, anchor="corner"):
        """Finds every imprint that a shape can leave in a grid of poses: an Atlas.

        A range is a text "start:end:step" with the end included, or a number; decimals are exact. Without x0 and y0, one
        cell in steps of 0.01 is swept, without angle every whole degree. anchor is the point that x0 and y0 place:
        "corner" or "centre".

        Raises ValueError for a range that is none or out of range, MemoryError if memory runs short.
        """
        ranges = _ranges(x0=x0, y0=y0, angle=angle, zoom_x=zoom_x, zoom_y=zoom_y)
        return Atlas(_taxel.sweep(self, shape, anchor, ranges))


def describe(imprint):
    """The regions of an imprint with their descriptors: a list of dicts, or for a stack, n × rows × columns, a list of
    such lists.

    The keys are those of `taxel describe --json`: "kind" ("exterior" or "hole"), "na", "nae", "ce" and so on; None where a
    descriptor does not exist.

    Raises ValueError for another array.
    """
    regions = [answer["regions"] for answer in map(json.loads, _taxel.describe(_masks(imprint)))]
    return regions if np.ndim(imprint) == 3 else regions[0]


class Atlas(_taxel.Atlas):
    """Every imprint that a shape leaves in a grid of poses, in the order of their first poses; made by Sensor.sweep or
    taxel.load."""

    imprints = cached_property(_taxel.Atlas.imprints)
    counts = cached_property(_taxel.Atlas.counts)
    descriptors = cached_property(_taxel.Atlas.descriptors)

    def __repr__(self):
        return f"<taxel.Atlas: {len(self.counts)} imprints in {self.counts.sum()} poses>"


class Recording(namedtuple("Recording", "frames times labels channel unit pitch threshold")):
    """A recording of a real sensor; made by taxel.read.

    frames: the values in the recording's unit, a float64 array, frames × rows × columns, NaN where there is no cell.
    times: the times in seconds, a float64 array, NaN for a frame without one; None if the recording has none.
    labels: a list of int, str or None; None if the recording has none.
    channel, unit: their names; pitch: the distance between cells along x and y in mm; threshold: the recording's own;
    each None if the recording does not say it.
    """


def read(path, *, channel=None, rows=None, columns=None, time_column=None, label_column=None):
    """Reads a recording in any format of `taxel frames`: a Recording.

    channel is the name of one of several channels; rows and columns are for a recording that does not state them;
    time_column ("X" or "X:ms") and label_column name columns of a table, or count them from 1. Warns of oddities.

    Raises OSError if the file cannot be read, ValueError if it is no recording, has several channels and none is chosen,
    or is damaged; then the frames before the damage are error.recording.
    """
    reading = {"channel": channel, "rows": rows, "columns": columns, "time_column": time_column, "label_column": label_column}
    *parts, notes, failure = _taxel.read(path, reading)
    for note in notes:
        warnings.warn(f"{path}: {note}", stacklevel=2)
    recording = Recording(*parts)
    if failure is not None:
        failure.recording = recording
        raise failure
    return recording


def threshold(
    frames, *, at_least=None, percent=None, low=None, high=None, deviations=None, least=0, tare=None
):
    """The imprints of frames: a bool array of their shape.

    frames is an array of numbers, rows × columns up to 64 × 64, or frames × rows × columns; NaN is no cell, which is never
    active. One rule: at_least, a value; percent of each frame's largest value; low and high, so that values of low joined
    to one of high are active; or deviations of the tare's noise. Pieces of fewer than least taxels are dropped. tare is
    taken off first: the median of each cell over these frames.

    Raises ValueError without a rule or with two, and for numbers or sizes out of range.
    """
    values, tare = _frames(frames, "frames"), None if tare is None else _frames(tare, "tare")
    imprints = np.zeros(values.shape, bool)
    _taxel.threshold(values, (at_least, percent, low, high, deviations), least, tare, imprints)
    return imprints.reshape(np.shape(frames))


class Frame(namedtuple("Frame", "values time number label")):
    """A frame of taxel.watch.

    values: a float64 array, rows × columns, in the sensor's unit, NaN where there is no cell.
    time: in seconds, the frame's own, or that of its arrival since the first one; None if it is unknown.
    number: from 0; label: an int or a str, or None.
    """


class Watch(_taxel.Watch, _Made):
    """The frames of a source as they arrive, an iterator of Frame and a context that closes the source; made by
    taxel.watch.

    dropped is the number of frames that were torn, short, long or garbled so far; close() ends the iteration.
    """

    def __init__(self, source, *reading):
        self.source = source

    def __iter__(self):
        return self

    def __next__(self):
        return Frame(*super().__next__())

    def __enter__(self):
        return self

    def __exit__(self, *raised):
        self.close()

    __del__ = _taxel.Watch.close


def watch(
    source, *, baud=None, format=None, rows=None, columns=None, channel=None, time_column=None, label_column=None, once=False
):
    """Frames of a live sensor: a Watch, which is an iterator of Frame.

    source is a serial line, "tcp://HOST:PORT", a FIFO, a file that grows, or "-" for standard input; a recording is played
    at its own rate. format is one of `taxel watch --format`, found by looking if not given; rows and columns are for what
    does not state them; channel is one of several; baud is for serial lines (115200). With once, all that is there is read
    as fast as possible; otherwise a connection that is lost is opened again. Frames that are torn or garbled are left out
    and counted as dropped.

    Raises OSError if the source cannot be opened, ValueError if it is of no known format or ends without a frame.
    """
    reading = {"channel": channel, "rows": rows, "columns": columns, "time_column": time_column, "label_column": label_column}
    return Watch(source, reading, format, baud, once)


def train(
    shapes, sensor=None, *, x0=None, y0=None, angle=None, zoom_x=None, zoom_y=None, anchor=None, positions=100,
    weights=None, allow_cut=False,
):
    """Learns every imprint of a set of shapes: a Model, as `taxel model train` makes it.

    shapes is a dict of shapes by their names, or a list, whose shapes are named by their kind or their file. sensor is a
    Sensor; without it, the smallest that holds all shapes, at least 16 × 16. The ranges are those of Sensor.sweep; without
    x0 and y0, the centre of each shape is touched at positions × positions places in one cell. weights is a dict of how
    often shapes are expected, 1 unless given.

    Raises ValueError for a wrong set or range, and for poses that the sensor cuts off, unless allow_cut is set.
    """
    items = shapes.items() if hasattr(shapes, "items") else [(None, shape) for shape in shapes]
    shapes = [(name, shape, (weights or {}).get(name, 1)) for name, shape in items]
    ranges = _ranges(x0=x0, y0=y0, angle=angle, zoom_x=zoom_x, zoom_y=zoom_y)
    anchor = anchor or ("centre" if x0 is None and y0 is None else "corner")
    return Model(_taxel.train(shapes, sensor, ranges, anchor, positions, allow_cut))


def load(path):
    """Reads a Model, or the Atlas of a sweep, from a file that this module or the program has written.

    Raises OSError if the file cannot be read, ValueError if it is of another kind.
    """
    loaded = _taxel.load(path)
    return Model(loaded) if isinstance(loaded, _taxel.Model) else Atlas(loaded)


class Model(_taxel.Model):
    """Every imprint of a set of shapes, and how often each shape leaves it; made by taxel.train or taxel.load."""

    @property
    def sensor(self):
        """The Sensor."""
        return Sensor(*self.sides())

    def recognise(self, imprint, *, noise=None, dead=None, tolerance=None, reject=None):
        """Names the shape that left an imprint: an Answer; a list of them for a stack, n × rows × columns.

        noise is the probability that a taxel flips, below 0.5; 0 allows imprints of trained poses only. The active taxels
        of dead, a bool array, are left out. A shape fits if at most tolerance taxels differ. Answers less probable than
        reject are rejected.

        Raises ValueError for another array and for a number out of range.
        """
        masks, dead = _masks(imprint), None if dead is None else _masks(dead)
        if noise == 0 and tolerance is not None:
            raise ValueError("tolerance cannot be used with noise=0, which fits no shape")
        if not 0 <= (reject or 0) <= 1:
            raise ValueError(f"reject {reject}: expected a probability from 0 to 1")
        if dead is not None and dead.shape != (1, *masks.shape[1:]):
            raise ValueError(f"dead is shaped {dead.shape[1:]}, the imprint {masks.shape[1:]}")
        answers = super().recognise(masks, noise, dead, tolerance, reject)
        answers = [Answer(*answer) for answer in answers]
        return answers if np.ndim(imprint) == 3 else answers[0]

    def separate(self, *, scale=None, pitch=None, threshold=None):
        """How the error of the set depends on the size of its shapes: the points of `taxel model separate`, a list of
        dicts.

        scale, or pitch in mm, is a range as of Sensor.sweep; threshold is that of the model unless given. Sizes at which
        the shapes do not fit on 64 × 64 taxels are left out.
        """
        sizes = _ranges(scale=scale, pitch=pitch)
        if len(sizes) != 1:
            raise ValueError("expected a range as scale, or as pitch")
        flags = [f"--{key}={value}" for key, value in {**sizes, **_ranges(threshold=threshold)}.items()]
        program = [sys.executable, "-c", "import sys, taxel; sys.exit(taxel._main())", "model", "separate"]
        with tempfile.NamedTemporaryFile(suffix=".npz") as file:
            self.save(file.name)
            done = subprocess.run([*program, file.name, *flags, "--json", "--quiet"], capture_output=True, text=True)
        if done.returncode:
            raise ValueError(done.stderr.strip().removeprefix("error: "))
        return json.loads(done.stdout)["points"]

    def __repr__(self):
        return f"<taxel.Model: {', '.join(self.labels)}>"


class Answer(namedtuple("Answer", "name state ranking fit differs pose tied at_rim")):
    """The answer of Model.recognise.

    name: of the shape; None if rejected or unknown. state: "certain", "likely", "tied", "rejected" or "unknown".
    ranking: the shapes of positive probability, the likeliest first, a list of (name, probability).
    fit: the name of the fitted shape, or None; differs: the taxels in which its touch differs; pose: a dict with x0 and y0
    in cells, angle in degrees, and zooms other than 1.
    tied: the names that nothing tells apart, if that is the state. at_rim: whether the imprint may be cut off.
    """


def _main():
    """The command `taxel`: runs the program, which catches signals itself, and returns its exit status."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _taxel.main(sys.argv)
