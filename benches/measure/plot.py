"""Log-log plots as SVG."""

import math
from html import escape

WIDTH, HEIGHT = 720, 460
LEFT, RIGHT, TOP, BOTTOM = 70, 150, 40, 60
COLOURS = {
    "clisc": "#c0392b",
    "clisc-f32": "#e67e22",
    "clisc-f64": "#c2a878",
    "embree": "#2563a8",
    "brute": "#2e8b57",
    "Tachyon": "#7d5ba6",
}


class Axis:
    """A logarithmic axis between whole powers of ten, from pixel `start` to pixel `end`."""

    def __init__(self, values, start, end):
        self.low, self.high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
        self.start, self.end = start, end

    def at(self, value):
        return self.start + (math.log10(value) - self.low) / (self.high - self.low) * (self.end - self.start)

    def powers(self):
        return range(self.low, self.high + 1)


def log_log(title, x_label, y_label, series):
    """Returns the plot of `series`: for each name its points, in order, and a word on them for the legend."""
    points = [point for points, _ in series.values() for point in points]
    x_axis = Axis([x for x, _ in points], LEFT, WIDTH - RIGHT)
    y_axis = Axis([y for _, y in points], HEIGHT - BOTTOM, TOP)
    parts = [_frame(title, x_label, y_label), *_grid(x_axis, y_axis)]
    for series_idx, (name, (points, note)) in enumerate(series.items()):
        parts += _line(x_axis, y_axis, points, COLOURS.get(name, "#555"))
        parts += _legend(series_idx, name, note)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">'
    return "\n".join([head, *parts, "</svg>"]) + "\n"


def _frame(title, x_label, y_label):
    centre_x, centre_y = (LEFT + WIDTH - RIGHT) / 2, (TOP + HEIGHT - BOTTOM) / 2
    return (
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>\n'
        f'<text x="{centre_x}" y="24" text-anchor="middle" font-size="15">{escape(title)}</text>\n'
        f'<text x="{centre_x}" y="{HEIGHT - 18}" text-anchor="middle">{escape(x_label)}</text>\n'
        f'<text transform="translate(20 {centre_y}) rotate(-90)" text-anchor="middle">{escape(y_label)}</text>'
    )


def _grid(x_axis, y_axis):
    for power in x_axis.powers():
        x = x_axis.at(10.0**power)
        yield f'<path d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
        yield f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{_power_of_ten(power)}</text>'
    for power in y_axis.powers():
        y = y_axis.at(10.0**power)
        yield f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
        yield f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{_power_of_ten(power)}</text>'


def _power_of_ten(power):
    return "10" + str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _line(x_axis, y_axis, points, colour):
    placed = [(x_axis.at(x), y_axis.at(y)) for x, y in points]
    path = "L".join(f"{x:.1f} {y:.1f}" for x, y in placed)
    yield f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="2"/>'
    for x, y in placed:
        yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}"/>'


def _legend(series_idx, name, note):
    x, y = WIDTH - RIGHT + 14, TOP + 16 + 40 * series_idx
    yield f'<path d="M{x} {y - 4}h18" stroke="{COLOURS.get(name, "#555")}" stroke-width="2"/>'
    yield f'<text x="{x + 24}" y="{y}">{escape(name)}</text>'
    yield f'<text x="{x + 24}" y="{y + 15}" font-size="10" fill="#555">{escape(note)}</text>'


def fitted_exponent(points):
    """Returns the slope of the line through the logarithms of the points that leaves the least squares."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mean_x, mean_y = (sum(log[axis] for log in logs) / len(logs) for axis in (0, 1))
    covariance = sum((x - mean_x) * (y - mean_y) for x, y in logs)
    return covariance / sum((x - mean_x) ** 2 for x, _ in logs)
