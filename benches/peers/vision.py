#!/usr/bin/env python3
"""Times OpenCV and kornia-rs beside `cargo bench -p roverlab-bench --bench vision`, on the same images, and prints one table.

Options: --quick for shorter measurements, --rounds N for how often ours and the peers take turns (3), --save to write how many
times a peer's speed each kernel has to ratios.json beside this file, --since COMMIT to name what has lost more than a tenth since
the ratios.json of a commit or tag; then the program ends with 1.
"""

import argparse
import json
import math
import operator
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

# One thread for all: kornia-rs reads this when it is loaded.
os.environ["RAYON_NUM_THREADS"] = "1"

import cv2
import numpy as np

try:
    import kornia_rs
except ImportError:
    kornia_rs = None

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIZES = [(320, 240), (640, 480), (1920, 1080)]
RATIOS = pathlib.Path("benches/peers/ratios.json")
# Part of a ratio that it may lose by chance.
CHANCE = 0.1
PEERS = {"opencv": "OpenCV", "kornia": "kornia-rs"}


def median(call, quick):
    """The median time of a call in microseconds: of batches that each take long enough for the clock."""
    least, batches = (0.0005, 7) if quick else (0.002, 31)
    calls = 1
    while True:
        start = time.perf_counter()
        for _ in range(calls):
            call()
        if time.perf_counter() - start >= least:
            break
        calls *= 2
    times = []
    for _ in range(batches):
        start = time.perf_counter()
        for _ in range(calls):
            call()
        times.append((time.perf_counter() - start) / calls)
    return 1e6 * statistics.median(times)


def opencv_calls(first, second):
    """A call for each kernel that OpenCV has, with its outputs allocated."""
    gray = cv2.cvtColor(first, cv2.COLOR_RGB2GRAY)
    gray2 = cv2.cvtColor(second, cv2.COLOR_RGB2GRAY)
    edges = cv2.Canny(gray, 60, 150)
    out, tmp = np.empty_like(gray), np.empty_like(gray)
    rgb = np.empty_like(first)
    hsv, mask, mask2 = np.empty_like(first), np.empty_like(gray), np.empty_like(gray)
    s1, s2 = np.empty(gray.shape, np.int16), np.empty(gray.shape, np.int16)
    f1, f2, f3 = (np.empty(gray.shape, np.float32) for _ in range(3))
    a1, a2 = np.empty_like(gray), np.empty_like(gray)
    columns = np.empty((1, gray.shape[1]), np.int32)
    rows = np.empty((gray.shape[0], 1), np.int32)
    red_low, red_high = ((0, 128, 24), (5, 255, 255)), ((175, 128, 24), (179, 255, 255))
    red = np.zeros_like(gray)
    cv2.cvtColor(first, cv2.COLOR_RGB2HSV, hsv)
    cv2.inRange(hsv, *red_low, red)

    def laplace():
        cv2.Laplacian(gray, cv2.CV_16S, s1, 1)
        cv2.convertScaleAbs(s1, out)

    def sobel_l1():
        cv2.Sobel(gray, cv2.CV_16S, 1, 0, s1)
        cv2.Sobel(gray, cv2.CV_16S, 0, 1, s2)
        cv2.convertScaleAbs(s1, a1)
        cv2.convertScaleAbs(s2, a2)
        cv2.add(a1, a2, out)

    def sobel_l2():
        cv2.Sobel(gray, cv2.CV_32F, 1, 0, f1)
        cv2.Sobel(gray, cv2.CV_32F, 0, 1, f2)
        cv2.magnitude(f1, f2, f3)
        cv2.convertScaleAbs(f3, out)

    def hue_match():
        cv2.cvtColor(first, cv2.COLOR_RGB2HSV, hsv)
        cv2.inRange(hsv, *red_low, mask)
        cv2.inRange(hsv, *red_high, mask2)
        cv2.bitwise_or(mask, mask2, mask)

    def hue_histogram():
        hue_match()
        cv2.reduce(mask, 0, cv2.REDUCE_SUM, columns, cv2.CV_32S)

    def projections():
        cv2.reduce(gray, 0, cv2.REDUCE_SUM, columns, cv2.CV_32S)
        cv2.reduce(gray, 1, cv2.REDUCE_SUM, rows, cv2.CV_32S)

    def overlay():
        cv2.cvtColor(gray, cv2.COLOR_GRAY2RGB, rgb)
        rgb[edges != 0] = (255, 0, 0)

    calls = {
        "copy": lambda: np.copyto(out, gray),
        "gray": lambda: cv2.cvtColor(first, cv2.COLOR_RGB2GRAY, out),
        "gray_to_rgb": lambda: cv2.cvtColor(gray, cv2.COLOR_GRAY2RGB, rgb),
        "hsv": lambda: cv2.cvtColor(first, cv2.COLOR_RGB2HSV, hsv),
        "hue_match (opencv)": hue_match,
        "hue_histogram (fused)": hue_histogram,
        "overlay": overlay,
        "threshold": lambda: cv2.threshold(gray, 128, 255, cv2.THRESH_BINARY, out),
        "laplace": laplace,
        "laplace_saturated": lambda: cv2.Laplacian(gray, cv2.CV_8U, out, 1),
        "sobel_l1": sobel_l1,
        "sobel_l2": sobel_l2,
        "gaussian3": lambda: cv2.GaussianBlur(gray, (3, 3), 0, out),
        "gaussian5": lambda: cv2.GaussianBlur(gray, (5, 5), 0, out),
        "gaussian7": lambda: cv2.GaussianBlur(gray, (7, 7), 0, out),
        "canny": lambda: cv2.Canny(gray, 60, 150, out),
        "projections": projections,
        "blobs": lambda: cv2.connectedComponentsWithStats(red, connectivity=8),
        "hough": lambda: cv2.HoughLines(edges, 1, math.pi / 180, 60),
        "hough_probabilistic": lambda: cv2.HoughLinesP(edges, 1, math.pi / 180, 50, minLineLength=30, maxLineGap=5),
        "difference": lambda: cv2.absdiff(gray, gray2, tmp),
        "mean_difference (fused)": lambda: cv2.norm(gray, gray2, cv2.NORM_L1),
    }
    # OpenCV 5 has moved it out of the main modules.
    if hasattr(cv2, "HOGDescriptor"):
        whole = (gray.shape[1] // 8 * 8, gray.shape[0] // 8 * 8)
        hog = cv2.HOGDescriptor(whole, (16, 16), (8, 8), (8, 8), 9)
        calls["hog"] = lambda: hog.compute(gray)
    return calls


def kornia_calls(first, _second):
    """A call for each kernel that kornia-rs's Python package has; it allocates its outputs itself."""
    if kornia_rs is None:
        return {}
    module = getattr(kornia_rs, "imgproc", kornia_rs)
    calls = {}
    gray = np.ascontiguousarray(cv2.cvtColor(first, cv2.COLOR_RGB2GRAY)[..., None])
    candidates = {
        "gray": lambda: module.gray_from_rgb(first),
        "gray_to_rgb": lambda: module.rgb_from_gray(gray),
        "hsv": lambda: module.hsv_from_rgb(first),
        "gaussian3": lambda: module.gaussian_blur(gray, (3, 3), (0.8, 0.8)),
        "gaussian5": lambda: module.gaussian_blur(gray, (5, 5), (1.1, 1.1)),
        "gaussian7": lambda: module.gaussian_blur(gray, (7, 7), (1.4, 1.4)),
        "canny": lambda: module.canny(gray, 60, 150),
        "laplace": lambda: module.laplacian(gray),
    }
    for name, call in candidates.items():
        try:
            call()
            calls[name] = call
        except Exception:  # What this release of the package lacks.
            pass
    return calls


def ours(folder, quick):
    """Our times by kernel and size with those of a copy, and the images that they were taken on, in the folder."""
    file = folder / "ours.json"
    command = ["cargo", "bench", "--quiet", "-p", "roverlab-bench", "--bench", "vision", "--", "--json", str(file), "--images", str(folder)]
    subprocess.run(command + (["--quick"] if quick else []), cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    rows = json.loads(file.read_text())
    return {(row["kernel"], row["width"], row["height"]): (row["microseconds"], row["copy"]) for row in rows}


def ratios(times):
    """How many times a peer's speed each kernel has: the medians over the rounds."""
    rows = {}
    for who, name in PEERS.items():
        for (kernel, width, height), mine in times["ours"].items():
            if peer := times[who].get((kernel, width, height)):
                rows[f"{kernel} {width}x{height} {name}"] = statistics.median(map(operator.truediv, peer, mine))
    return rows


def lost(before, now):
    """What has lost more than chance since before."""
    fell = [row for row in now if row in before and now[row] < (1 - CHANCE) * before[row]]
    return [f"{row}: {before[row]:.2f}, now {now[row]:.2f} times its speed" for row in fell]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--save", action="store_true")
    parser.add_argument("--since", metavar="COMMIT")
    options = parser.parse_args()
    before = None
    if options.since:
        stored = subprocess.run(["git", "show", f"{options.since}:{RATIOS}"], cwd=ROOT, capture_output=True, text=True)
        if stored.returncode:
            parser.error(f"--since {options.since}: found no {RATIOS} there; expected a commit or tag that has one")
        before = json.loads(stored.stdout)
    cv2.setNumThreads(1)
    cv2.ocl.setUseOpenCL(False)
    times = {"ours": {}, "copy": {}, "opencv": {}, "kornia": {}}

    def note(who, key, value):
        times[who].setdefault(key, []).append(value)

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for _ in range(options.rounds):
            for key, (mine, copy) in ours(folder, options.quick).items():
                note("ours", key, mine)
                note("copy", key, copy)
            for width, height in SIZES:
                images = [
                    cv2.cvtColor(cv2.imread(str(folder / f"{part}_{width}x{height}.png")), cv2.COLOR_BGR2RGB)
                    for part in ("first", "second")
                ]
                for who, calls in (("opencv", opencv_calls(*images)), ("kornia", kornia_calls(*images))):
                    for kernel, call in calls.items():
                        note(who, (kernel, width, height), median(call, options.quick))

    best = {who: {key: min(values) for key, values in rows.items()} for who, rows in times.items()}
    print(f"OpenCV {cv2.__version__}, one thread; microseconds, the best of {options.rounds} medians\n")
    print("| kernel | resolution | ours | OpenCV | kornia-rs | times OpenCV's speed | times a copy's time |\n|---|---|---|---|---|---|---|")
    faster, slower = [], []
    for key, mine in best["ours"].items():
        kernel, width, height = key
        cv, kornia = (best[who].get(key) for who in PEERS)
        ratio = cv / mine if cv else None
        if ratio:
            faster.append(ratio)
        for who, peer in zip(PEERS.values(), (cv, kornia)):
            if peer and peer < mine:
                slower.append(f"{kernel} at {width}x{height}: {mine:.1f} against {who}'s {peer:.1f}")
        show = lambda value: f"{value:.1f}" if value else "-"
        print(f"| {kernel} | {width}x{height} | {mine:.1f} | {show(cv)} | {show(kornia)} | {show(ratio)} | {show(mine / best['copy'][key])} |")
    if faster:
        print(f"\nGeometric mean over {len(faster)} rows: {math.exp(statistics.fmean(map(math.log, faster))):.2f} times OpenCV's speed")
    print("\n".join(["Slower than a peer:", *slower]) if slower else "Nowhere slower than a peer")
    now = ratios(times)
    if options.save:
        rows = [f'  {json.dumps(row)}: {ratio:.2f}' for row, ratio in now.items()]
        (ROOT / RATIOS).write_text("{\n" + ",\n".join(rows) + "\n}\n")
    if before is None:
        return 0
    fell = lost(before, now)
    print("\n".join([f"Since {options.since} slower:", *fell]) if fell else f"Since {options.since} nothing has lost more than a tenth")
    return 1 if fell else 0


if __name__ == "__main__":
    sys.exit(main())
