#!/usr/bin/env python3
"""Fails if a source uses a name that no header that it includes declares.   check_includes.py ROOT

Such a source may compile in a unity build (CMAKE_UNITY_BUILD), which the tests use, but not on its own, as users
build it. Checked are the project's types and the names of the standard library below. Only the header given there is
certain to declare such a name.
"""
import os
import re
import sys

STANDARD = {
    "cmath": "isfinite isnan sqrt cbrt pow exp exp2 log log2 log10 floor ceil lround llround round hypot sin cos "
             "tan atan2 acos asin fmod",
    "cstring": "memcpy memcmp memset memmove strlen strcmp strerror",
    "cstdio": "FILE fopen fclose fwrite fread printf fprintf snprintf fputs puts fflush remove",
    "cstdlib": "getenv strtol strtod malloc free abort exit",
    "algorithm": "sort stable_sort nth_element fill fill_n copy_n count_if find_if any_of all_of none_of "
                 "transform lower_bound upper_bound max_element min_element reverse rotate unique clamp "
                 "ranges::sort ranges::fill ranges::copy",
    "numeric": "accumulate iota inner_product partial_sum gcd lcm",
    "thread": "thread jthread this_thread::sleep_for",
    "mutex": "mutex lock_guard unique_lock scoped_lock once_flag call_once",
    "condition_variable": "condition_variable",
    "atomic": "atomic memory_order_relaxed",
    "map": "map", "set": "set", "unordered_map": "unordered_map", "unordered_set": "unordered_set",
    "deque": "deque", "functional": "function", "filesystem": "filesystem::path", "chrono": "chrono",
    "fstream": "ifstream ofstream", "sstream": "ostringstream istringstream stringstream",
    "random": "mt19937 mt19937_64 uniform_int_distribution", "bit": "bit_width bit_cast countr_zero popcount",
}
HEADER_OF = {f"std::{name}": header for header, names in STANDARD.items() for name in names.split()}
DECLARED = re.compile(r"\b(?:class|struct|enum|union|using|typename)\s+(?:\[\[\w+\]\]\s*)?([A-Z]\w+)")
INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)', re.M)
PROSE = re.compile(r'\bTEST(?:_F|_P)?\(\w+|//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"', re.S)


def read_sources(root):
    sources = {}
    for folder in ("format", "codec", "decoder_glsl", "corpus", "tools", "tests"):
        for at, _, names in os.walk(os.path.join(root, folder)):
            for name in names:
                if name.endswith((".h", ".cpp", ".inl")):
                    path = os.path.join(at, name)
                    with open(path, encoding="utf-8") as file:
                        sources[os.path.relpath(path, root)] = file.read()
    return sources


def reached(path, includes, known):
    """The project's and the standard headers that a file includes, directly or through headers of the project."""
    if path not in known:
        known[path] = set()
        for ours, theirs in includes.get(path, []):
            known[path].add(ours or theirs)
            known[path] |= reached(ours, includes, known)
    return known[path]


def main():
    sources = read_sources(sys.argv[1])
    includes = {path: INCLUDE.findall(text) for path, text in sources.items()}
    code = {path: PROSE.sub(" ", text) for path, text in sources.items()}
    declared = {path: set(DECLARED.findall(text)) for path, text in code.items()}
    homes = {}
    for path in sorted(declared):
        for name in declared[path] if path.endswith(".h") else ():
            homes.setdefault(name, path)
    known, failures = {}, []
    for path, text in sorted(code.items()):
        # .inl files are parts of other sources, consumers include installed headers, and fixtures have errors on purpose.
        if path.endswith(".inl") or path.startswith(("tests/consumers/", "tests/fixtures/")):
            continue
        seen = reached(path, includes, known) | {path}
        names = set().union(*(declared.get(header, ()) for header in seen))
        for name in sorted(set(re.findall(r"(?<![\w.>:])[A-Z]\w+", text)) - names):
            if name in homes and (path.startswith("tests/") or not homes[name].startswith("tests/")):
                failures.append(f"{path}: {name} is declared in {homes[name]}, which it does not include")
        for name in sorted(set(re.findall(r"std::(?:\w+::)?\w+", text))):
            header = HEADER_OF.get(name)
            if header and header not in seen:
                failures.append(f"{path}: {name} is of <{header}>, which it does not include")
    for failure in failures:
        print(failure)
    return len(failures) > 0


sys.exit(main())
