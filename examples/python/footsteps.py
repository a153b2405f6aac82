"""Which foot, and which part of the step: frames of a real insole named by models of other frames.

    python3 examples/python/footsteps.py fscan_testL.asf

The recording is a Tekscan movie of a left foot that takes several steps; it comes with the R package pressuRe
(github.com/Telfer/pressuRe, inst/extdata). The imprints of the second step are the shapes: the heel as it lands, the whole
foot, and the ball as it pushes off; and the mirror images of all three, which are those of a right foot. A model holds each of
them shifted by quarters of a cell and turned in steps of 5 degrees. Then the frames of the other steps are named, with a probability of
0.05 that a taxel differs. Nothing but Python itself is needed.
"""

import json
import os
import subprocess
import sys
import tempfile

TAXEL = os.environ.get("TAXEL", "taxel")
# The numbers do not depend on your settings.
os.environ["TAXEL_CONFIG"] = os.devnull
THRESHOLD = "20"
# Frames of the second step, with the part of the step that each shows.
SHAPES = {"heel": 32, "whole": 42, "ball": 48}
SECOND_STEP = range(29, 52)


def frames(recording, *options):
    command = [TAXEL, "frames", recording, "--at-least", THRESHOLD, "--json", *options]
    answers = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    return [json.loads(line) for line in answers.splitlines()]


def shapes(recording):
    """Returns a JSON line for each shape: the imprint of a frame, as it is and mirrored."""
    for foot, flip in [("left", []), ("right", ["--flip", "x"])]:
        for part, number in SHAPES.items():
            [frame] = frames(recording, "--frame", str(number), *flip)
            yield json.dumps({"name": f"{foot} {part}", "picture": frame["imprint"]})


def main(recording):
    with tempfile.TemporaryDirectory() as folder:
        model = os.path.join(folder, "feet.npz")
        train = [TAXEL, "model", "train", "-", "--positions", "4", "--angle", "0:355:5", "--columns", "64", "--rows", "64"]
        train += ["--allow-cut", "--out", model, "--quiet"]
        subprocess.run(train, input="\n".join(shapes(recording)), check=True, stdout=subprocess.DEVNULL, text=True)
        named = frames(recording, "--all", "--model", model, "--noise", "0.05")

    steps, names, in_step = [], [], False
    for frame in named:
        number, loaded = frame["frame"], frame["na"] >= 60
        if loaded and number not in SECOND_STEP:
            if not in_step:
                steps.append((number, []))
            name = frame["recognition"]["ranking"][0]["name"]
            names.append(name)
            if steps[-1][1][-1:] != [name]:
                steps[-1][1].append(name)
        in_step = loaded
    for number, phases in steps:
        print(f"step from frame {number}: {', '.join(phases)}")
    left = sum(name.startswith("left") for name in names)
    print(f"{left} of {len(names)} frames are named as those of a left foot")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        main(sys.argv[1])
    except subprocess.CalledProcessError as error:
        sys.exit(error.returncode)  # taxel has said why
