"""Scenes with a given number of spheres."""

import math
from pathlib import Path

SEED = 1
SPHERES_A_SURFACE = 100
_BITS = (1 << 64) - 1


def _units(seed):
    """Yields numbers evenly spread over 0…1: the stream that `clisc::testing::Stream` draws (splitmix64)."""
    state = seed
    while True:
        state = (state + 0x9E3779B97F4A7C15) & _BITS
        z = ((state ^ (state >> 30)) * 0xBF58476D1CE4E5B9) & _BITS
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _BITS
        yield ((z ^ (z >> 31)) >> 11) / (1 << 53)


def write_cloud(path: Path, n_spheres: int):
    """Writes the scene that `cloud` in `benches/support/input.rs` makes, byte for byte; it says what is in it."""
    unit = _units(SEED).__next__
    mean_radius = math.sqrt(math.log(2) * 600.0 * (4 / 3) / (math.pi * n_spheres * (13 / 12)))
    unfinished = path.with_suffix(".part")
    with open(unfinished, "w", buffering=1 << 20) as file:
        file.write("fov 60\nbackground 0.2 0.3 0.5\n")
        file.write("light 0.6 0.6 0.6 30 40 10\nlight 0.3 0.25 0.2 -40 10 0\nlight 0.2 0.2 0.3 0 5 5\n")
        for sphere_idx in range(n_spheres):
            if sphere_idx % SPHERES_A_SURFACE == 0:
                file.write(_surface(unit, sphere_idx // SPHERES_A_SURFACE))
            depth = 10.0 + 50.0 * unit()
            half_width = depth / math.sqrt(3)
            x, y = half_width * (2.0 * unit() - 1.0), half_width * (2.0 * unit() - 1.0)
            file.write("sphere %.6f %.6f %.6f %.6f\n" % (x, y, -depth, mean_radius * (0.5 + unit())))
        file.write("write cloud.png\n")
    unfinished.rename(path)


def _surface(unit, surface_idx):
    r, g, b = 0.2 + 0.8 * unit(), 0.2 + 0.8 * unit(), 0.2 + 0.8 * unit()
    reflectance = "0.3" if surface_idx % 5 == 0 else "0"
    ambient = (0.2 * r, 0.2 * g, 0.2 * b)
    return "surface %.4f %.4f %.4f  %.4f %.4f %.4f  0.3 0.3 0.3  20  %s\n" % (*ambient, r, g, b, reflectance)
