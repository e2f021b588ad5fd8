"""Log-log plots as SVG, with nothing but the standard library."""

import math
from dataclasses import dataclass, field
from html import escape

COLORS = ["#1b6ca8", "#d1495b", "#2e933c", "#8e44ad", "#e08e0b", "#3b3b3b", "#17a2a2", "#a0522d", "#6b8e23",
          "#c71585", "#708090", "#4b0082"]
WIDTH, HEIGHT = 760, 480
LEFT, RIGHT, TOP, BOTTOM = 80, 190, 40, 60


@dataclass
class Series:
    name: str
    points: list = field(default_factory=list)  # (x, y), both > 0


@dataclass
class Axis:
    """One logarithmic axis: whole decades, from `low` to `high` pixels."""

    first: int
    last: int
    low: float
    high: float

    def at(self, value):
        share = (math.log10(value) - self.first) / (self.last - self.first)
        return self.low + share * (self.high - self.low)


def axis_over(values, low, high):
    first = math.floor(math.log10(min(values)) + 1e-9)
    last = math.ceil(math.log10(max(values)) - 1e-9)
    return Axis(first, max(last, first + 1), low, high)


def text(x, y, content, **attributes):
    settings = "".join(f' {name.replace("_", "-")}="{value}"' for name, value in attributes.items())
    return f'<text x="{x:.1f}" y="{y:.1f}"{settings}>{escape(content)}</text>'


def line(x1, y1, x2, y2, color):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{color}"/>'


def grid(x_axis, y_axis, x_label, y_label):
    parts = []
    for decade in range(x_axis.first, x_axis.last + 1):
        x = x_axis.at(10.0**decade)
        parts.append(line(x, y_axis.low, x, y_axis.high, "#dddddd"))
        parts.append(text(x, y_axis.low + 18, f"1e{decade}", text_anchor="middle"))
    for decade in range(y_axis.first, y_axis.last + 1):
        y = y_axis.at(10.0**decade)
        parts.append(line(x_axis.low, y, x_axis.high, y, "#dddddd"))
        parts.append(text(x_axis.low - 8, y + 4, f"1e{decade}", text_anchor="end"))
    parts.append(text((x_axis.low + x_axis.high) / 2, HEIGHT - 16, x_label, text_anchor="middle"))
    middle = (y_axis.low + y_axis.high) / 2
    parts.append(text(20, middle, y_label, text_anchor="middle", transform=f"rotate(-90 20 {middle:.1f})"))
    return parts


def curve(series, color, x_axis, y_axis, row):
    points = [(x_axis.at(x), y_axis.at(y)) for x, y in sorted(series.points)]
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    parts = [f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="1.8"/>']
    parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{color}"/>' for x, y in points]
    y = TOP + 14 + 18 * row
    parts.append(f'<rect x="{WIDTH - RIGHT + 14}" y="{y - 9}" width="12" height="4" fill="{color}"/>')
    parts.append(text(WIDTH - RIGHT + 32, y - 3, series.name))
    return parts


def log_log(title, x_label, y_label, all_series):
    """The plot as text; None if there is nothing to plot."""
    all_series = [series for series in all_series if series.points]
    if not all_series:
        return None
    points = [point for series in all_series for point in series.points]
    x_axis = axis_over([x for x, _ in points], LEFT, WIDTH - RIGHT)
    y_axis = axis_over([y for _, y in points], HEIGHT - BOTTOM, TOP)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
             f'height="{HEIGHT}" font-family="sans-serif" font-size="12">',
             f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>', text(LEFT, 24, title, font_size="15")]
    parts += grid(x_axis, y_axis, x_label, y_label)
    for row, series in enumerate(all_series):
        parts += curve(series, COLORS[row % len(COLORS)], x_axis, y_axis, row)
    return "\n".join(parts + ["</svg>", ""])
