# SPDX-License-Identifier: Apache-2.0
# Completion for bash: commands, options and plugins, as the program itself lists them.

_lucerna() {
    local program=$1 word=${COMP_WORDS[COMP_CWORD]} first=1 words=
    # Folders of plugins come before the command.
    while [[ ${COMP_WORDS[first]-} == --plugins ]]; do ((first += 2)); done
    COMPREPLY=()
    if ((COMP_CWORD < first)); then
        return # the name of a folder
    elif ((COMP_CWORD == first)); then
        words=$("$program" --help 2> /dev/null |
            sed -nE '/^(commands|options):/,/^$/s/^  ([a-z-]+).*/\1/p')
    elif [[ ${COMP_WORDS[COMP_CWORD - 1]} == --preview ]]; then
        words=$("$program" plugins preview 2> /dev/null | sed -nE 's/^  ([^ ]+).*/\1/p')
    elif [[ $word == -* ]]; then
        words=$("$program" "${COMP_WORDS[first]}" --help 2> /dev/null |
            sed -nE 's/^  (-[^ ]+).*/\1/p' | tr ',' ' ')
    elif [[ ${COMP_WORDS[first]} == @(plugins|check) ]]; then
        words=$("$program" plugins 2> /dev/null |
            awk '/^[a-z]/ { kind = $1 } /^  / { print kind "/" $1 }')
    fi
    COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _lucerna lucerna
