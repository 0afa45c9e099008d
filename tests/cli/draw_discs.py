"""A ground with bright discs and their boxes, for the cases of the landmark commands.

draw_discs.py NAME BRIGHTNESS SEED: writes NAME.pgm (720 x 720 px) and NAME.xml, imglab's annotations of NAME.tif. Discs lie
where they lie whatever the seed, which draws the noise."""

import random
import sys

SIDE = 720


def main():
    name, brightness, seed = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    places = random.Random(7)
    discs = [(120 * (i % 5 + 1) + places.randint(-15, 15), 120 * (i // 5 + 1) + places.randint(-15, 15), places.randint(16, 26))
             for i in range(25)]
    noise = random.Random(seed)
    pixels = bytearray(max(0, min(255, int(noise.gauss(100, 8)))) for _ in range(SIDE * SIDE))
    for x, y, radius in discs:
        for row in range(y - radius, y + radius + 1):
            for column in range(x - radius, x + radius + 1):
                if (row - y) ** 2 + (column - x) ** 2 <= radius ** 2:
                    pixels[row * SIDE + column] = min(255, pixels[row * SIDE + column] + brightness)
    with open(name + ".pgm", "wb") as picture:
        picture.write(b"P5\n%d %d\n255\n" % (SIDE, SIDE) + pixels)
    boxes = "".join(f"<box left='{x - r}' top='{y - r}' width='{2 * r + 1}' height='{2 * r + 1}'><label>disc</label></box>"
                    for x, y, r in discs)
    with open(name + ".xml", "w", encoding="utf-8") as annotations:
        annotations.write(f"<dataset><images><image file='{name}.tif'>{boxes}</image></images></dataset>")


main()
