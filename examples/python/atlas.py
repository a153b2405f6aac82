"""Every imprint that a hexagon can leave, as numpy arrays."""

import numpy as np
import taxel


def main():
    hexagon = taxel.Figure("hexagon", side=3)
    atlas = taxel.Sensor().sweep(hexagon, x0="5:5.95:0.05", y0="5:5.95:0.05", angle="0:59:1")
    imprints, count = atlas.imprints, atlas.counts
    print(f"{len(imprints)} imprints in {count.sum()} poses, an array of {imprints.shape}")

    # How often each taxel is active, over all poses.
    often = np.tensordot(count / count.sum(), imprints, axes=1)
    row, column = np.unravel_index(often.argmax(), often.shape)
    print(f"taxel ({column}, {row}) is active most often: in {often[row, column]:.0%} of the poses")

    # Descriptors are arrays, with one number per imprint. Statistics weight each number by the imprint's poses.
    active = atlas.descriptors["na"]
    mean = np.average(active, weights=count)
    deviation = np.sqrt(np.average((active - mean) ** 2, weights=count))
    print(f"active taxels: {mean:.2f} ± {deviation:.2f}; the continuous hexagon covers {3**2 * 1.5 * 3**0.5:.2f} cells")
    assert np.isclose(atlas.statistics()["na"]["mean"], mean)

    common = imprints[count.argmax()]
    print(f"the most frequent imprint, in {count.max()} poses:")
    used = common[common.any(axis=1)][:, common.any(axis=0)]
    print("\n".join("".join("#" if taxel else "." for taxel in row) for row in used))


if __name__ == "__main__":
    main()
