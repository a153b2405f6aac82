"""Outlines touched by shapely: the areas that polygons with holes cover of each cell, and the union of an SVG's paths.

    pip install shapely
    python3 examples/outlines.py > tests/data/outlines.json

tests/imprints/drawings.rs compares taxel with it.
"""

import json
import math
import random

from shapely import affinity
from shapely.geometry import Polygon, box
from shapely.ops import unary_union

SIDE = 12


def placed(shape, x0, y0, angle):
    """Puts the top left corner of the bounding rectangle to x0, y0, and turns the shape about the rectangle's centre."""
    left, top, _, _ = shape.bounds
    moved = affinity.translate(shape, x0 - left, y0 - top)
    # Counter-clockwise as seen, where y runs down.
    return affinity.rotate(moved, -angle, origin="center")


def areas(shape):
    return [shape.intersection(box(x, y, x + 1, y + 1)).area for y in range(SIDE) for x in range(SIDE)]


def imprint(covered):
    # A tie is active. Areas are right up to about 15 digits.
    signs = "".join("#" if area >= 0.5 - 1e-12 else "." for area in covered)
    return [signs[start : start + SIDE] for start in range(0, SIDE * SIDE, SIDE)]


def polygons(shape):
    return [shape] if shape.geom_type == "Polygon" else list(shape.geoms)


def rings(shape):
    closed = [ring for part in polygons(shape) for ring in [part.exterior, *part.interiors]]
    return [[list(point) for point in ring.coords[:-1]] for ring in closed]


def blocks(chance):
    """Blocks of half cells, some taken away again."""
    shape = Polygon()
    for number in range(7):
        x, y = (chance.randrange(0, 11) / 2 for _ in range(2))
        block = box(x, y, x + chance.randrange(1, 8) / 2, y + chance.randrange(1, 8) / 2)
        shape = shape.difference(block) if number % 3 == 2 else shape.union(block)
    return shape.simplify(0)


def star(chance, longest):
    corners = chance.randrange(5, 12)
    turns = (2 * math.pi * (number + chance.uniform(0.1, 0.9)) / corners for number in range(corners))
    radii = ((turn, longest * chance.uniform(0.6, 1)) for turn in turns)
    return Polygon([(round(r * math.cos(turn), 2), round(r * math.sin(turn), 2)) for turn, r in radii])


def plate(chance):
    """A star with one hole, or with two and a piece in one of them."""
    shape = star(chance, 4.5).difference(star(chance, 1.9))
    return shape.union(star(chance, 0.9)) if chance.random() < 0.5 else shape


def coverages():
    chance = random.Random(2008)
    for number in range(60):
        lattice = number % 2 == 0
        shape = blocks(chance) if lattice else plate(chance)
        x0, y0 = (chance.randrange(0, 8) / 2 if lattice else round(chance.uniform(0, 3), 2) for _ in range(2))
        angle = 90 * chance.randrange(4) if lattice else chance.randrange(360)
        covered = areas(placed(shape, x0, y0, angle))
        yield {
            "rings": rings(shape),
            "x0": x0,
            "y0": y0,
            "angle": angle,
            "coverage": [round(area, 11) for area in covered],
            "imprint": imprint(covered),
        }


# A plate with a window, a bar and a wedge that overlap it, a foot beside it, and what has no area of its own.
SVG = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="100mm" viewBox="0 0 200 100">
<defs><polygon id="wedge" points="0,0 12,3 2,9"/></defs>
<style>.cut { fill: none; stroke: red }</style>
<path fill-rule="evenodd" d="M5 4h36v21h-36z m6 5v8.5h11v-8.5z"/>
<g transform="translate(24 11) rotate(30)">
  <rect x="-2" y="-3" width="26" height="5"/>
  <use xlink:href="#wedge" x="3" y="1" transform="scale(1.5 1)"/>
</g>
<path transform="matrix(1 .25 0 1 0 0)" d="M10,26 l9-2 1,8 z"/>
<path class="cut" d="M0 0L200 100"/>
</svg>
"""


def drawing():
    plate = box(5, 4, 41, 25).difference(box(11, 9, 22, 17.5))
    wedge = affinity.scale(Polygon([(3, 1), (15, 4), (5, 10)]), 1.5, 1, origin=(0, 0))
    tilted = affinity.rotate(unary_union([box(-2, -3, 24, 2), wedge]), 30, origin=(0, 0))
    foot = affinity.affine_transform(Polygon([(10, 26), (19, 24), (20, 32)]), [1, 0, 0.25, 1, 0, 0])
    # A unit is half a millimetre, and a cell 2.5 mm.
    union = unary_union([plate, affinity.translate(tilted, 24, 11), foot])
    cells = affinity.scale(union, 0.2, 0.2, origin=(0, 0))
    poses = [(step / 4, step / 8, 40 * step % 360) for step in range(12)]
    touches = [
        {"x0": x0, "y0": y0, "angle": angle, "imprint": imprint(areas(placed(cells, x0, y0, angle)))}
        for x0, y0, angle in poses
    ]
    return {"svg": SVG, "pitch_mm": 2.5, "area": union.area / 4, "touches": touches}


if __name__ == "__main__":
    print(json.dumps({"coverages": list(coverages()), "drawing": drawing()}, separators=(",", ":")))
