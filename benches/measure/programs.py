"""The programs, and how each is told to make an image."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path


@dataclass
class Case:
    """One image to be made."""

    name: str
    scene: Path
    side: int
    n_objects: int


class Clisc:
    """This project. It checks the scene and writes a PNG; `options` are more arguments."""

    reads_cli = True

    def __init__(self, name, binary, options=()):
        self.name, self.binary, self.options = name, binary, list(options)
        self.shown = " ".join(["clisc run SCENE --quiet --size WxH --out-dir FOLDER", *options])

    def takes(self, case):
        return True

    def command(self, case, folder):
        size = f"{case.side}x{case.side}"
        fixed = ["run", str(case.scene), "--quiet", "--size", size, "--out-dir", str(folder / self.name)]
        return [str(self.binary), *fixed, *self.options]

    def images(self, folder):
        """Returns the files that the command has made."""
        return list((folder / self.name).glob("*.png"))


class Native:
    """A peer that reads `.cli` itself and writes a PPM."""

    reads_cli = True

    def __init__(self, name, binary, option, max_objects):
        self.name, self.binary, self.option, self.max_objects = name, binary, option, max_objects
        self.shown = f"{name} SCENE WxH IMAGE.ppm {option}"

    def takes(self, case):
        return case.n_objects <= self.max_objects

    def command(self, case, folder):
        return [str(self.binary), str(case.scene), f"{case.side}x{case.side}", str(folder / f"{self.name}.ppm"), self.option]

    def images(self, folder):
        return list(folder.glob(f"{self.name}.ppm"))


class Converted:
    """A peer with a language of its own; the translation is not timed."""

    reads_cli = False

    def __init__(self, name, converter, suffix, arguments, max_objects):
        self.name, self.converter, self.suffix, self.arguments = name, converter, suffix, arguments
        self.max_objects = max_objects
        self.shown = " ".join(arguments("SCENE" + suffix, "W", "IMAGE"))

    def takes(self, case):
        return case.n_objects <= self.max_objects

    def command(self, case, folder):
        translated = folder / f"{case.scene.stem}-{case.side}{self.suffix}"
        if not translated.exists():
            converter = [sys.executable, str(self.converter), str(case.scene), str(translated)]
            subprocess.run(converter + ([str(case.side)] if self.suffix == ".dat" else []), check=True)
        return self.arguments(str(translated), str(case.side), str(folder / self.name))

    def images(self, folder):
        return list(folder.glob(f"{self.name}.ppm"))


class Empty:
    """A program that does nothing: what it takes to start and end one."""

    name = shown = "true"
    reads_cli = False

    def takes(self, case):
        return True

    def command(self, case, folder):
        return ["true"]

    def images(self, folder):
        return []


def tachyon(scene, side, image):
    fixed = ["-fullshade", "-shade_blinn", "-numthreads", "2", "-format", "PPM"]
    return ["tachyon", scene, "-res", side, side, *fixed, "-o", image + ".ppm"]


def povray(scene, side, image):
    # `+MI`: room for the image in memory, in MB; without it a large image goes to a slow file first.
    fixed = ["+FP8", "File_Gamma=1.0", "Dither=off", "-D", "-A", "-V", "+Q9", "+WT2", "+MI2048"]
    return ["povray", "+I" + scene, "+O" + image + ".ppm", f"+W{side}", f"+H{side}", *fixed]


def programs(clisc, peers, converters):
    """Returns every program that there is, ours first.

    `clisc`: our binary. `peers`: the folder of `embree` and `brute`, or `None`. `converters`: the folder of
    `cli2tachyon.py` and `cli2pov.py`, or `None`.
    """
    found = [Clisc("clisc", clisc)]
    if "--precision" in subprocess.run([clisc, "run", "--help"], capture_output=True, text=True, check=True).stdout:
        found.append(Clisc("clisc-f32", clisc, ["--precision", "f32"]))
        found.append(Clisc("clisc-f64", clisc, ["--precision", "f64"]))
    if peers:
        found.append(Native("embree", peers / "embree", "-inc", 10**9))
        # Without a tree each ray tests each object: beyond a thousand the answer is known, and long in coming.
        found.append(Native("brute", peers / "brute", "-brute", 1000))
    if converters:
        # Ten million objects would take these tens of GiB.
        found.append(Converted("Tachyon", converters / "cli2tachyon.py", ".dat", tachyon, 10**6))
        found.append(Converted("POV-Ray", converters / "cli2pov.py", ".pov", povray, 10**6))
    return found + [Empty()]
