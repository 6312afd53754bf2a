#!/usr/bin/env python3
"""Times clisc beside other programs, as whole processes, and writes docs/performance.md.

Every program is run once to see that it works and how much memory it takes; then all are run in turn, round after
round, each after waiting for a quiet machine. What others disturb is run again. Medians, spread, ratios and commands go
to docs/performance.md, between its markers; the plots and the numbers themselves to docs/performance/. Groups that are
not asked for keep the numbers they have.

  cargo build --release
  benches/compare.py --originals FOLDER --peers FOLDER --converters FOLDER
  benches/compare.py --groups small large ... -n 15       some groups only
  benches/compare.py --groups                             write the page anew from the numbers there are
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from measure import picture, process, programs, report, scenes
from measure.programs import Case

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/performance.md"
DATA = ROOT / "docs/performance"

ORIGINALS = ["i1", "i5", "i6", "i9", "i10"]
CLOUDS = [10**power for power in range(2, 8)]
SIDES = [300, 1000, 2000, 4000, 8000, 16000]

GROUPS = {
    "large": ("Small scenes, large images", "i1 to i10 at 4000×4000.", None, None),
    "small": ("Small scenes, small images", "i1 to i10 at 300×300; `true` is a program that does nothing.", None, None),
    "objects": (
        "Growing scenes",
        "Clouds of spheres at 1000×1000, from text to image.",
        "n_objects",
        "number of spheres",
    ),
    "pixels": ("Growing images", "i9 from 300×300 to 16000×16000.", "n_pixels", "number of pixels"),
    "largest": ("The largest image", "i1 at 65535×65535: memory is bounded by bands, not by the image.", None, None),
}


def cases_of(group, originals, folder):
    """Yields the cases of a group."""
    if group in ("large", "small"):
        for name in ORIGINALS:
            yield Case(name, originals / f"{name}.cli", 4000 if group == "large" else 300, 10)
    elif group == "objects":
        for n_spheres in CLOUDS:
            scene = folder / f"cloud-{n_spheres}.cli"
            if not scene.exists():
                scenes.write_cloud(scene, n_spheres)
            yield Case(f"{n_spheres:,} spheres", scene, 1000, n_spheres)
    elif group == "pixels":
        for side in SIDES:
            yield Case(f"{side}×{side}", originals / "i9.cli", side, 10)
    else:
        yield Case("65535×65535", originals / "i1.cli", 65535, 10)


def takes_part(program, group, case):
    """Tells whether a program takes part in a case: whether it can, and whether anything is learnt from it."""
    if group == "largest":
        return program.name == "clisc"
    if program.name == "true":
        return group == "small"
    if program.name in ("Tachyon", "POV-Ray") and group == "pixels":
        return False
    return program.takes(case)


def measure(group, case, contenders, folder, args):
    """Measures one case; returns it as plain data."""
    commands = {program.name: program.command(case, folder) for program in contenders}
    by_name = {program.name: program for program in contenders}

    def remove_images(name):
        """Replacing a file takes time that depends on what was in it."""
        for image in by_name[name].images(folder):
            image.unlink()

    results = process.interleave(
        commands, args.rounds, args.budget, args.max_wait, args.real_time, before_each=remove_images
    )
    if case.side <= 1000:
        check_pictures(case, contenders, folder)
    return {
        "name": case.name,
        "n_objects": case.n_objects,
        "n_pixels": case.side**2,
        "commit": args.commit or commit(),
        "date": time.strftime("%Y-%m-%d"),
        "machine": machine(),
        "programs": {program.name: results[program.name].summary() | {"command": program.shown} for program in contenders},
    }


# Pixels that may be others than ours.
MAX_SHARE_OF_OTHERS = 0.05


def check_pictures(case, contenders, folder):
    """Sees to it that those who read `.cli` made the same picture, but for what binary32 gets wrong at silhouettes: of a
    million spheres, most no larger than a pixel, more than one pixel in a hundred lies on one, of ten million nearly four."""
    images = {program.name: program.images(folder)[0] for program in contenders if program.reads_cli}
    ours = images.pop("clisc")
    for name, image in images.items():
        share = picture.share_of_different_pixels(ours, image)
        if share > MAX_SHARE_OF_OTHERS:
            raise RuntimeError(f"{case.name}: {share:.1%} of the pixels of {name} are others than ours")


def commit():
    """Returns the commit of this tree, with `+` when something in it has changed."""
    git = ["git", "-C", str(ROOT)]
    name = subprocess.run([*git, "rev-parse", "--short=10", "HEAD"], capture_output=True, text=True, check=True).stdout
    changed = [*git, "status", "--porcelain", "--", "src", "Cargo.toml", "Cargo.lock"]
    return name.strip() + ("+" if subprocess.run(changed, capture_output=True, check=True).stdout else "")


def machine():
    """Describes this machine in a line."""
    info = Path("/proc/cpuinfo").read_text()
    model = next(line.partition(":")[2].strip() for line in info.splitlines() if line.startswith("model name"))
    widest = next((name for name in ("avx512f", "avx2") if name in info), "neither AVX2 nor AVX-512")
    gibibytes = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
    rustc = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    system = f"{platform.system()} {platform.release()}"
    return f"{os.cpu_count()} cores of {model} ({widest}), {gibibytes:.0f} GiB, {system}, rustc {rustc}"


def load(group):
    """Returns what is known of a group."""
    title, note, axis, axis_label = GROUPS[group]
    path = DATA / f"{group}.json"
    cases = json.loads(path.read_text()) if path.exists() else []
    return {"name": group, "title": title, "note": note, "axis": axis, "axis_label": axis_label, "cases": cases}


def write_page():
    """Writes page and plots from what is known."""
    groups = [load(group) for group in GROUPS]
    PAGE.write_text(report.replace_measured(PAGE.read_text(), report.measured_part(groups)))
    for group in groups:
        if group["axis"] and group["cases"]:
            (DATA / f"{group['name']}.svg").write_text(report.plot(group))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    folder = {"type": Path, "metavar": "FOLDER"}
    parser.add_argument("--groups", nargs="*", choices=GROUPS, default=list(GROUPS), help="what to measure")
    parser.add_argument("--clisc", type=Path, default=ROOT / "target/release/clisc", help="our binary")
    parser.add_argument("--commit", metavar="NAME", help="the commit of our binary; else that of this tree")
    parser.add_argument("--originals", help="the scenes i1.cli to i10.cli", **folder)
    parser.add_argument("--peers", help="the programs embree and brute", **folder)
    parser.add_argument("--converters", help="cli2tachyon.py and cli2pov.py", **folder)
    parser.add_argument("--without", nargs="*", default=[], metavar="NAME", help="programs to leave out, say POV-Ray")
    parser.add_argument("--work", help="scenes and images go here, and clouds are kept; else a temporary one", **folder)
    parser.add_argument("-n", "--rounds", type=int, default=9)
    parser.add_argument("--budget", type=float, default=30, help="seconds for all rounds of one program in one case")
    parser.add_argument("--max-wait", type=float, default=5, help="seconds to wait for a quiet machine before a run")
    parser.add_argument("--real-time", action="store_true", help="run short programs before all others (needs root)")
    return parser.parse_args()


def main():
    args = arguments()
    DATA.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = (args.work or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        contenders = programs.programs(args.clisc, args.peers, args.converters) if args.groups else []
        for group in args.groups:
            if group != "objects" and not args.originals:
                sys.exit(f"the group `{group}` needs --originals")
            measured = []
            for case in cases_of(group, args.originals, folder):
                of_case = [p for p in contenders if p.name not in args.without and takes_part(p, group, case)]
                measured.append(measure(group, case, of_case, folder, args))
                shown = {name: f"{result['seconds'] * 1000:.1f}" for name, result in measured[-1]["programs"].items()}
                print(f"{group}, {case.name}: ms {shown}", flush=True)
                (DATA / f"{group}.json").write_text(json.dumps(measured, indent=1) + "\n")
    write_page()


if __name__ == "__main__":
    main()
