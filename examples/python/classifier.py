"""A scikit-learn classifier on the descriptors of four rectangles, compared with the limit that no classifier can beat.

    pip install numpy scikit-learn
    python3 examples/python/classifier.py    # taxel on the PATH, or: TAXEL=target/release/taxel

The atlases of the shapes hold every touch of the grid, so the error is that of all touches, not of a sample. `taxel model
confusion` counts the least error that any method can have on the same touches: with the whole imprint, and with these
descriptors alone.
"""

import json
import os
import subprocess
import tempfile

import numpy as np
from sklearn.model_selection import train_test_split
from sklearn.tree import DecisionTreeClassifier

TAXEL = os.environ.get("TAXEL", "taxel")
# The numbers do not depend on your settings.
os.environ["TAXEL_CONFIG"] = os.devnull
SHAPES = {"6x3": (6, 3), "6x3.4": (6, 3.4), "5x4": (5, 4), "4.4x4.4": (4.4, 4.4)}
GRID = ["--x0", "7:7.95:0.05", "--y0", "7:7.95:0.05", "--angle", "0:89:1", "--anchor", "centre"]
DESCRIPTORS = ["na", "p", "area", "side_ratio"]


def taxel(*arguments):
    return subprocess.run([TAXEL, *arguments], capture_output=True, text=True, check=True).stdout


def main():
    # A row for each imprint of each shape: its descriptors, its shape, and the number of touches that leave it.
    table, shape, count = [], [], []
    for number, (length, width) in enumerate(SHAPES.values()):
        size = ["--length", str(length), "--width", str(width)]
        taxel("sweep", "rectangle", *size, *GRID, "--atlas", f"{number}.npz", "--quiet")
        atlas = np.load(f"{number}.npz")
        table.append(np.column_stack([atlas[name] for name in DESCRIPTORS]))
        shape.append(np.full(len(atlas["count"]), number))
        count.append(atlas["count"])
    table, shape, count = np.concatenate(table), np.concatenate(shape), np.concatenate(count)

    learn, test = train_test_split(np.arange(len(shape)), train_size=0.5, random_state=0, stratify=shape)

    def error(rows_learnt, rows_named):
        tree = DecisionTreeClassifier(random_state=0)
        tree.fit(table[rows_learnt], shape[rows_learnt], sample_weight=count[rows_learnt])
        wrong = tree.predict(table[rows_named]) != shape[rows_named]
        return count[rows_named][wrong].sum() / count[rows_named].sum()

    rows = np.arange(len(shape))
    of_others, of_all = error(learn, test), error(rows, rows)

    with open("shapes.jsonl", "w") as lines:
        for name, (length, width) in SHAPES.items():
            shape = {"name": name, "figure": "rectangle", "length": length, "width": width}
            lines.write(json.dumps(shape) + "\n")
    taxel("model", "train", "shapes.jsonl", *GRID, "--out", "model.npz", "--quiet")
    limit = json.loads(taxel("model", "confusion", "model.npz", "--json"))
    given = json.loads(taxel("model", "confusion", "model.npz", "--given", ",".join(DESCRIPTORS), "--json"))
    assert limit["touches"] == count.sum(), "the atlases and the model are of the same touches"

    print(f"{count.sum()} touches of {len(SHAPES)} rectangles, {len(shape)} imprints; {', '.join(DESCRIPTORS)}")
    print(f"a decision tree that learns half of the imprints, on the others: {of_others:.3f} wrong")
    print(f"a decision tree that learns all touches, on the same touches:    {of_all:.3f} wrong")
    print(f"the limit of any method that knows these descriptors:            {given['error']:.3f}")
    print(f"the limit of any method that knows the imprint:                  {limit['error']:.3f}")
    assert limit["error"] <= given["error"] <= of_all + 1e-9


if __name__ == "__main__":
    TAXEL = os.path.abspath(TAXEL) if os.sep in TAXEL else TAXEL
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main()
