#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs a build to a scratch folder, builds the plugins of the documentation against nothing but
# that installation, with other flags than the program, and renders the scenes of the documentation
# with them.
#
#   tests/installation.sh BUILD-FOLDER
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(readlink -f -- "$0")")")
build=$(readlink -f -- "$1")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
unset LUCERNA_PLUGINS
fail() {
    echo "$0: $*" >&2
    exit 1
}

# Staged first, then moved: nothing in an installation may know where it lies.
prefix=$scratch/opt/lucerna
DESTDIR=$scratch/stage cmake --install "$build" --prefix /usr > /dev/null
mkdir -p "$scratch/opt"
mv "$scratch/stage/usr" "$prefix"
[[ -z $(find "$scratch/stage" -type f) ]] || fail "files were installed outside of the prefix"
lucerna=$prefix/bin/lucerna
"$lucerna" --version

# completions WORD…: what the shell offers for the last word.
completions() {
    (
        set +eu
        source "$prefix/share/bash-completion/completions/lucerna"
        COMP_WORDS=(lucerna "$@")
        COMP_CWORD=$#
        _lucerna "$lucerna"
        echo "${COMPREPLY[*]}"
    )
}
[[ $(completions ren) == render ]] || fail "the shell does not complete commands"
[[ $(completions render --thr) == --threads ]] || fail "the shell does not complete options"
[[ $(completions render --preview t) == tev ]] || fail "the shell does not complete previews"
[[ $(completions plugins bsdf/thind) == bsdf/thindielectric ]] ||
    fail "the shell does not complete plugins"

# The manual page has what --help has: all commands, and their options.
page=$(sed 's/\\-/-/g' "$prefix/share/man/man1/lucerna.1")
for command in $("$lucerna" --help | sed -n '/^commands:/,/^$/s/^  \([^ ]*\).*/\1/p'); do
    [[ $page == *$'\n.SH LUCERNA '"${command^^}"$'\n'* ]] || fail "the manual lacks $command"
    while read -r option; do
        [[ $page == *$'\n.B '"$option"* ]] || fail "the manual lacks $command $option"
    done < <("$lucerna" "$command" --help | sed -n 's/^  \(-[^ ]*\).*/\1/p')
done
if command -v groff > /dev/null; then
    [[ -z $(groff -man -ww -z "$prefix/share/man/man1/lucerna.1" 2>&1) ]] ||
        fail "the manual is no man page"
fi

# Of libraries, authors of plugins need the C++ library and GLM; each header compiles by itself.
headers=$prefix/include/lucerna
if grep -rnE '#include <[^>]*[./]' "$headers" | grep -v '#include <glm/'; then
    fail "installed headers include other libraries"
fi
find "$headers" -name '*.h' | while read -r header; do
    "${CXX:-c++}" -std=c++20 -fsyntax-only -I "$headers" -include "$header" -x c++ /dev/null
done

# build_project SOURCE BUILD OPTION…: as its author would.
build_project() {
    local source=$1 build=$2
    shift 2
    cmake -G Ninja -S "$source" -B "$build" -DCMAKE_PREFIX_PATH="$prefix" "$@" \
        > "$scratch/log" 2>&1 &&
        cmake --build "$build" >> "$scratch/log" 2>&1 || {
        cat "$scratch/log"
        fail "$source does not build"
    }
}

# render PLUGINS SCENE: a small picture of it.
render() {
    rm -f "$scratch/out.exr"
    "$lucerna" --plugins "$1" render "$2" --spp 1 -o "$scratch/out.exr"
    [[ -s $scratch/out.exr ]] || fail "$2 gave no picture"
}

example=$root/docs/examples/plugin
build_project "$example" "$scratch/debug" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS=-O0
"$lucerna" --plugins "$scratch/debug/plugins" plugins bsdf/toon
"$lucerna" check bsdf/toon bands=5 --samples 50000 --plugins "$scratch/debug/plugins"
render "$scratch/debug/plugins" "$example/scene.xml"
cmake --install "$scratch/debug" --prefix "$prefix" > /dev/null
render "$scratch" "$example/scene.xml"

# block LANGUAGE FILE: the first block of that language in a page of the documentation.
block() { awk -v fence='```'"$1" '$0 == fence { on = 1; next } on && /^```/ { exit } on' "$2"; }
mkdir -p "$scratch/mirror/bsdfs"
block cpp "$root/docs/writing_a_plugin.md" > "$scratch/mirror/bsdfs/perfect_mirror.cpp"
block cmake "$root/docs/writing_a_plugin.md" > "$scratch/mirror/CMakeLists.txt"
# By another compiler than the program's, if there is one: both have the same C++ ABI.
other=()
if command -v clang++ > /dev/null; then other=(-DCMAKE_CXX_COMPILER=clang++); fi
build_project "$scratch/mirror" "$scratch/mirror/build" "${other[@]}"
block xml "$root/docs/writing_a_scene.md" > "$scratch/ball.xml"
render "$scratch" "$scratch/ball.xml"
sed 's/<bsdf type="roughplastic">/<bsdf type="perfect_mirror">/; /diffuse_reflectance/d' \
    "$scratch/ball.xml" > "$scratch/mirror.xml"
render "$scratch/mirror/build/plugins" "$scratch/mirror.xml"
"$lucerna" check bsdf/perfect_mirror --samples 50000 --plugins "$scratch/mirror/build/plugins"

echo "Plugins were built against the installation, and their scenes were rendered."
