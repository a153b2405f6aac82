#!/usr/bin/env python3
"""Finds the nearest imprint of a noisy touch with taxel and two indices of faiss, on the same templates in one run.

    cargo build --release && python3 benches/scan_peers.py [QUERIES]

The model has the seven figures of 30 cells. For faiss, each of its keys in each place on a 16 x 16 matrix is a template
of 256 bits, about a million in total. QUERIES is the number of queries (default 500): templates with each taxel flipped
with probability 0.01. All three find the distance of the nearest template; differences are reported. Missing faiss and
numpy are installed by pip, for this run only.
"""
import atexit
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
TAXEL = os.environ.get("TAXEL", os.path.join(HERE, "../target/release/taxel"))
QUERIES = int(sys.argv[1]) if len(sys.argv) > 1 else 500
SIDE = 16
FIGURES = [
    '{"name":"disc","figure":"ellipse","radius_x":3.09,"radius_y":3.09}',
    '{"name":"block","figure":"rectangle","length":6,"width":5}',
    '{"name":"triangle","figure":"triangle","side":8.32}',
    '{"name":"pentagon","figure":"pentagon","side":4.18}',
    '{"name":"hexagon","figure":"hexagon","side":3.4}',
    '{"name":"heptagon","figure":"heptagon","side":2.87}',
    '{"name":"octagon","figure":"octagon","side":2.49}',
]

try:
    import faiss
    import numpy as np
except ImportError:
    own = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, own)
    subprocess.run([sys.executable, "-m", "pip", "install", "-q", "--target", own, "faiss-cpu", "numpy"], check=True)
    sys.path.insert(0, own)
    import faiss
    import numpy as np


def train(path):
    ranges = ["--x0", "10:10.99:0.01", "--y0", "10:10.99:0.01", "--angle", "0:359:1", "--anchor", "corner"]
    sensor = ["--columns", "32", "--rows", "32"]
    subprocess.run([TAXEL, "model", "train", "-", *sensor, *ranges, "--out", path, "--quiet"],
                   check=True, text=True, input="\n".join(FIGURES), stdout=subprocess.DEVNULL)


def templates(path):
    """Returns a row of 256 bits for each key in each place."""
    model = np.load(path)
    matrices = []
    for height, width, rows in zip(model["height"], model["width"], model["rows"]):
        key = (rows[:height, None] >> np.arange(width, dtype=rows.dtype)) & 1
        places = [(row, column) for row in range(SIDE - height + 1) for column in range(SIDE - width + 1)]
        own = np.zeros((len(places), SIDE, SIDE), np.uint8)
        for matrix, (row, column) in zip(own, places):
            matrix[row:row + height, column:column + width] = key
        matrices.append(np.packbits(own.reshape(len(places), -1), axis=1))
    return np.concatenate(matrices)


def asked_of_taxel(model, queries):
    """Returns the distances, and the seconds for the lines: those of the program minus those of a run with one line."""
    lines = []
    for query in queries:
        rows = np.unpackbits(query).reshape(SIDE, SIDE)
        lines.append(json.dumps({"imprint": ["".join(".#"[taxel] for taxel in row) for row in rows]}))

    def run(lines):
        start = time.perf_counter()
        command = [TAXEL, "recognise", "-", "--jobs", "1", "--model", model]
        answers = subprocess.run(command, input="\n".join(lines) + "\n", text=True, stdout=subprocess.PIPE, check=True)
        return time.perf_counter() - start, answers.stdout

    alone = min(run(lines[:1])[0] for _ in range(3))
    spent, answers = run(lines)
    return [json.loads(line)["nearest"]["distance"] for line in answers.splitlines()], spent - alone


def asked_of_faiss(index, queries):
    start = time.perf_counter()
    distances, _ = index.search(queries, 1)
    return distances[:, 0].tolist(), time.perf_counter() - start


def main():
    faiss.omp_set_num_threads(1)
    with tempfile.TemporaryDirectory() as folder:
        model = os.path.join(folder, "figures.npz")
        train(model)
        all_templates = templates(model)
        random = np.random.default_rng(1)
        queries = all_templates[random.integers(len(all_templates), size=QUERIES)]
        flips = np.packbits(random.random((QUERIES, SIDE * SIDE)) < 0.01, axis=1)
        queries = np.ascontiguousarray(queries ^ flips)
        print(f"{len(all_templates):,} templates of 256 bits, {QUERIES} noisy touches, one thread each")

        flat = faiss.IndexBinaryFlat(SIDE * SIDE)
        flat.add(all_templates)
        # Eight tables of 32 bits each: two rows that differ in fewer than eight bits have the same entry in at least
        # one table. The bits are shuffled, because most rows of a matrix are empty.
        order = random.permutation(SIDE * SIDE)

        def shuffled(rows):
            return np.packbits(np.unpackbits(rows, axis=1)[:, order], axis=1)

        hashed = faiss.IndexBinaryMultiHash(SIDE * SIDE, 8, 32)
        hashed.add(shuffled(all_templates))

        expected, spent = asked_of_taxel(model, queries)
        print(f"taxel                        {spent / QUERIES * 1e6:10.1f} us a touch")
        wrong = 0
        for name, index, asked, exact in [
            ("IndexBinaryFlat", flat, queries, True),
            ("IndexBinaryMultiHash", hashed, shuffled(queries), False),
        ]:
            found, other = asked_of_faiss(index, asked)
            same = sum(one == two for one, two in zip(expected, found))
            print(f"faiss {name:22} {other / QUERIES * 1e6:10.1f} us a touch, {other / spent:8.1f} x the time;"
                  f" {same} of {QUERIES} distances are the same")
            wrong += exact and same < QUERIES
        if wrong:
            sys.exit("the exact index of faiss has other distances")


main()
