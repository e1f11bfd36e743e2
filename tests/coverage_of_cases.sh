#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Counts which of the hard cases in cases.txt have a test, by the names of the tests.
#
#   tests/coverage_of_cases.sh            a table: cases, covered, ids of those that are not
#   tests/coverage_of_cases.sh --missing  every case without a test, with its title
set -euo pipefail
cd -- "$(dirname -- "$0")"

# Ids lead the name of a test: `TEST(Suite, B1_B3_plane)`. Leading zeros are dropped.
# A wrong scene with its message is a test, too: errors/xml/K12_include_cycle.xml.
{
    grep -rhozE --include='*_test.cpp' 'TEST(_[FP])?\(\s*\w+,\s*([A-P][0-9]+_)+' . | tr '\0' '\n' |
        grep -oE '([A-P][0-9]+_)+$' || true
    find errors -name '*.xml' -printf '%f\n' | grep -oE '^([A-P][0-9]+_)+' || true
} | tr '_' '\n' | sed -nE 's/^([A-P])0*([0-9]+)$/\1\2/p' | sort -u |
    awk -v missing="${1-}" '
        FNR == NR { covered[$1] = 1; next }
        $2 == "=" { section[++sections] = $1; $1 = $2 = ""; title[sections] = substr($0, 3); next }
        /^[A-P][0-9]/ {
            if (index($0, " | ")) { ++absent; next }
            ++cases[sections]
            if ($1 in covered) { ++done[sections]; next }
            gaps[sections] = gaps[sections] " " $1
            if (missing == "--missing") print
        }
        END {
            if (missing == "--missing") exit
            for (i = 1; i <= sections; ++i) {
                printf "%s %-30s %3d of %3d%s\n", section[i], title[i], done[i], cases[i],
                       gaps[i] ? "  without:" gaps[i] : ""
                all += cases[i]; with += done[i]
            }
            printf "  %-30s %3d of %3d; %d cannot occur\n", "all", with, all, absent
        }' - cases.txt
