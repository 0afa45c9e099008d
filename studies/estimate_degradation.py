"""What another date changes: measures pairs of pictures in the terms of DegradationOptions.

estimate_degradation.py DATA [SET...] [--json FILE]

DATA is the folder of real imagery (PILOTAGE_DATA); sets are port (as delivered, and averaged over 2 and 4 pixels),
copies (of tiles of the port, changed by known amounts), sentinel2, levir, dsifn; default all. Prints, for each set,
median and quartiles over tiles of 128 px, and what a copy by today's defaults would show. Definitions and what follows: docs/methods/degradation.md. numpy and GDAL only."""

import json
import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "tests/accept"))  # helpers shared with the tests
from acceptance import need_gdal  # noqa: E402
from registered_truth import HALF_PX, MIN_NCC, NEIGHBOURS, find, gray_of  # noqa: E402
from registered_truth import REACH_PX as SHIFT_PX  # noqa: E402

gdal = need_gdal()

TILE_PX = 128
REACH_PX = 12  # how far two pictures that should agree may disagree
MIN_PAIR_NCC = 0.2  # of whole pictures
MIN_VALID = 0.95  # of a tile; holes take its mean
BLOCK_PX = 16
BANDS_PX = (2.2, 3, 4, 6, 8, 12, 16, 24, 32, 64)  # wavelengths
DEFAULTS = {"share": 0.65, "sigma_px": 3.0}  # today's defaults


def read_gray(path, plain=True):
    dataset = gdal.Open(str(path))
    if plain and dataset.RasterCount >= 3:
        bands = [dataset.GetRasterBand(i + 1).ReadAsArray().astype(np.float64) for i in range(3)]
        gray = 0.299 * bands[0] + 0.587 * bands[1] + 0.114 * bands[2]
    else:
        gray = dataset.GetRasterBand(1).ReadAsArray().astype(np.float64)
    valid = dataset.GetRasterBand(1).GetMaskBand().ReadAsArray() > 0
    return gray, valid, dataset


def averaged(image, factor):
    rows, cols = (n // factor * factor for n in image.shape)
    return image[:rows, :cols].reshape(rows // factor, factor, cols // factor, factor).mean((1, 3))


def blur(image, sigma_px):
    """Gaussian, through the frequency domain of the mirrored picture."""
    rows, cols = image.shape
    mirrored = np.block([[image, image[:, ::-1]], [image[::-1], image[::-1, ::-1]]])
    fy = np.fft.fftfreq(2 * rows)[:, None]
    fx = np.fft.rfftfreq(2 * cols)[None]
    response = np.exp(-2 * np.pi**2 * sigma_px**2 * (fx**2 + fy**2))
    return np.fft.irfft2(np.fft.rfft2(mirrored) * response, mirrored.shape)[:rows, :cols]


def ncc(a, b):
    a, b = a - a.mean(), b - b.mean()
    norm = np.sqrt((a * a).sum() * (b * b).sum())
    return float((a * b).sum() / norm) if norm > 0 else 0.0


def moved(image, rows, cols):
    """The picture as it looks when its content is moved by a fraction of a pixel (Fourier shift)."""
    fy = np.fft.fftfreq(image.shape[0])[:, None]
    fx = np.fft.rfftfreq(image.shape[1])[None]
    return np.fft.irfft2(np.fft.rfft2(image) * np.exp(-2j * np.pi * (fy * rows + fx * cols)), image.shape)


def own_shift(a, b, reach_px):
    """Where `a` lies in `b` (rows, columns) to a fraction of a pixel, within reach_px, and the NCC there."""
    inner = a[reach_px:-reach_px, reach_px:-reach_px]
    a0 = inner - inner.mean()
    span = range(-reach_px, reach_px + 1)
    size = inner.shape
    surface = np.array([[ncc(a0, b[reach_px + r:reach_px + r + size[0], reach_px + c:reach_px + c + size[1]])
                         for c in span] for r in span])
    row, col = np.unravel_index(surface.argmax(), surface.shape)
    place = []
    for index, line in ((row, surface[:, col]), (col, surface[row])):
        step = 0.0
        if 0 < index < len(line) - 1:
            bend = line[index - 1] - 2 * line[index] + line[index + 1]
            step = 0.5 * (line[index - 1] - line[index + 1]) / bend if bend < 0 else 0.0
        place.append(index - reach_px + step)
    return place[0], place[1], float(surface.max())


# ---- pairs of tiles, registered ----

def best_shift(a, b, reach_px):
    """Shift (rows, columns) of the whole picture with the highest correlation of structures of 2 … 20 px, and that."""
    a, b = (blur(image, 1.5) - blur(image, 20) for image in (a, b))
    shape = [2 * n for n in a.shape]
    surface = np.fft.irfft2(np.fft.rfft2(b, shape) * np.conj(np.fft.rfft2(a, shape)), shape)
    span = range(-reach_px, reach_px + 1)
    near = surface[np.ix_(span, span)] / np.sqrt((a * a).sum() * (b * b).sum())
    row, col = np.unravel_index(near.argmax(), near.shape)
    return row - reach_px, col - reach_px, float(near.max())


def tiles_of_pairs(folder, pattern, used):
    """Tiles of pairs of one size: pairs that agree nowhere within REACH_PX are left out (they are not registered, or
    nothing is left of the ground), the others moved as a whole and then tile by tile by at most 2 px."""
    for path in sorted(folder.glob(pattern)):
        first, second = (read_gray(p)[0] for p in (path, path.with_name(path.name.replace("_1.png", "_2.png"))))
        rows, cols = (min(sizes) for sizes in zip(first.shape, second.shape))  # some differ by a line
        first, second = first[:rows, :cols], second[:rows, :cols]
        down, right, value = best_shift(first, second, REACH_PX)
        if value < MIN_PAIR_NCC or max(abs(down), abs(right)) == REACH_PX:
            continue
        used.append(path.name)
        for row in range(max(0, -down), rows - TILE_PX - max(0, down) + 1, TILE_PX):
            for col in range(max(0, -right), cols - TILE_PX - max(0, right) + 1, TILE_PX):
                one = first[row:row + TILE_PX, col:col + TILE_PX]
                yield one, aligned(one, second[row + down:row + down + TILE_PX, col + right:col + right + TILE_PX])


def aligned(a, b):
    rows, cols, value = own_shift(blur(a, 1), blur(b, 1), 2)
    if value < MIN_NCC or max(abs(rows), abs(cols)) >= 2:
        return b
    return moved(b, -rows, -cols)


def shifts_of_port(folder):
    """Centres (row, column) of blocks of 114 m in 2019, and how many rows and columns away they lie in 2020."""
    paths = [folder / "port_2019-08.tif", folder / "port_2020-07_registered.tif"]
    images = [read_gray(path) for path in paths]
    valid = images[0][1] & images[1][1]
    smooth = [gray_of(image[2]) for image in images]
    reach = HALF_PX + SHIFT_PX
    places, shifts = [], []
    for row in range(reach, valid.shape[0] - reach, TILE_PX):
        for col in range(reach, valid.shape[1] - reach, TILE_PX):
            around = np.s_[row - reach:row + reach, col - reach:col + reach]
            if valid[around].mean() < MIN_VALID:
                continue
            template = smooth[0][row - HALF_PX:row + HALF_PX, col - HALF_PX:col + HALF_PX]
            right, down, value = find(template, smooth[1][around])
            if value >= MIN_NCC and max(abs(right), abs(down)) < SHIFT_PX:
                places.append((row, col))
                shifts.append((down, right))
    return np.array(places), np.array(shifts)


def tiles_of_port(folder, factor):
    """2019 and 2020, the disagreement that is left taken out as registered_truth.py does it."""
    images = [read_gray(folder / name) for name in ("port_2019-08.tif", "port_2020-07_registered.tif")]
    places, shifts = shifts_of_port(folder)
    rows, cols = images[0][1].shape
    reach = SHIFT_PX
    side = TILE_PX * factor
    for row in range(reach, rows - side - reach, max(TILE_PX, side // 2)):
        for col in range(reach, cols - side - reach, max(TILE_PX, side // 2)):
            centre = (row + side / 2, col + side / 2)
            near = np.argsort(np.hypot(*(places - centre).T), kind="stable")[:NEIGHBOURS]
            down, right = (int(round(v)) for v in np.median(shifts[near], 0))
            one = np.s_[row:row + side, col:col + side]
            other = np.s_[row + down:row + down + side, col + right:col + right + side]
            both = images[0][1][one] & images[1][1][other]
            if both.mean() < MIN_VALID:
                continue
            a, b = (averaged(np.where(both, image, image[both].mean()), factor)
                    for image in (images[0][0][one], images[1][0][other]))
            yield a, aligned(a, b)


def copies(pairs, share, sigma_px, slope=0, illumination=0.15, gamma=0.2):
    """Each first tile and a copy of it as vision/degradation.h makes them (texture, illumination, tone curve): what is
    measured of these is what the measures make of known changes."""
    random = np.random.default_rng(1)
    rows, cols = np.mgrid[:TILE_PX, :TILE_PX] / TILE_PX
    for number, (a, _) in enumerate(pairs):
        coarse = blur(a, sigma_px)
        strength = np.sqrt(np.maximum(blur((a - coarse)**2, 2 * sigma_px), 0))
        field = random.normal(size=a.shape)
        if slope > 0:
            frequency = np.hypot(np.fft.fftfreq(TILE_PX)[:, None], np.fft.rfftfreq(TILE_PX)[None])
            frequency[0, 0] = np.inf
            field = np.fft.irfft2(np.fft.rfft2(field) / frequency**slope, field.shape)
        field -= blur(field, sigma_px)
        copy = coarse + np.sqrt(1 - share**2) * (a - coarse) + share * strength * field / field.std()
        copy = (copy - copy.min()) / max(np.ptp(copy), 1e-9)
        direction, phase = random.uniform(0, 2 * np.pi, 2)
        along = 2 * np.pi * random.uniform(0.5, 1.5) * (np.cos(direction) * cols + np.sin(direction) * rows)
        copy *= 1 + illumination * np.cos(along + phase)
        yield a, 255 * copy**((1 + gamma)**(1 if number % 2 else -1))


# ---- what is measured of a pair of tiles ----

def coherence(a, b):
    """Real part of the coherence per band of wavelength, 0 on average for unrelated pictures; and ln of the ratio of
    powers."""
    side = len(a)
    window = np.hanning(side + 2)[1:-1]
    window = window[:, None] * window[None]
    spectra = [np.fft.rfft2((image - (image * window).sum() / window.sum()) * window) for image in (a, b)]
    frequency = np.hypot(np.fft.fftfreq(side)[:, None], np.fft.rfftfreq(side)[None])
    values, ratios = [], []
    for short, long in zip(BANDS_PX[:-1], BANDS_PX[1:]):
        band = (frequency > 1 / long) & (frequency <= 1 / short)
        cross = (spectra[0][band] * np.conj(spectra[1][band])).real.sum()
        power = [(np.abs(s[band])**2).sum() for s in spectra]
        values.append(cross / np.sqrt(power[0] * power[1]) if min(power) > 0 else np.nan)
        ratios.append(np.log(power[1] / power[0]) if min(power) > 0 else np.nan)
    return values, ratios


def coherence_of_blocks(a, b):
    """The same of blocks of 64 px, each moved by its own shift of at most 4 px, where they look alike (NCC 0.4): what
    is left when parallax and errors of registration are taken out. It is too high, because only alike blocks count."""
    found = []
    for row in range(0, TILE_PX, 64):
        for col in range(0, TILE_PX, 64):
            one, other = (image[row:row + 64, col:col + 64] for image in (a, b))
            rows, cols, value = own_shift(blur(one, 0.7), blur(other, 0.7), 4)
            if value > 0.4 and max(abs(rows), abs(cols)) < 4:
                found.append(coherence(one, moved(other, -rows, -cols))[0])
    return found


def scaled(image):
    low, high = np.quantile(image, [0.005, 0.995])
    return (image - low) / (high - low) if high > low else None


def residuals_in_order(residual, columns, weight):
    """Variance of the coefficients when the residuals stand in random order."""
    random = np.random.default_rng(1)
    fits = [np.linalg.lstsq(columns, random.permutation(residual) * weight, rcond=None)[0] for _ in range(8)]
    return np.mean(np.square(fits), 0)


def light(a, b):
    """Gain that varies across the tile (illumination), offset that varies (haze), the tone curve's exponent and the
    ratio of contrasts, from b = gain·(1 + p·x + q·y)·a + offset + r·x + s·y over means of blocks, 0 … 1 grays."""
    u, v = scaled(a), scaled(b)
    if u is None or v is None:
        return {}
    means = [averaged(image, BLOCK_PX // 2).ravel() for image in (u, v)]
    side = TILE_PX // (BLOCK_PX // 2)
    y, x = (axis.ravel() for axis in np.mgrid[-1:1:side * 1j, -1:1:side * 1j])
    columns = np.stack([np.ones_like(x), x, y, means[0], x * means[0], y * means[0]], 1)
    weight = np.ones(len(x))
    for _ in range(5):  # ground that changed is no light
        fit = np.linalg.lstsq(columns * weight[:, None], means[1] * weight, rcond=None)[0]
        residual = np.abs(means[1] - columns @ fit)
        weight = 1 / np.sqrt(1 + (residual / max(1.5 * np.median(residual), 1e-9))**2)
    result = {"gamma": np.nan, "illumination": np.nan, "haze_offset": np.nan, "contrast": b.std() / a.std()}
    if ncc(means[0], means[1]) > 0.5 and fit[3] > 0.2:
        # What changed ground alone gives: the same residuals in another order.
        noise = residuals_in_order(means[1] - columns @ fit, columns * weight[:, None], weight)
        for name, one, other, unit in (("illumination", 4, 5, fit[3]), ("haze_offset", 1, 2, 1)):
            power = fit[one]**2 + fit[other]**2 - noise[one] - noise[other]
            result[name] = np.sqrt(max(power, 0)) / unit
    quantiles = np.arange(0.1, 0.91, 0.1)
    p, q = np.log(np.clip([np.quantile(u, quantiles), np.quantile(v, quantiles)], 0.01, 0.99))
    result["gamma"] = np.exp(abs(np.log((p * q).sum() / (p * p).sum()))) - 1
    return result


def components(mask):
    """Sizes (pixels of the mask) of its 4-connected parts."""
    label = np.where(mask, np.arange(1, mask.size + 1).reshape(mask.shape), 0)
    while True:
        padded = np.pad(label, 1)
        grown = np.max([padded[1:-1, 1:-1], padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]],
                       0) * mask
        if (grown == label).all():
            return np.unique(label[mask], return_counts=True)[1]
        label = grown


def replaced(a, b):
    """Share of blocks of 8 px with something to see in either date that do not look alike while the tile does, and
    the sides of squares as large as their connected groups."""
    side = BLOCK_PX // 2
    a, b = blur(a, 0.7), blur(b, 0.7)
    if ncc(blur(a, 2), blur(b, 2)) < 0.5:
        return np.nan, []
    count = TILE_PX // side
    strong = np.zeros((count, count), bool)
    other = np.zeros((count, count), bool)
    floors = [0.5 * image.std() for image in (a, b)]
    for row in range(count):
        for col in range(count):
            at = np.s_[row * side:(row + 1) * side, col * side:(col + 1) * side]
            strong[row, col] = a[at].std() > floors[0] or b[at].std() > floors[1]
            other[row, col] = strong[row, col] and ncc(a[at], b[at]) < 0.2
    return other.sum() / max(strong.sum(), 1), list(side * np.sqrt(components(other))) if other.any() else []


def shadows(a, b):
    """Share of the tile that got darker than 0.6 times what the tone curve between the dates says, and lighter than
    1/0.6, over 2 px; and the median factor in the darker part."""
    u, v = scaled(blur(a, 2)), scaled(blur(b, 2))
    if u is None or v is None or ncc(u, v) < 0.3:
        return {}
    quantiles = np.linspace(0, 1, 65)
    told = np.interp(u, np.quantile(u, quantiles), np.quantile(v, quantiles))
    ratio = (v + 0.1) / (told + 0.1)
    lit = told > 0.3  # what was dark cannot get much darker
    dark, light_up = (ratio < 0.6) & lit, ratio > 1 / 0.6
    return {"darker_share": dark.mean(), "lighter_share": light_up.mean(),
            "darker_factor": np.median(ratio[dark]) if dark.sum() > 20 else np.nan}


def residual_shifts(a, b):
    """Shifts (pixels) of blocks of 32 px against the tile's median, where they look alike: parallax, and what
    registration left."""
    a, b = blur(a, 0.7), blur(b, 0.7)
    found = []
    for row in range(0, TILE_PX, 32):
        for col in range(0, TILE_PX, 32):
            at = np.s_[max(0, row - 4):row + 36, max(0, col - 4):col + 36]
            rows, cols, value = own_shift(a[at], b[at], 4)
            if value > 0.6 and max(abs(rows), abs(cols)) < 4:
                found.append((rows, cols))
    if len(found) < 6:
        return []
    return list(np.hypot(*(np.array(found) - np.median(found, 0)).T))


def water(a, b):
    """NCC of date 1 and 2 within blocks of 32 px that vision/degradation_effects.cc takes for water, and in others."""
    deviation = a.std()
    level = blur(a, 4)
    rough = np.sqrt(np.maximum(blur((a - level)**2, 4), 0)) / max(deviation, 1e-9)
    mask = np.clip(((a.mean() - level) / max(deviation, 1e-9) - 0.25) / 0.5, 0, 1)
    mask = mask * (1 - np.clip((rough - 0.2) / 0.2, 0, 1)) > 0.5
    result = {"water": [], "land": []}
    for row in range(0, TILE_PX, 32):
        for col in range(0, TILE_PX, 32):
            at = np.s_[row:row + 32, col:col + 32]
            share = mask[at].mean()
            if share > 0.9 or share < 0.1:
                result["water" if share > 0.9 else "land"].append(ncc(a[at], b[at]))
    return result


# ---- a set of pairs ----

def model_coherence(share, sigma_px):
    """Of a picture and its copy with `share` of what is finer than sigma_px drawn anew, per band."""
    values = []
    for short, long in zip(BANDS_PX[:-1], BANDS_PX[1:]):
        frequency = 2 / (short + long)
        coarse = np.exp(-2 * np.pi**2 * sigma_px**2 * frequency**2)
        kept = coarse + np.sqrt(1 - share**2) * (1 - coarse)
        values.append(kept / np.hypot(kept, share * (1 - coarse)))
    return np.array(values)


def fit_texture(measured):
    """The share and scale whose coherence lies nearest to the measured one, and the root mean square left."""
    best = min((float(np.sqrt(np.mean((model_coherence(share, sigma) - measured)**2))), share, sigma)
               for share in np.arange(0.05, 1.001, 0.05) for sigma in np.geomspace(0.7, 32, 34))
    return {"texture_redrawn": best[1], "texture_scale_px": best[2], "left_rms": best[0]}


def measure(pairs):
    lists = {}

    def add(name, *values):
        lists.setdefault(name, []).extend(v for v in values if np.isfinite(v))

    gammas, alike, count = [], [], 0
    for a, b in pairs:
        if min(a.std(), b.std()) < 1:
            continue
        count += 1
        values, ratios = coherence(a, b)
        gammas.append(values)
        alike.extend(coherence_of_blocks(a, b))
        # What the finest band has lost beside the one around 16 px: a Gaussian of sigma has exp(−4π²σ²ν²) of power.
        slope = (ratios[1] - ratios[5]) / (4 * np.pi**2 * ((2 / 7)**2 - (1 / 14)**2))
        add("blur_px", np.sqrt(abs(slope)))
        for name, value in light(a, b).items():
            add(name, value)
        share, sides = replaced(a, b)
        add("replaced_share", share)
        add("object_side_px", *sides)
        for name, value in shadows(a, b).items():
            add(name, value)
        add("residual_shift_px", *residual_shifts(a, b))
        for name, value in water(a, b).items():
            add(name + "_ncc", *value)
    gammas, alike = np.array(gammas), np.array(alike)
    result = {"tiles": count, "texture": fit_texture(np.nanmedian(gammas, 0)), "blocks_alike": len(alike)}
    if len(alike) >= 20:
        result["texture_alike"] = fit_texture(np.nanmedian(alike, 0))
    for i, (short, long) in enumerate(zip(BANDS_PX[:-1], BANDS_PX[1:])):
        result[f"coherence_{short:g}_{long:g}_px"] = quartiles(gammas[:, i])
        if len(alike) >= 20 and long <= 32:
            result[f"coherence_alike_{short:g}_{long:g}_px"] = quartiles(alike[:, i])
    for name, values in lists.items():
        if len(values) >= 5:
            result[name] = quartiles(values) + [len(values)]
    return result


def quartiles(values):
    return [float(v) for v in np.nanquantile(values, [0.25, 0.5, 0.75])]


def sets_of(data):
    pairs = data / "twodate"
    return {
        "port 0.3 m": lambda used: tiles_of_port(data / "port", 1),
        "port 0.6 m": lambda used: tiles_of_port(data / "port", 2),
        "port 1.2 m": lambda used: tiles_of_port(data / "port", 4),
        "copies by the defaults": lambda used: copies(tiles_of_port(data / "port", 2), DEFAULTS["share"],
                                                      DEFAULTS["sigma_px"]),
        "copies 0.95, 4.5 px": lambda used: copies(tiles_of_port(data / "port", 2), 0.95, 4.5),
        "copies 0.95, 4.5 px, slope 1.5": lambda used: copies(tiles_of_port(data / "port", 2), 0.95, 4.5, 1.5),
        "levir 0.5 m": lambda used: tiles_of_pairs(pairs / "highres", "levir_*_1.png", used),
        "dsifn 2 m": lambda used: tiles_of_pairs(pairs / "highres", "dsifn_*_1.png", used),
        "sentinel2 10 m": lambda used: tiles_of_pairs(pairs / "sentinel2", "*_1.png", used),
    }


def main():
    arguments = sys.argv[1:]
    save = None
    if "--json" in arguments:
        at = arguments.index("--json")
        save = arguments[at + 1]
        del arguments[at:at + 2]
    if not arguments:
        raise SystemExit(__doc__)
    results = {}
    for name, pairs in sets_of(pathlib.Path(arguments[0])).items():
        if len(arguments) > 1 and name.split()[0] not in arguments[1:]:
            continue
        used = []
        results[name] = measure(pairs(used))
        print(name, f"({len(used)} pairs: {' '.join(used)})" if used else "", flush=True)
        for key, value in results[name].items():
            if isinstance(value, list):
                value = "{1:.3g} ({0:.3g} … {2:.3g})".format(*value[:3]) + (f", n = {value[3]}" if value[3:] else "")
            elif isinstance(value, dict):
                value = ", ".join(f"{k} {v:.3g}" for k, v in value.items())
            print(f"  {key}: {value}", flush=True)
    print("today's defaults", dict(zip((f"{a:g}-{b:g}" for a, b in zip(BANDS_PX[:-1], BANDS_PX[1:])),
                                       np.round(model_coherence(DEFAULTS["share"], DEFAULTS["sigma_px"]), 3).tolist())))
    if save:
        pathlib.Path(save).write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()
