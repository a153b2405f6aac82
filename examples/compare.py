"""The ring of the paper's Fig. 1 and three small shapes, measured by OpenCV and scikit-image beside taxel.

    pip install numpy opencv-python-headless scikit-image
    python3 examples/compare.py            # taxel on the PATH, or: TAXEL=target/release/taxel
"""

import json
import os
import subprocess

import cv2
import numpy as np
from skimage.measure import perimeter, perimeter_crofton, regionprops

TAXEL = os.environ.get("TAXEL", "taxel")
SHAPES = {
    "ring": "...######...\n...######...\n..##....##..\n..##....##..\n..##....##..\n...######...\n...######...",
    "square": "####\n####\n####\n####",
    "line": "########",
    "diamond": "...#...\n..###..\n.#####.\n#######\n.#####.\n..###..\n...#...",
}


def row(name, text):
    taxels = np.array([[sign == "#" for sign in line] for line in text.split()])
    framed = np.pad(taxels, 1).astype(np.uint8)
    answer = subprocess.run([TAXEL, "describe", "-", "--json"], input=text, capture_output=True, text=True, check=True)
    region = json.loads(answer.stdout)["regions"][0]
    contours, _ = cv2.findContours(framed, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    outline = max(contours, key=len)
    props = regionprops(framed)[0]
    filled = props.image_filled
    print(
        f"| {name} | {region['p']:.2f} | {cv2.arcLength(outline, True):.2f}"
        f" | {perimeter(np.pad(filled, 1)):.2f} | {perimeter_crofton(np.pad(filled, 1)):.2f}"
        f" | {region['nae']} | {cv2.contourArea(outline):.0f} | {props.area_filled:.0f} |"
    )


if __name__ == "__main__":
    print("| shape | P taxel | arcLength | perimeter | Crofton | NAE | contourArea | area_filled |")
    print("|---" * 8 + "|")
    for name, text in SHAPES.items():
        row(name, text)
