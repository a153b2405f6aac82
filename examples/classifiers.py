"""Compares the classifiers of 'taxel model confusion --classifier' with scikit-learn's, on the same features of touches.

    pip install numpy scikit-learn
    python3 examples/classifiers.py [SET.jsonl]       # taxel on the PATH, or: TAXEL=target/release/taxel

Each row is a classifier that names the shape of all touches of the model: each key once, weighted by the number of
poses that leave it. The row says how many poses scikit-learn learns from.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from sklearn.neighbors import KNeighborsClassifier
from sklearn.tree import DecisionTreeClassifier

TAXEL = os.environ.get("TAXEL", "taxel")
SET = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(__file__), "figures.jsonl")


def taxel(*arguments, text=None):
    return subprocess.run([TAXEL, *arguments], input=text, capture_output=True, text=True, check=True).stdout


def keys(model):
    """Returns the imprint of each key as rows of text."""
    for height, width, rows in zip(model["height"], model["width"], model["rows"]):
        yield ["".join("#" if int(row) >> i & 1 else "." for i in range(width)) for row in rows[:height]]


def features(model):
    """Returns the features that taxel uses, from its own descriptors and by its names, in units of their deviation."""
    lines = "".join(json.dumps({"imprint": rows}) + "\n" for rows in keys(model))
    regions = [json.loads(line)["regions"][0] for line in taxel("batch", text=lines).splitlines()]

    def value(region, name):
        for ending in ("_cos", "_sin"):
            if name.endswith(ending):
                angle = region[name.removesuffix(ending)]
                turn = np.cos if ending == "_cos" else np.sin
                return 0.0 if angle is None else turn(np.radians(angle))
        if name[-2:] in ("_1", "_2"):
            return region[name[:-2]][int(name[-1]) - 1]
        # Answers omit descriptors that follow from others.
        return 4 * np.pi / region["f"] if name == "roundness" else region[name]

    used = json.loads(taxel("model", "confusion", "model.npz", "--classifier", "z", "--json"))["features"]
    table = np.array([[value(region, name) for name in used] for region in regions])
    weights = np.bincount(model["key"], weights=model["count"])
    mean = np.average(table, axis=0, weights=weights)
    return (table - mean) / np.sqrt(np.average((table - mean) ** 2, axis=0, weights=weights))


def main():
    taxel("model", "train", SET, "--out", "model.npz", "--quiet")
    model = np.load("model.npz")
    labels = json.loads(taxel("model", "confusion", "model.npz", "--json"))
    table = features(model)
    key, shape, count = model["key"].astype(int), model["shape"].astype(int), model["count"].astype(float)
    random = np.random.default_rng(0)

    def sample(poses):
        drawn = []
        for number in range(len(labels["labels"])):
            own = np.flatnonzero(shape == number)
            drawn.append(random.choice(own, poses, p=count[own] / count[own].sum()))
        return np.concatenate(drawn)

    few, many = sample(2000), sample(50000)
    rows = [
        ("knn", "KNeighborsClassifier(1)", KNeighborsClassifier(1), few),
        ("", "DecisionTreeClassifier", DecisionTreeClassifier(random_state=0), many),
    ]
    print("| taxel | error | seconds | scikit-learn | learns from | error | seconds |")
    print("|---" * 7 + "|")
    for peer, name, classifier, drawn in rows:
        own = ["", ""]
        if peer:
            start = time.perf_counter()
            answer = taxel("model", "confusion", "model.npz", "--classifier", peer, "--json")
            own = [f"{json.loads(answer)['error']:.3f}", f"{time.perf_counter() - start:.2f}"]
        start = time.perf_counter()
        classifier.fit(table[key[drawn]], shape[drawn])
        learnt = f"{len(drawn) // len(labels['labels']):,} poses a shape"
        wrong = count[classifier.predict(table)[key] != shape].sum() / count.sum()
        seconds = time.perf_counter() - start
        print(f"| {peer} | {own[0]} | {own[1]} | {name} | {learnt} | {wrong:.3f} | {seconds:.2f} |")
    print(f"\nlimit of one touch: {labels['error']:.3f}")


if __name__ == "__main__":
    SET, TAXEL = os.path.abspath(SET), os.path.abspath(TAXEL) if os.sep in TAXEL else TAXEL
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main()
