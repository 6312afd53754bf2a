"""The measured part of `docs/performance.md`: tables and plots of what `measured.json` holds."""

from measure.plot import fitted_exponent, log_log

BEGIN = "<!-- measured: written by benches/compare.py, not by hand -->"
END = "<!-- end of what was measured -->"
OURS = "clisc"


def replace_measured(page, text):
    """Puts `text` between the markers of a page."""
    before, _, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise RuntimeError(f"the page lacks `{BEGIN}` and `{END}`")
    return f"{before}{BEGIN}\n\n{text}\n{END}{after}"


def measured_part(groups):
    """Returns all tables and the commands, in the order of `groups`."""
    sections = [_section(group) for group in groups if group["cases"]]
    return "\n".join([*sections, _commands(groups)])


def _commands(groups):
    cases = [case for group in groups for case in group["cases"]]
    commands = {name: result["command"] for case in cases for name, result in case["programs"].items()}
    lines = [f"{name + ':':12} {command}" for name, command in commands.items()]
    return "## Commands\n\n```text\n" + "\n".join(lines) + "\n```\n"


def _section(group):
    cases = group["cases"]
    names = list(dict.fromkeys(name for case in cases for name in case["programs"]))
    parts = [f"## {group['title']}\n", f"{group['note']}\n", _provenance(group), _times(cases, names)]
    parts += [_ratios(cases, names), _memory(cases, names)]
    if group["axis"]:
        parts.append(f"![{group['title']}](performance/{group['name']}.svg)\n")
        parts.append(_exponents(group))
    return "\n".join(parts)


def _provenance(group):
    taken = sorted({(case["commit"], case["date"], case["machine"]) for case in group["cases"]})
    return "".join(f"Measured at commit `{commit}` on {date}; {machine}.\n" for commit, date, machine in taken)


def _table(head, rows):
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def _times(cases, names):
    def cell(case, name):
        result = case["programs"].get(name)
        return f"{_ms(result['seconds'])} ({_ms(result['min_seconds'])}…{_ms(result['max_seconds'])})" if result else "–"

    rows = [[case["name"], *(cell(case, name) for name in names), _runs(case)] for case in cases]
    return "Time of the whole process in ms, median (least…most):\n\n" + _table(["", *names, "runs"], rows)


def _runs(case):
    """How many runs of ours there were, and how many of them others did not disturb."""
    ours = case["programs"][OURS]
    return f"{ours['n_runs']}, {ours['n_clean_runs']} undisturbed"


def _ratios(cases, names):
    others = [name for name in names if name != OURS]

    def cell(case, name):
        result = case["programs"].get(name)
        return f"{result['seconds'] / case['programs'][OURS]['seconds']:.2f}" if result else "–"

    rows = [[case["name"], *(cell(case, name) for name in others)] for case in cases]
    note = "How many times as long as clisc each takes (ratio of medians; below 1 it is faster than clisc):\n\n"
    return note + _table(["", *others], rows)


def _memory(cases, names):
    def cell(case, name):
        result = case["programs"].get(name)
        return f"{result['peak_mebibytes']:.1f}" if result else "–"

    rows = [[case["name"], *(cell(case, name) for name in names)] for case in cases]
    return "Most memory held, in MiB:\n\n" + _table(["", *names], rows)


def _ms(seconds):
    ms = 1000 * seconds
    return f"{ms:.0f}" if ms >= 100 else f"{ms:.1f}" if ms >= 10 else f"{ms:.2f}"


def series(group):
    """Returns for each program its points along the axis of a group: (size, seconds)."""
    found = {}
    for case in group["cases"]:
        for name, result in case["programs"].items():
            if name != "true":
                found.setdefault(name, []).append((case[group["axis"]], result["seconds"]))
    return {name: points for name, points in found.items() if len(points) > 1}


def _upper_half(points):
    """The points of the larger half of the sizes, where what is done once no longer counts."""
    return points[len(points) // 2 :] if len(points) > 3 else points


def _exponents(group):
    rows = []
    for name, points in series(group).items():
        steps = [f"{fitted_exponent(points[i : i + 2]):.2f}" for i in range(len(points) - 1)]
        upper = _upper_half(points)
        rows.append([name, f"{fitted_exponent(upper):.2f}", f"{fitted_exponent(points):.2f}", ", ".join(steps)])
    head = ["", "exponent, larger half", "exponent, all", "from each size to the next"]
    return f"Time grows with {group['axis_label']} to the power of:\n\n" + _table(head, rows)


def plot(group):
    """Returns the plot of a group."""
    fitted = {}
    for name, points in series(group).items():
        fitted[name] = points, f"exponent {fitted_exponent(_upper_half(points)):.2f}"
    return log_log(group["title"], group["axis_label"], "seconds", fitted)
