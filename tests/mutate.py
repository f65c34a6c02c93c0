#!/usr/bin/env python3
"""Tests of the tests: changes one operator, bound or constant of format/ or codec/ at a time and sees whether
the fast tests notice. tests/mutate.py BUILD COUNT [--seed N] [--only PREFIX] [--tests format_tests]

BUILD is a build folder of this tree with tests. Mutants are drawn by seed; each is built incrementally, tried
by the tests below, and taken back. A mutant that does not compile counts as none, one whose tests run out of
time is caught. Prints each survivor and a last line with the sums; nothing else may change the tree meanwhile."""
import argparse
import pathlib
import random
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Suites that take less than a second or so, and meet decoding and coding as a whole.
FILTERS = {"format_tests": "-Sampler*:Octahedral*:Mesh*:SurfaceMesh*",
           "codec_tests": "-Journal*:RateControl*:Mask*:Prediction*:Kernels*:CoarseLevels*:TableTrial*"}
SECONDS = {"build": 900, "test": 300}

SWAPS = [(r"(?<![<>=!+\-*/&|])<(?![<=])", "<="), (r"<=", "<"), (r"(?<![<>\-=])>(?![>=])", ">="), (r">=", ">"),
         (r"==", "!="), (r"!=", "=="), (r"&&", "||"), (r"\|\|", "&&"), (r" \+ ", " - "), (r" - ", " + "),
         (r" \* ", " + "), (r" << ", " >> "), (r" >> ", " << "), (r"\bmin\(", "max("), (r"\bmax\(", "min(")]
NUMBER = r"(?<![\w.\"'])(\d+)(?![\w.\"'])"


def code_of(line):
    """The line without comment and strings, of the same length."""
    line = re.sub(r'"(\\.|[^"\\])*"', lambda m: " " * len(m.group()), line)
    return re.sub(r"//.*", lambda m: " " * len(m.group()), line)


def places():
    """All (file, line, begin, end, new text) in order."""
    found = []
    for folder in ("format", "codec"):
        for path in sorted((ROOT / folder).rglob("*.cpp")):
            if path.name == "default_parameters.cpp":  # a table, which golden files freeze
                continue
            for number, line in enumerate(path.read_text().split("\n")):
                code = code_of(line)
                if code.lstrip().startswith(("#", "template", "*")) or "static_assert" in code:
                    continue
                generic = re.search(r"\w<[^<>]*>", code)  # a template's brackets are no comparison
                for pattern, new in SWAPS:
                    if generic and pattern[-1] != " " and ("<" in pattern or ">" in pattern):
                        continue
                    found += [(path, number, m.start(), m.end(), new) for m in re.finditer(pattern, code)]
                found += [(path, number, m.start(), m.end(), str(int(m.group()) + 1))
                          for m in re.finditer(NUMBER, code)]
    return found


def run(command, seconds):
    """0: well; else what it ended with; None: out of time."""
    try:
        return subprocess.run(["nice", *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              timeout=seconds, cwd=ROOT).returncode
    except subprocess.TimeoutExpired:
        return None


def build(folder, targets):
    return run(["ninja", "-C", folder, *targets], SECONDS["build"]) == 0


def catches(folder, targets):
    for target in targets:
        if run([f"{folder}/bin/{target}", f"--gtest_filter={FILTERS[target]}", "--gtest_fail_fast"],
               SECONDS["test"]) != 0:
            return target
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build")
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="files that begin with this, such as format/container")
    parser.add_argument("--tests", choices=list(FILTERS), nargs="+", default=list(FILTERS))
    a = parser.parse_args()
    folder = str(pathlib.Path(a.build).resolve())
    if not build(folder, a.tests) or catches(folder, a.tests):
        sys.exit("the tests fail without any change")
    drawn = [p for p in places() if str(p[0].relative_to(ROOT)).startswith(a.only)]
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
        try:
            path.write_text("\n".join(lines))
            if not build(folder, a.tests):
                void += 1
                continue
            by = catches(folder, a.tests)
            caught, survived = caught + bool(by), survived + (not by)
            print("caught by " + by if by else "SURVIVED", where, flush=True)
        finally:
            path.write_text(before)
    build(folder, a.tests)
    print(f"{caught} of {caught + survived} mutants caught, {void} did not compile, seed {a.seed}")


main()
