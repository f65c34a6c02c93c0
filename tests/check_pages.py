#!/usr/bin/env python3
"""Fails if a page or a comment cites something that does not exist, or if a page has long lines.

    check_pages.py ROOT

In Markdown pages:
  - the targets of links exist, and so do their #anchors;
  - paths in backticks exist, relative to ROOT, to the page's folder or to a folder of ROOT. Text counts as a path if
    its first folder exists, so the files of examples do not;
  - no line has more than 400 characters, and prose is wrapped at 110 columns. Tables, code blocks and the targets of
    links may be wider.
In pages and in the comments of sources:
  - the specification has the cited sections: "FORMAT.md 3.4", "FORMAT.md, 4.6", "FORMAT.md 1.1 to 1.3", "FORMAT.md
    part 4"; in the pages of format/ also "§3.4" and "part 4", in the second decoder (tests/reference/) also "3.4";
  - named pages, such as codec/DECISIONS.md, and named sources, such as format/tile/rans.h, exist.
"""
import glob
import os
import re
import sys

MOST_LINE, MOST_PROSE = 400, 110
FOLDERS = ("format", "codec", "decoder_glsl", "corpus", "tools", "python", "tests")
SLASH_COMMENTS = (".h", ".cpp", ".c", ".inl", ".inc", ".glsl", ".comp", ".frag", ".vert", ".js", ".mjs", ".ts")
HASH_COMMENTS = (".py", ".sh", ".cmake", "CMakeLists.txt")
SPECIFICATION = "format/FORMAT.md"
PLACEHOLDER = re.compile(r"(?<![A-Za-z])[A-Z]{2,}(?![A-Za-z])")  # such as command_NAME.cpp
USAGE_FILES = ("FILE.md", "OUT/tables.md", "demo_output/full_size/tables.md", "demo_output/paper_comparison/tables.md")

NUMBER = r"(?:\d+\.\d+|parts?\s+\d+|\d+)"
CITATION = re.compile(rf"FORMAT\.md[)\]]?(?:\([^)]*\))?,?\s+({NUMBER}(?:(?:,|\s+(?:and|to))\s+{NUMBER})*)")
NAMED_PAGE = re.compile(r"[\w./-]*\b\w+\.md\b")
NAMED_SOURCE = re.compile(rf"(?<![\w/.-])(?:{'|'.join(FOLDERS)})/[\w./*-]*\.(?:h|cpp|inl|inc|glsl|py|sh|cmake|csv|txt)\b")
LINK = re.compile(r"\]\(([^()\s]+)\)")
SLASH_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|(//[^\n]*|/\*.*?\*/)', re.S)
HASH_COMMENT = re.compile(r"#[^\n]*")


def files_below(root):
    """The project's files, relative to root. Fixtures are wrong on purpose and are left out."""
    found = [name for name in os.listdir(root) if os.path.isfile(os.path.join(root, name))]
    for folder in FOLDERS:
        for at, folders, names in os.walk(os.path.join(root, folder)):
            here = os.path.relpath(at, root)
            folders[:] = [f for f in folders if f != "__pycache__" and (here, f) != ("tests", "fixtures")]
            found += [os.path.normpath(os.path.join(here, name)) for name in names]
    return sorted(found)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def blank(text):
    """White space with the line breaks of the text, so that line numbers stay."""
    return "\n" * text.count("\n")


def comments_of(path, text):
    """The comments of a source, without their marks."""
    pattern = SLASH_COMMENT if path.endswith(SLASH_COMMENTS) else HASH_COMMENT
    kept, end = "", 0
    for match in pattern.finditer(text):
        kept += blank(text[end:match.start()])
        is_string = pattern is SLASH_COMMENT and match.group(1) is None
        kept += blank(match.group()) if is_string else re.sub(r"(^|\n)\s*(//+|#+|/?\*+)", r"\1 ", match.group())
        end = match.end()
    return kept


def without_code_blocks(page):
    lines, fenced, before = [], False, ""
    for line in page.split("\n"):
        fence = line.lstrip().startswith("```")
        in_block = fenced or fence or (line.startswith("    ") and not before.strip())
        fenced ^= fence
        lines.append("" if in_block else line)
        before = "" if in_block else line
    return "\n".join(lines)


def anchors_of(page):
    headings = re.findall(r"^#+\s+(.*)", without_code_blocks(page), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def sections_of(specification):
    parts = {f"part {n}" for n in re.findall(r"^# Part (\d+)\.", specification, re.M)}
    return parts | set(re.findall(r"^## (\d+\.\d+) ", specification, re.M))


class Checker:
    def __init__(self, root):
        self.root, self.files, self.failures = root, files_below(root), []
        self.names = {os.path.basename(path) for path in self.files}
        self.sections = sections_of(read(os.path.join(root, SPECIFICATION)))

    def fail(self, path, text, at, what):
        failure = f"{path}:{text.count(chr(10), 0, at) + 1}: {what}"
        if failure not in self.failures:
            self.failures.append(failure)

    def exists(self, path, page=""):
        """Whether a path, perhaps with *, exists below the root, the page's folder or a folder of the root."""
        bases = ["", os.path.dirname(page)] + list(FOLDERS)
        return any(glob.glob(os.path.join(self.root, base, path)) for base in bases)

    def check_link(self, page, text, match):
        target, _, anchor = match.group(1).partition("#")
        if re.match(r"\w+:", target):
            return
        path = os.path.join(self.root, os.path.dirname(page), target) if target else os.path.join(self.root, page)
        if not os.path.exists(path):
            self.fail(page, text, match.start(), f"no {target}")
        elif anchor and anchor not in anchors_of(read(path)):
            self.fail(page, text, match.start(), f"{target or 'the page'} has no heading #{anchor}")

    def check_code_span(self, page, text, match):
        for word in match.group(1).split():
            first = word.split("/")[0]
            is_path = "/" in word and re.fullmatch(r"[\w.*/+-]+", word) and first not in ("", "..", ".")
            if is_path and not first.startswith("build") and self.exists(first, page) and \
                    not self.exists(word.rstrip("/"), page) and not PLACEHOLDER.search(word):
                self.fail(page, text, match.start(), f"no {word}")

    def check_lines(self, page, text):
        for number, (line, prose) in enumerate(zip(text.split("\n"), without_code_blocks(text).split("\n")), 1):
            if len(line) > MOST_LINE:
                self.failures.append(f"{page}:{number}: {len(line)} characters, at most {MOST_LINE}")
            shown = re.sub(r"\]\([^()]*\)|https?://\S+", "", prose)
            if not shown.startswith("|") and len(shown) > MOST_PROSE:
                self.failures.append(f"{page}:{number}: {len(shown)} columns, prose has at most {MOST_PROSE}")

    def check_page(self, page, text):
        prose = without_code_blocks(text)
        for match in LINK.finditer(prose):
            self.check_link(page, prose, match)
        for match in re.finditer(r"`([^`]+)`", prose):
            self.check_code_span(page, prose, match)
        self.check_lines(page, text)

    def check_section(self, path, text, at, number):
        section = re.sub(r"parts?\s+", "part ", number)
        if "." not in section and not section.startswith("part"):
            section = f"part {section}"
        if section not in self.sections:
            self.fail(path, text, at, f"FORMAT.md has no {section}")

    def check_citations(self, path, text):
        for match in CITATION.finditer(text):
            for number in re.findall(NUMBER, match.group(1)):
                self.check_section(path, text, match.start(), number)
        bare = None
        if path.startswith("format/") and path.endswith(".md"):
            bare = r"§(\d+(?:\.\d+)?)|\b([Pp]arts? \d+)\b"
        elif path.startswith("tests/reference/"):
            bare = r"(?<![\w.^-])(\d\.\d)(?![\w^])|\b(part \d+)\b"
        for match in re.finditer(bare, text) if bare else ():
            self.check_section(path, text, match.start(), (match.group(1) or match.group(2)).lower())
        for match in NAMED_PAGE.finditer(text):
            folder, name = os.path.split(match.group())
            is_known = name in self.names if not folder else self.exists(match.group(), path)
            if not is_known and match.group() not in USAGE_FILES:
                self.fail(path, text, match.start(), f"no {match.group()}")
        for match in NAMED_SOURCE.finditer(text):
            if not self.exists(match.group()) and not PLACEHOLDER.search(match.group()):
                self.fail(path, text, match.start(), f"no {match.group()}")

    def run(self):
        for path in self.files:
            if path.endswith(".md"):
                text = read(os.path.join(self.root, path))
                self.check_page(path, text)
                self.check_citations(path, text)
            elif path.endswith(SLASH_COMMENTS + HASH_COMMENTS):
                self.check_citations(path, comments_of(path, read(os.path.join(self.root, path))))
        return self.failures


failures = Checker(sys.argv[1]).run()
for failure in failures:
    print(failure)
sys.exit(len(failures) > 0)
