#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Builds the filter for MeshLab 2020.09 on Debian 12: one file to put among MeshLab's plugins.
#
#   plugins/meshlab/build.sh [--to DIR] [--from DIR] [--pymeshlab DIR]
#
#   --to DIR         where to work and to leave the filter; default target/meshlab
#   --from DIR       complete-mesh's libraries lie there already (e.g. target/release)
#   --pymeshlab DIR  for the pymeshlab 2025.7 that is installed in DIR instead; headers from Debian's
#                    next release, which move: this may stop to work
#
# Needs Rust, a C++ compiler, cmake, and of Debian meshlab qtbase5-dev libqt5opengl5-dev libeigen3-dev
# libglew-dev dpkg-dev. MeshLab's headers come from the distribution's source package.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
to=${CARGO_TARGET_DIR:-$root/target}/meshlab from='' pymeshlab=''
while [ $# -gt 0 ]; do
  case $1 in
    --to) to=$2 ;;
    --from) from=$2 ;;
    --pymeshlab) pymeshlab=$2 ;;
    *) sed -n '4,16s/^# \{0,1\}//p' "$0"; exit 2 ;;
  esac
  shift 2
done
mkdir -p "$to"
to=$(cd "$to" && pwd)

# sources SUITE VERSION: downloads MeshLab's source through lists of our own, made from the machine's,
# so that nothing is changed in /etc/apt.
sources() {
  local apt=$to/apt list
  mkdir -p "$apt/lists/partial" "$apt/parts"
  for list in /etc/apt/sources.list.d/debian.sources /etc/apt/sources.list; do
    [ -e "$list" ] || continue
    case $list in
      # The first paragraph is the release itself; security and updates follow.
      *.sources) sed -e '/^$/,$d' -e 's/^Types:.*/Types: deb-src/' ${1:+-e "s/^Suites:.*/Suites: $1/"} \
        "$list" >"$apt/parts/own.sources" ;;
      *) sed -n "s/^deb \(.* \)\(bookworm\) /deb-src \1${1:-\2} /p" "$list" | head -n 1 >"$apt/parts/own.list" ;;
    esac
    break
  done
  local options=(-o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$apt/parts"
    -o "Dir::State::lists=$apt/lists" -o "Dir::Cache::srcpkgcache=$apt/source.bin"
    -o "Dir::Cache::pkgcache=$apt/package.bin" -o APT::Sandbox::User=root)
  apt-get -q "${options[@]}" update
  # Only the archive is needed: the index may name patches that are not there yet.
  (cd "$to" && apt-get -q "${options[@]}" source --download-only "meshlab=$2") ||
    ls "$to/meshlab_${2%-*}.orig.tar.xz"
}

# headers SUITE VERSION: unpacks the source into $to/source, once.
headers() {
  [ -e "$to/source/src/common" ] && return
  [ -e "$to/meshlab_${2%-*}.orig.tar.xz" ] || sources "$1" "$2"
  rm -rf "$to/source" && mkdir "$to/source"
  tar xf "$to/meshlab_${2%-*}.orig.tar.xz" -C "$to/source" --strip-components 1
}

if [ -z "$pymeshlab" ]; then
  # Neither this MeshLab nor the compiler would notice headers of another version.
  found=$(dpkg-query -W -f '${Version}' meshlab)
  case $found in
    2020.09*) ;;
    *) echo "the MeshLab that is installed is $found; this builds for 2020.09" >&2; exit 1 ;;
  esac
  headers '' 2020.09+dfsg1-2
  common=$(ls /usr/lib/*/meshlab/libmeshlab-common.so)
  flags=(-DML_API=202009 -DML_VERSION=2020.09 -DML_SCALAR=float "-DVCGLIB=$to/source/vcglib")
else
  headers sid '2025.07~dfsg-4'
  common=$pymeshlab/lib/libmeshlab-common.so
  flags=(-DML_API=202107 -DML_VERSION=2025.07 -DML_SCALAR=double "-DVCGLIB=$to/source/src/vcglib")
fi
bash "$root/bindings/install.sh" "$to/prefix" ${from:+--from "$from"}
cmake -S "$here" -B "$to/build" -DCMAKE_PREFIX_PATH="$to/prefix" "-DMESHLAB_SOURCE=$to/source/src" \
  "-DMESHLAB_COMMON=$common" "${flags[@]}"
cmake --build "$to/build" --parallel 2
cp "$to/build/libfilter_fill_coherently.so" "$to/"
echo "the filter is $to/libfilter_fill_coherently.so"
