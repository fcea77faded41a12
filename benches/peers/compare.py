"""Runs terrace and other programs on the same scenes, and prints what they found and what it took. See README.md."""
import argparse
import itertools
import json
import os
import resource
import shutil
import signal
import statistics
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target")).resolve()
BUILT = TARGET / "peers"
SETTINGS = HERE / "settings.json"
GRIDS = HERE / "grids.json"

OPEN3D = [str(BUILT / "venv/bin/python"), str(HERE / "programs/open3d_planes.py")]
# How each program is started, and what it needs to be there.
PROGRAMS = {
    "cgal_region_growing": [str(BUILT / "build/cgal_region_growing")],
    "cgal_ransac": [str(BUILT / "build/cgal_ransac")],
    "pcl_region_growing": [str(BUILT / "build/pcl_region_growing")],
    "pcl_ransac": [str(BUILT / "build/pcl_ransac")],
    "open3d_patches": [*OPEN3D, "patches"],
    "open3d_ransac": [*OPEN3D, "ransac"],
    "threecrate": [str(BUILT / "threecrate/release/terrace-threecrate")],
}
TERRACE = str(TARGET / "release/terrace")
# Of CPU time for one run, where settings.json has no other limit.
LIMIT = 60

MEASURES = {"f1_50": "F1@.5", "f1_80": "F1@.8", "weighted_cover": "wcov", "non_planar_claimed": "np"}


@dataclass
class Scene:
    name: str
    group: str
    points: int
    folder: Path

    @property
    def truth(self):
        return self.folder / "truth.npy"


@dataclass
class Result:
    """What a program found in a scene: the file of labels, or why there is none."""
    scene: Scene
    program: str
    setting: str
    labels: Path
    failure: str = ""
    cpu: float = 0.0
    peak: float = 0.0
    clock: float = None
    measures: dict = None


def on_threads(count):
    """The environment. On one thread, as all but --threads, CPU seconds are not those of threads that wait for each other."""
    return os.environ | {name: str(count) for name in ("OMP_NUM_THREADS", "RAYON_NUM_THREADS", "OPENBLAS_NUM_THREADS")}


def export(folder, words, options, threads=1):
    """Every scene as files, with the planes of terrace, by these options of the scoreboard. Earlier files go."""
    shutil.rmtree(folder, ignore_errors=True)
    command = ["cargo", "bench", "--quiet", "--locked", "-p", "terrace-benches", "--bench", "scores", "--"]
    ended = subprocess.run([*command, *options, "--export", str(folder), *words], cwd=REPOSITORY,
                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=on_threads(threads))
    if ended.returncode != 0:
        sys.exit(f"the scoreboard failed:\n{ended.stderr.decode(errors='replace')}")


def scenes(folder, groups):
    """Those of the groups, in the order of these; a folder may hold others."""
    found = []
    for file in folder.glob("*/terrace.json"):
        entry = json.loads(file.read_text())
        if entry["group"] in groups:
            found.append(Scene(entry["name"], entry["group"], entry["points"], file.parent))
    return sorted(found, key=lambda s: (groups.index(s.group), len(s.name), s.name))


def terrace(scene, name, options, threads=1):
    """In a process of its own, so that its peak of memory is its own: of all names with this one in them, it comes first."""
    folder = BUILT / "terrace" / name / scene.name
    export(folder, [scene.name], options, threads)
    folder = folder / scene.name
    costs = json.loads((folder / "terrace.json").read_text())
    peak = costs["peak_mb"] or 0.0
    return Result(scene, name, "default", folder / "terrace.npy", "", costs["cpu_seconds"], peak, costs["clock_seconds"])


def run(scene, program, setting, limit):
    """One run of a program, ended after so many CPU seconds, loading included."""
    stem = scene.folder / f"{program} {setting}".replace(" ", "_")
    labels, costs = stem.with_name(stem.name + ".npy"), stem.with_name(stem.name + ".json")
    result = Result(scene, program, setting, labels)
    ended = subprocess.run(
        [*PROGRAMS[program], str(scene.folder / "points.npy"), str(labels), str(costs), *setting.split()],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=on_threads(1),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1)))
    if ended.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        result.failure = f"over {limit} s"
    elif ended.returncode != 0:
        result.failure = "failed"
        print(f"{program} {setting} on {scene.name}: {ended.stderr.decode(errors='replace')[-500:]}", file=sys.stderr)
    else:
        used = json.loads(costs.read_text())
        result.cpu, result.peak = used["cpu_seconds"], used["peak_mb"]
    return result


def fastest(runs, method, *arguments):
    """Of several runs that of least CPU time: others use the machine too."""
    first = method(*arguments)
    more = [] if first.failure else [method(*arguments) for _ in range(runs - 1)]
    return min([first, *more], key=lambda r: r.cpu)


def evaluate(results):
    """All in one go by `terrace eval`."""
    good = [r for r in results if not r.failure]
    pairs = [str(path) for r in good for path in (r.labels, r.scene.truth)]
    if pairs:
        done = subprocess.run([TERRACE, "eval", "--quiet", "--json", "-", *pairs], check=True, stdout=subprocess.PIPE)
        for result, pair in zip(good, json.loads(done.stdout)["pairs"], strict=True):
            result.measures = pair["measures"]


def mean(results, measure):
    values = [r.measures[measure] for r in results if r.measures[measure] is not None]
    return statistics.fmean(values) if values else None


def row(name, results, ours, clock):
    """A line of the table: of one scene, or the mean of several, beside what terrace took for them."""
    first = results[0]
    cells = [name, first.program, first.setting]
    failed = [r for r in results if r.failure]
    if failed:
        of = f" ({len(failed)} of {len(results)})" if len(results) > 1 else ""
        return [*cells, failed[0].failure + of, *[""] * (len(MEASURES) + 3 + clock)]
    for measure in MEASURES:
        value = mean(results, measure)
        cells.append("" if value is None else f"{value:.3f}")
    cpu = sum(r.cpu for r in results)
    points = sum(r.scene.points for r in results)
    speed = f"{points / cpu / 1e6:.2f}" if cpu > 0 else ""
    cells += [f"{cpu / len(results):.3f}", speed, f"{cpu / ours:.2f}" if ours else ""]
    if clock:
        cells.append(f"{sum(r.clock for r in results) / len(results):.3f}" if first.clock else "")
    return [*cells, f"{max(r.peak for r in results):.0f}"]


def table(results, each, clock=False):
    costs = ["CPU s", "Mpts per CPU s", "CPU s / terrace", *(["clock s"] if clock else []), "peak MB"]
    lines = [["scene", "program", "setting", *MEASURES.values(), *costs]]
    lines.append(["---"] * len(lines[0]))
    ours = {r.scene.name: r.cpu for r in results if r.program == "terrace"}

    def line(name, of):
        return row(name, of, sum(ours.get(r.scene.name, 0.0) for r in of), clock)

    for _, group in itertools.groupby(results, key=lambda r: r.scene.group):
        programs = {}
        for result in group:
            programs.setdefault((result.program, result.setting), []).append(result)
        of_scenes = list(programs.values())
        members = of_scenes[0]
        if each or len(members) == 1:
            for i, member in enumerate(members):
                lines += [line(member.scene.name, [of[i]]) for of in of_scenes]
        if len(members) > 1:
            name = f"{members[0].scene.group}, mean of {len(members)}"
            lines += [line(name, of) for of in of_scenes]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def number(value):
    return f"{value:.4g}"


def candidates(grid, group, program):
    """All settings of the grid of a program, lengths and numbers of points in units of those of the group."""
    units = grid["groups"][group]
    by_group = grid["programs"][program]
    axes = {**by_group["default"], **by_group.get(group, {})}
    lengths, counts = grid["lengths"], grid["counts"]

    def values(name):
        unit = units["length"] if name in lengths else units["points"] if name in counts else 1
        return [number(unit * value) if name not in counts else str(round(unit * value)) for value in axes[name]]

    names = list(axes)
    for chosen in itertools.product(*map(values, names)):
        yield " ".join(f"{name}={value}" for name, value in zip(names, chosen))


def limit_of(group, settings, arguments):
    return arguments.limit or settings["limits"].get(group, LIMIT)


def sweep(found, programs, grid, settings, arguments):
    """The best setting of each program for each group, by the mean F1@.8, then by wcov."""
    for group in dict.fromkeys(s.group for s in found):
        members = [s for s in found if s.group == group]
        for program in programs:
            tried = list(dict.fromkeys(candidates(grid, group, program)))
            with ThreadPoolExecutor(arguments.jobs) as pool:
                limit = limit_of(group, settings, arguments)
                asked = [[pool.submit(run, s, program, setting, limit) for s in members] for setting in tried]
                rows = [[future.result() for future in futures] for futures in asked]
            evaluate([r for results in rows for r in results])
            good = [results for results in rows if not any(r.failure for r in results)]
            good.sort(key=lambda results: (mean(results, "f1_80"), mean(results, "weighted_cover")), reverse=True)
            print(f"\n{group}, {program}: {len(rows)} settings, {len(rows) - len(good)} over the limit or failed\n")
            widest = sorted(good, key=lambda results: mean(results, "weighted_cover"), reverse=True)[:1]
            shown = [*good[:arguments.top], *(results for results in widest if results not in good[:arguments.top])]
            print(table([r for results in shown for r in results], False), flush=True)
            if good and arguments.write:
                settings["groups"].setdefault(group, {})[program] = good[0][0].setting
                SETTINGS.write_text(json.dumps(settings, indent=2) + "\n")
            for results in rows:
                for result in results:
                    result.labels.unlink(missing_ok=True)
                    result.labels.with_suffix(".json").unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser(prog="benches/peers/run", description=__doc__)
    parser.add_argument("groups", nargs="*", metavar="GROUP",
                        help="scene or group of scenes [default: all in settings.json]")
    parser.add_argument("--program", action="append", choices=[*PROGRAMS, "terrace"], help="only this one; may be repeated")
    parser.add_argument("--each", action="store_true", help="each scene of a group as well as their mean")
    parser.add_argument("--runs", type=int, default=1, metavar="N",
                        help="that of least CPU time out of so many [default: 1]")
    parser.add_argument("--limit", type=int, metavar="SECONDS",
                        help=f"of CPU time for one run [default: that of the group in settings.json, or {LIMIT}]")
    parser.add_argument("--threads", type=int, metavar="N",
                        help="also terrace on so many threads, and its time by the clock")
    parser.add_argument("--sweep", action="store_true", help="try the settings of grids.json instead, print the best")
    parser.add_argument("--top", type=int, default=3, metavar="N", help="how many --sweep prints, and that of the greatest wcov [default: 3]")
    parser.add_argument("--write", action="store_true", help="put the best of --sweep into settings.json")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="how many runs of --sweep at once [default: 1]")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write all measures of each scene")
    arguments = parser.parse_args()

    settings = json.loads(SETTINGS.read_text())
    groups = arguments.groups or list(settings["groups"])
    unknown = [group for group in groups if group not in settings["groups"]]
    if unknown:
        parser.error(f"not in settings.json: {', '.join(unknown)}; there are {', '.join(settings['groups'])}")
    programs = []
    for program in [p for p in PROGRAMS if not arguments.program or p in arguments.program]:
        missing = [word for word in PROGRAMS[program][:1] if not Path(word).exists()]
        if missing:
            print(f"{program} is left out: no {missing[0]}, run benches/peers/setup", file=sys.stderr)
        else:
            programs.append(program)

    export(BUILT / "scenes", groups, [])
    found = scenes(BUILT / "scenes", groups)
    for group in groups:
        if not any(s.group == group for s in found):
            print(f"{group} is left out: not in the data folder, set TERRACE_DATA", file=sys.stderr)
    if arguments.sweep:
        sweep(found, programs, json.loads(GRIDS.read_text()), settings, arguments)
        return

    results = []
    for scene in found:
        print(f"{scene.name} ...", file=sys.stderr)
        if not arguments.program or "terrace" in arguments.program:
            for name, options in settings["terrace"].items():
                results.append(fastest(arguments.runs, terrace, scene, name, options))
            if arguments.threads:
                name = f"terrace, {arguments.threads} threads"
                results.append(fastest(arguments.runs, terrace, scene, name, [], arguments.threads))
        chosen = settings["groups"][scene.group]
        for program in programs:
            if program not in chosen:
                print(f"{program} is left out: no setting for {scene.group} in settings.json, see --sweep", file=sys.stderr)
            else:
                limit = limit_of(scene.group, settings, arguments)
                results.append(fastest(arguments.runs, run, scene, program, chosen[program], limit))
    evaluate(results)
    print(table(results, arguments.each, bool(arguments.threads)))
    if arguments.json:
        lines = [{"scene": r.scene.name, "group": r.scene.group, "program": r.program, "setting": r.setting,
                  "failure": r.failure or None, "cpu_seconds": r.cpu, "clock_seconds": r.clock, "peak_mb": r.peak,
                  "measures": r.measures}
                 for r in results]
        arguments.json.write_text(json.dumps(lines, indent=1) + "\n")


if __name__ == "__main__":
    main()
