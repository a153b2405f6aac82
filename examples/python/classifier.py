"""A scikit-learn classifier on the descriptors of four rectangles, compared with the limit that no classifier can beat.

The atlases of the shapes hold every touch of the grid, so the error is that of all touches, not of a sample. The model counts
the least error that any method can have on the same touches.
"""

import numpy as np
import taxel
from sklearn.model_selection import train_test_split
from sklearn.tree import DecisionTreeClassifier

SIZES = [(6, 3), (6, 3.4), (5, 4), (4.4, 4.4)]
GRID = {"x0": "7:7.95:0.05", "y0": "7:7.95:0.05", "angle": "0:89:1", "anchor": "centre"}
DESCRIPTORS = ["na", "p", "area", "side_ratio"]


def main():
    shapes = {f"{length}x{width}": taxel.Figure("rectangle", length=length, width=width) for length, width in SIZES}
    sensor = taxel.Sensor()
    # A row for each imprint of each shape: its descriptors, its shape, and the number of touches that leave it.
    atlases = [sensor.sweep(shape, **GRID) for shape in shapes.values()]
    table = np.concatenate([np.column_stack([atlas.descriptors[key] for key in DESCRIPTORS]) for atlas in atlases])
    shape = np.repeat(range(len(atlases)), [len(atlas.counts) for atlas in atlases])
    count = np.concatenate([atlas.counts for atlas in atlases])

    learn, test = train_test_split(np.arange(len(shape)), train_size=0.5, random_state=0, stratify=shape)

    def error(rows_learnt, rows_named):
        tree = DecisionTreeClassifier(random_state=0)
        tree.fit(table[rows_learnt], shape[rows_learnt], sample_weight=count[rows_learnt])
        wrong = tree.predict(table[rows_named]) != shape[rows_named]
        return count[rows_named][wrong].sum() / count[rows_named].sum()

    rows = np.arange(len(shape))
    of_others, of_all = error(learn, test), error(rows, rows)
    model = taxel.train(shapes, sensor, **GRID)
    assert model.confusion().sum() == count.sum(), "the atlases and the model are of the same touches"

    print(f"{count.sum()} touches of {len(shapes)} rectangles, {len(shape)} imprints; {', '.join(DESCRIPTORS)}")
    print(f"a decision tree that learns half of the imprints, on the others: {of_others:.3f} wrong")
    print(f"a decision tree that learns all touches, on the same touches:    {of_all:.3f} wrong")
    print(f"the limit of any method that knows the imprint:                  {model.error:.3f}")
    assert model.error < of_all


if __name__ == "__main__":
    main()
