"""One process: how long it takes, and how much memory it holds at most."""

import ctypes
import functools
import os
import time
from dataclasses import dataclass
from statistics import median

PR_SET_CHILD_SUBREAPER = 36

# Others may use this share of one core before the machine no longer counts as quiet.
QUIET_SHARE = 0.10
# What others may use while a process runs, as a share of its time, before the run is made again.
DIRTY_SHARE = 0.08
# A real-time process is not to hold every core for longer.
MAX_REAL_TIME_SECONDS = 2.0
REAL_TIME_PRIORITY = 20


@dataclass
class Run:
    """One run of a program."""

    seconds: float
    # Processor time, all threads together.
    cpu_seconds: float
    # Processor time that others used meanwhile.
    foreign_seconds: float

    def is_dirty(self):
        return self.foreign_seconds > max(DIRTY_SHARE * self.seconds, 0.02)


def _busy_seconds():
    """Processor time that this machine has spent on anything but low-priority work since it started."""
    with open("/proc/stat") as file:
        user, _nice, system, _idle, _wait, interrupt, soft = map(int, file.readline().split()[1:8])
    return (user + system + interrupt + soft) / os.sysconf("SC_CLK_TCK")


def wait_for_quiet(max_seconds):
    """Waits until the machine is quiet, or no longer than `max_seconds`; tells whether it is."""
    end = time.monotonic() + max_seconds
    while True:
        busy, start = _busy_seconds(), time.monotonic()
        time.sleep(0.15)
        if _busy_seconds() - busy < QUIET_SHARE * (time.monotonic() - start):
            return True
        if time.monotonic() > end:
            return False


def run(command, real_time=False):
    """Runs a command to its end, its output thrown away. Raises `RuntimeError` when it fails."""
    options = {"scheduler": (os.SCHED_FIFO, os.sched_param(REAL_TIME_PRIORITY))} if real_time else {}
    quietly = [(os.POSIX_SPAWN_OPEN, descriptor, os.devnull, os.O_RDWR, 0) for descriptor in range(3)]
    busy, start = _busy_seconds(), time.monotonic()
    child = os.posix_spawnp(command[0], command, os.environ, file_actions=quietly, **options)
    _, status, usage = os.wait4(child, 0)
    seconds = time.monotonic() - start
    _check(command, status)
    cpu_seconds = usage.ru_utime + usage.ru_stime
    return Run(seconds, cpu_seconds, max(0.0, _busy_seconds() - busy - cpu_seconds))


def peak_mebibytes(command):
    """Runs a command to its end and returns the most memory it held. Raises `RuntimeError` when it fails.

    A process inherits the peak of the one that started it, and this interpreter's is some 15 MiB. So a shell, which is
    small, starts the command and ends; the command then becomes a child of this process, which learns of its peak.
    """
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    quietly = [(os.POSIX_SPAWN_OPEN, descriptor, os.devnull, os.O_RDWR, 0) for descriptor in range(3)]
    shell = os.posix_spawn("/bin/sh", ["sh", "-c", '"$@" &', "sh", *command], os.environ, file_actions=quietly)
    os.waitpid(shell, 0)
    _, status, usage = os.wait4(-1, 0)
    _check(command, status)
    return usage.ru_maxrss / 1024


def _check(command, status):
    code = os.waitstatus_to_exitcode(status)
    if code != 0:
        raise RuntimeError(f"exit code {code}: {' '.join(command)}")


@dataclass
class Result:
    """What a program took, over all rounds."""

    runs: list
    peak_mebibytes: float

    def summary(self):
        """Returns medians and spread, as plain data. Dirty runs count only where no other is left."""
        clean = [run for run in self.runs if not run.is_dirty()]
        kept = clean or self.runs
        seconds = [run.seconds for run in kept]
        return {
            "seconds": round(median(seconds), 6),
            "min_seconds": round(min(seconds), 6),
            "max_seconds": round(max(seconds), 6),
            "cpu_seconds": round(median(run.cpu_seconds for run in kept), 6),
            "peak_mebibytes": round(self.peak_mebibytes, 2),
            "n_runs": len(self.runs),
            "n_clean_runs": len(clean),
        }


def interleave(commands, rounds, budget_seconds, max_wait, real_time, before_each):
    """Runs the commands in turn, round after round; returns a `Result` for each name.

    `budget_seconds`: a program takes part in as many rounds as fit, but in one at least.
    `max_wait`: seconds to wait for a quiet machine before each run.
    `real_time`: whether short programs are run before all others; needs the right to.
    `before_each`: is called before each run with the name of the program.
    """
    peaks, runs, n_rounds = {}, {}, {}
    for name, command in commands.items():
        before_each(name)
        start = time.monotonic()
        peaks[name] = peak_mebibytes(command)
        seconds = time.monotonic() - start
        runs[name] = []
        n_rounds[name] = max(1, min(rounds, int(budget_seconds / seconds)))
    for round_idx in range(max(n_rounds.values())):
        for name, command in commands.items():
            if round_idx < n_rounds[name]:
                is_short = all(run.seconds < MAX_REAL_TIME_SECONDS for run in runs[name]) and n_rounds[name] > 5
                prepare = functools.partial(before_each, name)
                runs[name].append(_quiet_run(command, max_wait, real_time and is_short, prepare))
    return {name: Result(runs[name], peaks[name]) for name in commands}


def _quiet_run(command, max_wait, real_time, prepare):
    """Runs a command, and once more when others disturbed it; returns the better run."""
    prepare()
    wait_for_quiet(max_wait)
    first = run(command, real_time)
    if not first.is_dirty():
        return first
    prepare()
    wait_for_quiet(max_wait)
    second = run(command, real_time)
    return min(first, second, key=lambda run: run.foreign_seconds / run.seconds)
