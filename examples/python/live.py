"""Shows live frames of a sensor, each with its imprint, its descriptors and the name of the shape.

    python3 examples/python/live.py /dev/ttyACM0     # a serial line, tcp://HOST:PORT, a recording, a FIFO
    python3 examples/python/live.py                  # without a sensor: a disc and a bar, made up here

`taxel watch` reads the sensor, takes the threshold, and prints a line of JSON for each frame; a program in any language can
read that. Nothing but Python itself is needed.
"""

import json
import os
import subprocess
import sys
import tempfile
import threading

TAXEL = os.environ.get("TAXEL", "taxel")
SHAPES = [
    {"name": "disc", "figure": "ellipse", "radius_x": 3, "radius_y": 3},
    {"name": "bar", "figure": "rectangle", "length": 9, "width": 2},
]


def made_up(stream, frames=24, side=16):
    """Writes frames of 16 x 16 values from 0 to 100: no contact, then a moving disc, then a bar."""
    for frame in range(-1, frames):
        x, y = 5 + 0.2 * frame, 8.03 - 0.1 * frame
        disc = frame < frames // 2

        def pressed(column, row):
            right, down = column + 0.5 - x, row + 0.5 - y
            if frame < 0:
                return False
            return right**2 + down**2 <= 9 if disc else abs(right) <= 4.5 and abs(down) <= 1

        for row in range(side):
            stream.write(" ".join("80" if pressed(column, row) else "2" for column in range(side)) + "\n")
        stream.write("\n")
    stream.close()


def main(source):
    with tempfile.TemporaryDirectory() as folder:
        model = os.path.join(folder, "model.npz")
        train = [TAXEL, "model", "train", "-", "--positions", "20", "--angle", "0:355:5", "--out", model, "--quiet"]
        lines = "".join(json.dumps(shape) + "\n" for shape in SHAPES)
        subprocess.run(train, check=True, text=True, input=lines, stdout=subprocess.DEVNULL)
        watch = [TAXEL, "watch", source or "-", "--json", "--at-least", "10", "--model", model]
        if source is None:
            watch += ["--format", "lines", "--once"]
        with subprocess.Popen(watch, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as taxel:
            if source is None:
                threading.Thread(target=made_up, args=(taxel.stdin,), daemon=True).start()
            for line in taxel.stdout:
                frame = json.loads(line)
                if not frame["imprint"]:
                    continue
                named = frame["recognition"]
                if named is None:  # no active taxel
                    print(f"frame {frame['frame']}: no contact", flush=True)
                    continue
                place = "{:.1f}, {:.1f}".format(*frame["regions"][0]["cg"])
                print(f"frame {frame['frame']}: {frame['na']} taxels at {place}: {named['answer']} ({named['state']})", flush=True)
        return taxel.returncode


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else None))
    except subprocess.CalledProcessError as error:
        sys.exit(error.returncode)  # taxel has said why
    except BrokenPipeError:
        sys.stdout = None  # nobody reads on, as in | head
