"""Shows live frames of a sensor, each with its imprint, its descriptors and the name of the shape.

    python3 examples/python/live.py /dev/ttyACM0     # a serial line, tcp://HOST:PORT, a recording, a FIFO
    python3 examples/python/live.py                  # without a sensor: a disc and a bar, made up here
"""

import os
import sys
import tempfile
import threading

import numpy as np
import taxel

SHAPES = {
    "disc": taxel.Figure("ellipse", radius_x=3, radius_y=3),
    "bar": taxel.Figure("rectangle", length=9, width=2),
}


def made_up(fifo, frames=24):
    """Writes frames of 16 x 16 values from 0 to 100: no contact, then a moving disc, then a bar."""
    row, column = np.indices((16, 16)) + 0.5
    with open(fifo, "w") as stream:
        for frame in range(-1, frames):
            right, down = abs(column - 5 - 0.2 * frame), abs(row - 8.03 + 0.1 * frame)
            pressed = right**2 + down**2 <= 9 if frame < frames // 2 else (right <= 4.5) & (down <= 1)
            np.savetxt(stream, np.where(pressed & (frame >= 0), 80, 2), fmt="%d", footer="\n", comments="")


def main(source):
    model = taxel.train(SHAPES, positions=20, angle="0:355:5")
    for frame in taxel.watch(source):
        mask = taxel.threshold(frame.values, at_least=10)
        if not mask.any():
            print(f"frame {frame.number}: no contact", flush=True)
            continue
        answer, (x, y) = model.recognise(mask), taxel.describe(mask)[0]["cg"]
        print(f"frame {frame.number}: {mask.sum()} taxels at {x:.1f}, {y:.1f}: {answer.name} ({answer.state})", flush=True)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        sys.exit(main(sys.argv[1]))
    with tempfile.TemporaryDirectory() as folder:
        fifo = os.path.join(folder, "sensor")
        os.mkfifo(fifo)
        threading.Thread(target=made_up, args=(fifo,), daemon=True).start()
        main(fifo)
