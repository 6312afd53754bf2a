"""Whether two programs made the same picture. What makes another picture is not compared in time."""

import zlib
from pathlib import Path

# Channel steps by which two programs may differ in a pixel: the peers compute in binary32.
TOLERANCE = 8


def share_of_different_pixels(first: Path, second: Path):
    """Returns the share of pixels in which some channel differs by more than `TOLERANCE` steps."""
    (size, pixels), (other_size, other_pixels) = read(first), read(second)
    if size != other_size:
        raise RuntimeError(f"{first.name} is {size}, {second.name} is {other_size}")
    n_different = 0
    for start in range(0, len(pixels), 3):
        # Most pixels are equal to the bit.
        if pixels[start : start + 3] != other_pixels[start : start + 3]:
            channels = range(start, start + 3)
            n_different += any(abs(pixels[idx] - other_pixels[idx]) > TOLERANCE for idx in channels)
    return 3 * n_different / len(pixels)


def read(path: Path):
    """Returns the size of an image and its bytes, 3 a pixel."""
    data = path.read_bytes()
    return _read_png(data) if data.startswith(b"\x89PNG") else _read_ppm(data)


def _read_ppm(data):
    magic, width, height, most = data[:40].split()[:4]
    if magic != b"P6" or most != b"255":
        raise RuntimeError("a PPM of 8-bit colours was expected")
    size = int(width), int(height)
    return size, data[len(data) - 3 * size[0] * size[1] :]


def _read_png(data):
    """Reads an 8-bit RGB image without interlacing."""
    width, height = (int.from_bytes(data[at : at + 4]) for at in (16, 20))
    packed, at = b"", 8
    while at < len(data):
        n_bytes, kind = int.from_bytes(data[at : at + 4]), data[at + 4 : at + 8]
        if kind == b"IDAT":
            packed += data[at + 8 : at + 8 + n_bytes]
        at += 12 + n_bytes
    filtered, row_bytes = zlib.decompress(packed), 3 * width
    pixels, above = bytearray(), bytearray(row_bytes)
    for start in range(0, len(filtered), row_bytes + 1):
        above = _unfilter(filtered[start], filtered[start + 1 : start + 1 + row_bytes], above)
        pixels += above
    return (width, height), bytes(pixels)


def _unfilter(kind, filtered, above):
    """Undoes the filter of one row, as the PNG specification numbers them."""
    row = bytearray(filtered)
    if kind == 0:
        return row
    for idx in range(len(row)):
        left, corner = (row[idx - 3], above[idx - 3]) if idx >= 3 else (0, 0)
        up = above[idx]
        if kind == 1:
            predicted = left
        elif kind == 2:
            predicted = up
        elif kind == 3:
            predicted = (left + up) // 2
        else:
            predicted = _paeth(left, up, corner)
        row[idx] = (row[idx] + predicted) & 255
    return row


def _paeth(left, up, corner):
    estimate = left + up - corner
    return min((left, up, corner), key=lambda value: abs(estimate - value))
