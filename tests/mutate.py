#!/usr/bin/env python3
"""Tests the tests: changes one operator, bound or constant of format/ or codec/ at a time and checks whether the fast
tests fail. tests/mutate.py BUILD COUNT [--seed N] [--only PREFIX...] [--tests format_tests]

BUILD is a build folder of this tree with tests. With these options a mutant needs one small compilation:
  cmake -S . -B build-mutate -G Ninja -DCMAKE_PROJECT_INCLUDE=$PWD/tests/mutate.cmake
The seed decides which mutants are drawn. Each one is built incrementally, tested and reverted. Fast tests take at most
--fast seconds without any change. BUILD/TARGET.times has their times and is written if it is missing, which takes four
minutes. A mutant that does not compile is not counted. One whose tests take three times the usual CPU time is caught.
Results are kept in BUILD/mutants.txt, so the script may be stopped and started again. A mutant listed there is tested
again only if it survived and --again is given. Prints each mutant and a last line with the totals. Nothing else may
change the tree during a run. ccache saves compiling the reverted sources again."""
import argparse
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGETS = ["format_tests", "codec_tests"]
BUILD_SECONDS = 1800
QUICK_SECONDS = 0.05

SWAPS = [(r"(?<![<>=!+\-*/&|])<(?![<=])", "<="), (r"<=", "<"), (r"(?<![<>\-=])>(?![>=])", ">="), (r">=", ">"),
         (r"==", "!="), (r"!=", "=="), (r"&&", "||"), (r"\|\|", "&&"), (r" \+ ", " - "), (r" - ", " + "),
         (r" \* ", " + "), (r" << ", " >> "), (r" >> ", " << "), (r"\bmin\(", "max("), (r"\bmax\(", "min(")]
NUMBER = r"(?<![\w.\"'])(\d+)(?![\w.\"'])"


def code_of(line):
    """The line with comments and strings replaced by spaces."""
    line = re.sub(r'"(\\.|[^"\\])*"', lambda m: " " * len(m.group()), line)
    return re.sub(r"//.*", lambda m: " " * len(m.group()), line)


def places():
    """All possible changes, in order: (file, line, begin, end, new text)."""
    found = []
    for folder in ("format", "codec"):
        for path in sorted((ROOT / folder).rglob("*.cpp")):
            for number, line in enumerate(path.read_text().split("\n")):
                code = code_of(line)
                if code.lstrip().startswith(("#", "template", "*")) or "static_assert" in code:
                    continue
                generic = re.search(r"\w<[^<>]*>", code)  # a template's brackets are not comparisons
                for pattern, new in SWAPS:
                    if generic and pattern[-1] != " " and ("<" in pattern or ">" in pattern):
                        continue
                    found += [(path, number, m.start(), m.end(), new) for m in re.finditer(pattern, code)]
                found += [(path, number, m.start(), m.end(), str(int(m.group()) + 1))
                          for m in re.finditer(NUMBER, code)]
    return found


def run(command, seconds, cpu_seconds=resource.RLIM_INFINITY):
    """Whether the command succeeded in time."""
    try:
        return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=seconds, cwd=ROOT,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (cpu_seconds,) * 2)
                              ).returncode == 0
    except subprocess.TimeoutExpired:
        return False


def build(folder, target):
    return run(["ninja", "-j2", "-C", folder, target], BUILD_SECONDS)


def times_of(folder, target):
    """The seconds that each test takes without any change, by "Suite.Name"."""
    kept = pathlib.Path(folder) / f"{target}.times"
    if not kept.exists():
        made = subprocess.run([f"{folder}/bin/{target}"], stdout=subprocess.PIPE, text=True, cwd=ROOT)
        if made.returncode:
            sys.exit(f"{target} fails without any change")
        kept.write_text(made.stdout)
    return {name: int(ms) / 1000 for name, ms in re.findall(r"^\[ +OK \] (\S+) \((\d+) ms\)", kept.read_text(), re.M)}


def suites_for(path, target):
    """The suites of the test file with the same name and of the test files that include the header."""
    header = f'#include "{path.with_suffix(".h").relative_to(ROOT)}"'
    found = set()
    for test in (ROOT / "tests" / target.removesuffix("_tests")).glob("*_test.cpp"):
        text = test.read_text()
        if test.name == path.stem + "_test.cpp" or header in text:
            found |= set(re.findall(r"^TEST(?:_F)?\((\w+),", text, re.M))
    return found


def groups(path, target, times):
    """Groups of tests (name, tests): those of the file, then the quick ones of the others, then the rest."""
    own = suites_for(path, target)
    of_file = [t for t in times if t.split(".")[0] in own]
    others = [t for t in times if t not in of_file]
    return [("its own", of_file), ("quick ones", [t for t in others if times[t] < QUICK_SECONDS]),
            ("others", [t for t in others if times[t] >= QUICK_SECONDS])]


def try_mutant(folder, times, path):
    """"void" if the mutant does not compile, "SURVIVED", or "caught by" and a name. Runs the quickest tests first and
    links only the programs that it needs."""
    is_of_codec = path.relative_to(ROOT).parts[0] == "codec"
    for target in times:
        if is_of_codec and target == "format_tests":  # it does not link codec/
            continue
        if not build(folder, target):
            return "void"
        for name, tests in groups(path, target, times[target]):
            seconds = 3 * sum(times[target][t] for t in tests) + 5
            if tests and not run([f"{folder}/bin/{target}", "--gtest_filter=" + ":".join(tests), "--gtest_fail_fast"],
                                 10 * seconds, int(seconds)):
                return f"caught by {target}, {name}"
    if path.parent.name == "c_api":  # a program in C tests these files
        if not build(folder, "c_api_test") or not run([f"{folder}/bin/c_api_test", f"{folder}/c_api.tess"], 60):
            return "caught by c_api_test"
    return "SURVIVED"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="+", default=[""], help="prefixes of the files to change")
    parser.add_argument("--tests", choices=TARGETS, nargs="+", default=TARGETS)
    parser.add_argument("--fast", type=float, default=1, help="the longest time of a fast test in seconds")
    parser.add_argument("--again", action="store_true", help="test surviving mutants again")
    a = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))  # reverts the mutant first
    folder = str(pathlib.Path(a.build).resolve())
    times = {}
    for target in a.tests:
        if not build(folder, target):
            sys.exit(f"{target} does not build without any change")
        times[target] = {t: s for t, s in times_of(folder, target).items() if s <= a.fast}
    journal = pathlib.Path(folder) / "mutants.txt"
    known = {}
    if journal.exists():
        known = dict(reversed(line.split("\t", 1)) for line in journal.read_text().splitlines())
    drawn = [p for p in places() if str(p[0].relative_to(ROOT)).startswith(tuple(a.only))]
    random.Random(a.seed).shuffle(drawn)
    caught = survived = void = 0
    for path, number, begin, end, new in drawn:
        if caught + survived == a.count:
            break
        before = path.read_text()
        lines = before.split("\n")
        old = lines[number]
        lines[number] = old[:begin] + new + old[end:]
        where = f"{path.relative_to(ROOT)}:{number + 1}: {old.strip()}  ->  {lines[number].strip()}"
        result = known.get(where)
        if result is None or a.again and result == "SURVIVED":
            try:
                path.write_text("\n".join(lines))
                result = try_mutant(folder, times, path)
            finally:
                path.write_text(before)
            with journal.open("a") as f:
                f.write(f"{result}\t{where}\n")
            print(result, where, flush=True)
        void, survived = void + (result == "void"), survived + (result == "SURVIVED")
        caught += result.startswith("caught")
    print(f"{caught} of {caught + survived} mutants caught, {void} did not compile, seed {a.seed}")


main()
