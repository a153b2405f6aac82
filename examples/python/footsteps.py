"""Which foot, and which part of the step: frames of a real insole named by models of other frames.

    python3 examples/python/footsteps.py fscan_testL.asf

The recording is a Tekscan movie of a left foot that takes several steps; it comes with the R package pressuRe
(github.com/Telfer/pressuRe, inst/extdata). The imprints of the second step are the shapes: the heel as it lands, the whole
foot, and the ball as it pushes off; and the mirror images of all three, which are those of a right foot. A model holds each of
them shifted by quarters of a cell and turned in steps of 5 degrees. Then the frames of the other steps are named, with a
probability of 0.05 that a taxel differs.
"""

import sys

import taxel

# Frames of the second step, with the part of the step that each shows.
SHAPES = {"heel": 32, "whole": 42, "ball": 48}
SECOND_STEP = range(29, 52)


def main(recording):
    masks = taxel.threshold(taxel.read(recording).frames, at_least=20)
    shapes = {f"left {part}": taxel.Picture(masks[number]) for part, number in SHAPES.items()}
    shapes |= {f"right {part}": taxel.Picture(masks[number][:, ::-1]) for part, number in SHAPES.items()}
    model = taxel.train(shapes, taxel.Sensor(64, 64), positions=4, angle="0:355:5", allow_cut=True)

    loaded = masks.sum(axis=(1, 2)) >= 60
    numbers = [number for number in loaded.nonzero()[0] if number not in SECOND_STEP]
    names = [answer.ranking[0][0] for answer in model.recognise(masks[numbers], noise=0.05)]
    steps = []
    for number, name in zip(numbers, names):
        if not loaded[number - 1]:
            steps.append((number, []))
        if name not in steps[-1][1][-1:]:
            steps[-1][1].append(name)
    for number, phases in steps:
        print(f"step from frame {number}: {', '.join(phases)}")
    left = sum(name.startswith("left") for name in names)
    print(f"{left} of {len(names)} frames are named as those of a left foot")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
