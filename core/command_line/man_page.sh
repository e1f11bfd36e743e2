#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes the manual page of the program from what its own --help says.
#
#   core/command_line/man_page.sh PROGRAM > lucerna.1
set -euo pipefail
program=$1
unset LUCERNA_PLUGINS

# as_man: --help of the program or of a command, from stdin, in the language of man pages.
as_man() {
    awk '
        { gsub(/\\/, "\\e"); gsub(/-/, "\\-"); sub(/^[.\x27]/, "\\\\\\&&") }
        /^[Uu]sage: /       { sub(/^[^ ]* /, ""); print ".PP\n.B " $0; next }
        /^(P|O)[a-z]+:$/    { next }
        /^[a-z]+:$/         { sub(/:/, ""); print ".SH " toupper($0); next }
        /^  [^ ]/           { sub(/^  /, ""); name = $0; sub(/( REQUIRED)?(  .*)?$/, "", name)
                              print ".TP\n.B " name; if (sub(/^.*  /, "")) print; next }
        /^$/                { print ".PP"; next }
                            { sub(/^ +/, ""); print }'
}

version=$("$program" --version | head -n 1)
help=$("$program" --help)
summary=$(sed -n 3p <<< "$help")
printf '.TH LUCERNA 1 "" "%s"\n.SH NAME\nlucerna \\- %s\n.SH SYNOPSIS\n' "$version" "${summary%.}"
sed 3d <<< "$help" | as_man
for command in $(sed -n '/^commands:/,/^$/s/^  \([^ ]*\).*/\1/p' <<< "$help"); do
    printf '.SH LUCERNA %s\n' "${command^^}"
    "$program" "$command" --help | as_man
done
