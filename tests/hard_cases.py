#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes docs/hard_cases.md of the catalogue and of the names of the tests.

    tests/hard_cases.py                 writes the page
    tests/hard_cases.py --check         exit code 1 if the page is not current
    tests/hard_cases.py --times BUILD   takes what each test took from the last run of ctest there

Ids lead the name of a test: TEST(Suite, B1_B3_plane). A wrong scene with its message is a test,
too: errors/xml/K12_include_cycle.xml. Times are kept in case_times.txt, so that the page does not
change from run to run.
"""
import argparse
import collections
import math
import os
import re
import sys

TESTS = os.path.dirname(os.path.abspath(__file__))
PAGE = os.path.join(os.path.dirname(TESTS), "docs", "hard_cases.md")
TIMES = os.path.join(TESTS, "case_times.txt")
MACRO = re.compile(r"TEST(?:_[FP])?\(\s*(\w+),\s*((?:[A-Z]\d+_)+)(\w+)\)")
Test = collections.namedtuple("Test", "words path full_name")

HEAD = """# Hard cases

What breaks renderers, and which tests of this one look at it. Other renderers may use the list. It
is made by `tests/hard_cases.py` from `tests/cases.txt` and the names of the tests; `.ci/style`
checks that it is current.

Times are seconds on one core of a small machine, over all variants of a test; a dash is less
than 0.05 s. Wrong scenes take no time: the program tells what is wrong, and the test compares the
words.
"""


def words_of(name):
    """"NoLightIsLeftOut" and "no_light_is_left_out" as words."""
    name = re.sub(r"(?<=[a-z])(?=[A-Z0-9])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name)
    return " ".join(w if w.isupper() and len(w) > 1 else w.lower()
                    for w in name.split("_") if w)


def tests_by_case():
    found = collections.defaultdict(list)

    def add(ids, test):
        for case in re.findall(r"[A-Z]\d+", ids):
            found[case[0] + str(int(case[1:]))].append(test)

    for folder, _, files in sorted(os.walk(TESTS)):
        for name in sorted(files):
            path = os.path.relpath(os.path.join(folder, name), TESTS)
            if name.endswith("_test.cpp"):
                with open(os.path.join(TESTS, path), encoding="utf-8") as file:
                    for suite, ids, rest in MACRO.findall(file.read()):
                        words = f"{words_of(suite)}: {words_of(rest)}"
                        add(ids, Test(words, path, f"{suite}.{ids}{rest}"))
            scene = re.match(r"((?:[A-Z]\d+_)+)(\w+)\.xml$", name)
            if scene and path.startswith("errors"):
                add(scene[1], Test(words_of(scene[2]), path, ""))
    return found


def catalogue():
    """Sections: (title, [(id, title, why it cannot occur or "")])."""
    sections = []
    with open(os.path.join(TESTS, "cases.txt"), encoding="utf-8") as file:
        for line in file:
            if match := re.match(r"[A-Z] = (.*)", line):
                sections.append((match[1], []))
            elif match := re.match(r"([A-Z]\d+) ([^|]*?)(?: \| (.*))?$", line.rstrip()):
                sections[-1][1].append((match[1], match[2], match[3] or ""))
    return sections


def kept_times():
    times = {}
    if os.path.exists(TIMES):
        with open(TIMES, encoding="utf-8") as file:
            for line in file:
                name, seconds = line.split()
                times[name] = float(seconds)
    return times


def take_times(build, tests):
    """Sums of ctest's costs over the variants of each test, to two digits."""
    costs = collections.Counter()
    with open(os.path.join(build, "Testing/Temporary/CTestCostData.txt"), encoding="utf-8") as file:
        for line in file:
            fields = line.split()
            if len(fields) == 3:
                parts = [part for part in fields[0].split("/") if "." in part]
                costs[parts[0] if parts else fields[0]] += float(fields[2])
    times = kept_times()
    for test in tests:
        if costs[test.full_name] > 0:
            seconds = costs[test.full_name]
            digits = 1 - math.floor(math.log10(seconds))
            times[test.full_name] = round(seconds, digits)
    names = {test.full_name for test in tests}
    with open(TIMES, "w", encoding="utf-8") as file:
        for name in sorted(names & set(times)):
            file.write(f"{name} {times[name]:g}\n")


def page(found):
    times = kept_times()
    sections = catalogue()
    cases = [case for _, listed in sections for case in listed]
    absent = sum(1 for _, _, why in cases if why)
    tested = sum(1 for case, _, why in cases if found[case] and not why)
    rest = "" if tested + absent == len(cases) else ", and the others have none yet"
    text = HEAD + (f"\nOf {len(cases)} cases {tested} have a test, "
                   f"{absent} cannot occur here{rest}.\n")
    for title, listed in sections:
        text += f"\n## {title}\n\n| case | what is checked | s |\n| --- | --- | --- |\n"
        for case, name, why in listed:
            checked = "cannot occur: " + why if why else "<br>".join(
                f"[{test.words}](../tests/{test.path})" for test in found[case]) or "nothing yet"
            seconds = sum(times.get(test.full_name, 0) for test in found[case])
            shown = f"{seconds:.2g}" if seconds >= 0.05 else "–"
            text += f"| **{case}** {name} | {checked} | {shown} |\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--times", metavar="BUILD")
    options = parser.parse_args()
    found = tests_by_case()
    if options.times:
        take_times(options.times, {t for tests in found.values() for t in tests if t.full_name})
    text = page(found)
    if options.check:
        with open(PAGE, encoding="utf-8") as file:
            if file.read() != text:
                print("docs/hard_cases.md: not current, run tests/hard_cases.py")
                return 1
        return 0
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
