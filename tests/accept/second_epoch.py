"""The second date of a port against its reference: `score --second-epoch` must find the disagreement of both
georeferences, a smooth field of 0 to 20 m.

second_epoch.py PILOTAGE SOURCE_FOLDER

Two truths, neither of them Pilotage's. (1) The registered picture is the delivered one, warped by a cubic polynomial
through 317 correlation ties: looked for in the delivered picture, its squares give that polynomial. It
leaves 5 to 10 m in the north-east (registered_truth.py), so only its middle is held against the field. (2) Squares of
the reference, looked for in the delivered picture around the place where the field says they are, and backwards."""

from acceptance import check, main, need_gdal, real_data, run
from registered_truth import find, gray_of

gdal = need_gdal()
import numpy as np  # noqa: E402

STEP_PX = 120
POLYNOMIAL = {"half_px": 48, "reach_px": 75, "min_ncc": 0.8}  # the same picture: certain
PATCHES = {"half_px": 160, "reach_px": 30, "min_ncc": 0.4}  # 96 m wide, looked for within 9 m
BACK_PX = 3


class Picture:

    def __init__(self, path):
        dataset = gdal.Open(str(path))
        self.gray, self.place = gray_of(dataset), dataset.GetGeoTransform()
        self.valid = dataset.GetRasterBand(1).GetMaskBand().ReadAsArray() > 0

    def cut(self, col, row, half):
        """The square around a pixel corner, or None where it is not all ground."""
        box = np.s_[row - half:row + half, col - half:col + half]
        if min(col, row) < half or not self.valid[box].shape == (2 * half, 2 * half) or self.valid[box].mean() < 0.98:
            return None
        return self.gray[box]


def shift_px(first, second, col, row, guess_px, half_px, reach_px, min_ncc):
    """Where second shows first's square, columns and rows from (col, row); None when not found, or not found back."""
    at = (round(col + guess_px[0]), round(row + guess_px[1]))
    template, window = first.cut(col, row, half_px), second.cut(*at, half_px + reach_px)
    if template is None or window is None:
        return None
    cols, rows, ncc = find(template, window)
    if ncc < min_ncc or max(abs(cols), abs(rows)) >= reach_px:
        return None
    found = (at[0] + cols, at[1] + rows)
    template, window = second.cut(*found, half_px), first.cut(col, row, half_px + reach_px)
    if template is None or window is None:
        return None
    back = find(template, window)
    if max(abs(back[0]), abs(back[1])) > BACK_PX:
        return None
    return found[0] - col, found[1] - row


class Field:
    """The layer that score wrote, linear between the middles of its pixels; NaN where it is not known."""

    def __init__(self, path):
        dataset = gdal.Open(str(path))
        self.place, self.bands = dataset.GetGeoTransform(), dataset.ReadAsArray()
        names = [dataset.GetRasterBand(i + 1).GetDescription() for i in range(4)]
        check(names == ["east_m", "north_m", "magnitude_m", "sigma_m"], f"bands are {names}")
        check(gdal.GetDataTypeName(dataset.GetRasterBand(1).DataType) == "Float32", "the layer is not Float32")
        check(dataset.GetMetadata("IMAGE_STRUCTURE").get("LAYOUT") == "COG", "the layer is not cloud-optimised")

    def at(self, x, y):
        col, row = (x - self.place[0]) / self.place[1] - 0.5, (y - self.place[3]) / self.place[5] - 0.5
        i, j = int(np.floor(col)), int(np.floor(row))
        if i < 0 or j < 0 or i + 1 >= self.bands.shape[2] or j + 1 >= self.bands.shape[1]:
            return np.full(4, np.nan)
        a, b, part = col - i, row - j, self.bands[:, j:j + 2, i:i + 2]
        return (1 - b) * ((1 - a) * part[:, 0, 0] + a * part[:, 0, 1]) + b * ((1 - a) * part[:, 1, 0] + a * part[:, 1, 1])


def compare(field, first, second, guess, how):
    """For each place of a grid that can be judged: magnitude of the truth, distance of the field from it (NaN where it
    is not known) and the field's sigma."""
    place, rows = first.place, []
    for row in range(STEP_PX, first.gray.shape[0] - STEP_PX, STEP_PX):
        for col in range(STEP_PX, first.gray.shape[1] - STEP_PX, STEP_PX):
            value = field.at(place[0] + col * place[1], place[3] + row * place[5])
            guess_px = (value[0] / place[1], value[1] / place[5]) if guess else (0, 0)
            if np.isnan(guess_px).any():
                continue
            shift = shift_px(first, second, col, row, guess_px, **how)
            if shift is None:
                continue
            truth = np.array([shift[0] * place[1], shift[1] * place[5]])
            rows.append((np.hypot(*truth), np.hypot(*(value[:2] - truth)), value[3]))
    return np.array(rows)


def tell(name, rows):
    known = rows[~np.isnan(rows[:, 1])]
    quantiles = [float(np.quantile(known[:, 1], q)) for q in (0.5, 0.95, 1)]
    print(f"{name}: {len(known)} of {len(rows)} places known; distance from the truth {quantiles[0]:.2f} m median, "
          f"{quantiles[1]:.2f} m 95 %, {quantiles[2]:.2f} m largest; the truth itself {np.median(rows[:, 0]):.2f} m "
          f"median, {rows[:, 0].max():.2f} m largest", flush=True)
    return len(known) / len(rows), quantiles


def test(pilotage, source, work, _rest):
    data = real_data(source)
    paths = [data / "port" / f"port_{name}.tif"
             for name in ("2019-08", "2020-07_asdelivered", "2020-07_registered")]
    layer = work / "disagreement.tif"
    print(run(pilotage, "score", paths[0], "--gsd-m", 0.6, "--tile-size-px", 128, "--stride-px", 128,
              "--search-radius-px", 64, "--measures", "gray_variance", "--second-epoch", paths[1],
              "--second-epoch-output", layer, "-o", work / "scores.tif", "-q"))
    field = Field(layer)
    reference, delivered, registered = (Picture(path) for path in paths)
    known, distance_m = tell("the registered picture's polynomial", compare(field, registered, delivered, False,
                                                                          POLYNOMIAL))
    check(known > 0.85, "the field is not known where both pictures are")
    check(distance_m[0] < 0.8, "the field is not the polynomial's")
    patches = compare(field, reference, delivered, True, PATCHES)
    _, residual_m = tell("squares of the reference in the delivered picture", patches)
    check(len(patches) > 100, "too few squares to judge by")
    check(residual_m[0] < 0.7 and residual_m[1] < 2.5, "the warped picture does not lie on the reference")
    print(f"residual over predicted sigma, median per place {np.median(patches[:, 1] / patches[:, 2]):.2f} "
          "(1.18 for normal errors)")


if __name__ == "__main__":
    main(test)
