"""Resident memory of processes, as the kernel reports it."""
import math
import subprocess
import time
from pathlib import Path


def largest_memory(process):
    """Largest resident memory so far of a process in MB, as the kernel keeps it; rusage would count the parent it was forked from."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return max([int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM")], default=0)


def peak_of(process, limit=math.inf):
    """Largest resident memory of a running process in MB, when it has ended; None if it did not end within so many seconds and
    was killed."""
    peak, start = 0, time.monotonic()
    while process.poll() is None:
        if time.monotonic() - start > limit:
            process.kill()
            process.wait()
            return None
        try:
            peak = max(peak, largest_memory(process.pid))
        except OSError:
            pass
        try:
            process.wait(0.02)
        except subprocess.TimeoutExpired:
            pass
    return peak
