#!/usr/bin/python3
"""Makes the gate's baseline of several runs of scripts/gate.

    make_baseline.py BASELINE RESULTS...

Each RESULTS is the evaluation/results.json of a run: of the same scene on different machines, or with a number of it
changed in its last digits, which is what another machine's rounding does. A metric's value is the runs' median. Its
tolerance is the one it came with, or three times the runs' largest relative distance from the median, whichever is more.
Ratios of times are given a half at least: what a cache or a busy neighbour makes of them on another machine. A metric that
the runs do not agree on within a third is told and not judged, and so is an error that is rounding; one that is not in all
runs is left out."""

import json
import statistics
import sys

FACTOR = 3.0
MOST = 1.0 / 3.0
OF_TIME = 0.5
ROUNDING = 1e-9


def merged(metric, others):
    values = [one["value"] for one in [metric] + others]
    one = dict(metric)
    if None in values or one["direction"] == "none":
        one["direction"] = "none"
        return one
    middle = statistics.median(values)
    apart = max(abs(value - middle) for value in values)
    relative = apart / abs(middle) if middle else (0.0 if apart == 0.0 else float("inf"))
    one["value"] = middle
    one["interval"] = [middle, middle]
    one.pop("distribution", None)
    timed = one["metric"].endswith("/time_ratio")
    rounding = abs(middle) < ROUNDING and one["unit"] not in ("%", "cases")
    if rounding or (relative > MOST and not timed):
        one["direction"] = "none"
    else:
        one["tolerance"] = max(one["tolerance"], FACTOR * relative)
        if timed:
            one["tolerance"] = min(max(one["tolerance"], OF_TIME), 0.9)  # twice the time is worse whatever the spread
    return one


def main():
    target, *paths = sys.argv[1:]
    runs = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            runs.append(json.load(file))
    by_name = [{one["metric"]: one for one in run["metric"]} for run in runs]
    baseline = dict(runs[0])
    baseline["metric"] = [merged(one, [run[one["metric"]] for run in by_name[1:]]) for one in runs[0]["metric"]
                          if all(one["metric"] in run for run in by_name)]
    with open(target, "w", encoding="utf-8") as file:
        json.dump(baseline, file, indent=1)
        file.write("\n")
    judged = [one for one in baseline["metric"] if one["direction"] != "none"]
    wide = [one for one in judged if one["tolerance"] > 0.2]
    print(f"{len(baseline['metric'])} metrics, {len(judged)} judged, {len(wide)} of them with a tolerance above 20 %")


if __name__ == "__main__":
    main()
