"""Every imprint that a hexagon can leave, as numpy arrays.

    pip install numpy
    python3 examples/python/atlas.py         # taxel on the PATH, or: TAXEL=target/release/taxel
"""

import os
import subprocess
import tempfile

import numpy as np

TAXEL = os.environ.get("TAXEL", "taxel")
# The numbers do not depend on your settings.
os.environ["TAXEL_CONFIG"] = os.devnull
GRID = ["--x0", "5:5.95:0.05", "--y0", "5:5.95:0.05", "--angle", "0:59:1"]


def taxels(atlas, columns=16):
    """Returns the imprints as an array of bool: imprints x rows x columns. In the file, a row is a word, bit i for column i."""
    return (atlas["rows"][:, :, None] >> np.arange(columns, dtype=np.uint64) & 1).astype(bool)


def main():
    subprocess.run(
        [TAXEL, "sweep", "hexagon", "--side", "3", *GRID, "--atlas", "hexagon.npz", "--poses", "hexagon.npy", "--quiet"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    atlas, poses = np.load("hexagon.npz"), np.load("hexagon.npy")
    imprints, count = taxels(atlas), atlas["count"]
    print(f"{len(imprints)} imprints in {count.sum()} poses, an array of {imprints.shape}")

    # How often each taxel is active, over all poses.
    often = np.tensordot(count / count.sum(), imprints, axes=1)
    row, column = np.unravel_index(often.argmax(), often.shape)
    print(f"taxel ({column}, {row}) is active most often: in {often[row, column]:.0%} of the poses")

    # Descriptors are arrays, too, with one number per imprint. Statistics weight each number by the imprint's poses.
    mean = np.average(atlas["na"], weights=count)
    deviation = np.sqrt(np.average((atlas["na"] - mean) ** 2, weights=count))
    print(f"active taxels: {mean:.2f} ± {deviation:.2f}; the continuous hexagon covers {3**2 * 1.5 * 3**0.5:.2f} cells")
    assert np.array_equal(imprints.sum(axis=(1, 2))[atlas["pieces"] == 1], atlas["na"][atlas["pieces"] == 1])

    # The imprint of every pose: angles x y0 x x0.
    print(f"poses: an array of {poses.shape}; at 17 degrees {len(np.unique(poses[17]))} imprints")
    common = imprints[count.argmax()]
    print(f"the most frequent imprint, in {count.max()} poses:")
    used = common[common.any(axis=1)][:, common.any(axis=0)]
    print("\n".join("".join("#" if taxel else "." for taxel in row) for row in used))


if __name__ == "__main__":
    TAXEL = os.path.abspath(TAXEL) if os.sep in TAXEL else TAXEL
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main()
