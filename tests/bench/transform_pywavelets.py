#!/usr/bin/python3
"""Sets the times of PyWavelets' wavedec2(image, 'haar', 'periodization') beside transform_bench's.

Usage: transform_pywavelets.py build/release/bin/transform_bench
Run by hand; needs Debian's python3-pywt. One thread and one channel, float beside float and double
beside double, best of many runs. The exit code is 1 if PyWavelets is as fast anywhere.
"""
import json
import subprocess
import sys
import time

import numpy
import pywt

TYPES = {"float": numpy.float32, "double": numpy.float64}


def ours(bench):
    """Microseconds of the forward transform by (type, size)."""
    run = subprocess.run([bench, "--benchmark_filter=transform<.*channels:1/", "--benchmark_format=json"],
                         check=True, stdout=subprocess.PIPE, text=True)
    times = {}
    for row in json.loads(run.stdout)["benchmarks"]:
        kind = row["name"].split("<")[1].split(">")[0]
        size = int(row["name"].split("size:")[1].split("/")[0])
        times[kind, size] = row["forward_us"]
    return times


def pywavelets(kind, size):
    """Microseconds of the same transform, its output a list of arrays."""
    image = numpy.random.default_rng(3).random((size, size)).astype(TYPES[kind])
    best = float("inf")
    for _ in range(max(5, 2**23 // size**2)):
        start = time.perf_counter()
        pywt.wavedec2(image, "haar", "periodization")
        best = min(best, time.perf_counter() - start)
    return 1e6 * best


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    slower = False
    print(f"{'type':8}{'size':>6}{'ours us':>12}{'pywt us':>12}{'ratio':>8}")
    for (kind, size), time_us in ours(sys.argv[1]).items():
        rival = pywavelets(kind, size)
        slower = slower or rival <= time_us
        print(f"{kind:8}{size:6}{time_us:12.2f}{rival:12.1f}{rival / time_us:8.1f}")
    sys.exit(1 if slower else 0)


main()
