#!/usr/bin/env bash
# Builds the C library and installs headers (C, C++, OpenMesh), static and shared library without
# debugging information, pkg-config file and CMake package below a prefix. Linux and the BSDs; needs
# Rust with its linker's tools.
#
#   bindings/install.sh PREFIX [--libdir DIR] [--from DIR]
#
#   --libdir DIR   where libraries go, relative to PREFIX; default lib
#   --from DIR     install the libraries that lie in DIR (e.g. target/release), build nothing
#   DESTDIR        environment: put in front of PREFIX, for packagers
set -euo pipefail

usage() { sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 2; }

prefix='' libdir=lib from=''
while [ $# -gt 0 ]; do
  case $1 in
    --libdir) libdir=${2:?--libdir needs a directory}; shift ;;
    --from) from=${2:?--from needs a directory}; shift ;;
    -*) usage ;;
    *) [ -z "$prefix" ] || usage; prefix=$1 ;;
  esac
  shift
done
[ -n "$prefix" ] || usage
case $prefix in /*) ;; *) prefix=$PWD/$prefix ;; esac

root=$(cd "$(dirname "$0")/.." && pwd)
header=$root/include/complete_mesh.h

# The header is the one place that has all numbers; the tests compare it with Cargo.toml.
number() { sed -n "s/^#define COMPLETE_MESH_$1 \([0-9]*\)$/\1/p" "$header"; }
version=$(number VERSION_MAJOR).$(number VERSION_MINOR).$(number VERSION_PATCH)
abi=$(number ABI_VERSION)

if [ -z "$from" ]; then
  # Without the features that only the command line needs.
  (cd "$root" && cargo build --release --lib --no-default-features --features capi)
  from=${CARGO_TARGET_DIR:-$root/target}/release
fi

to=${DESTDIR:-}$prefix
lib=$to/$libdir
name=libcomplete_mesh
# The soname carries the ABI's number, the file the ABI's and the package's.
file=$name.so.$abi.$version

install -d "$to/include/complete_mesh" "$lib/pkgconfig" "$lib/cmake/complete_mesh"
install -m 644 "$header" "$root"/bindings/cpp/*.hpp "$root"/bindings/openmesh/*.hpp \
  "$to/include"
install -m 644 "$root"/bindings/cpp/complete_mesh/*.hpp "$to/include/complete_mesh"
# A release build keeps line numbers for profiles; they are nine tenths of it.
strip=${STRIP:-strip}
"$strip" --strip-debug -o "$lib/$name.a" "$from/$name.a"
"$strip" --strip-unneeded -o "$lib/$file" "$from/$name.so"
chmod 644 "$lib/$name.a"
chmod 755 "$lib/$file"
ln -sf "$file" "$lib/$name.so.$abi"
ln -sf "$name.so.$abi" "$lib/$name.so"

# How to get from a directory below the prefix back to it: the installed tree may be moved.
up() { printf '%s' "$1" | sed 's,/\{1\,\},/,g; s,^/,,; s,/$,,; s,[^/]\{1\,\},..,g'; }
fill() {
  sed -e "s,@VERSION@,$version,g" -e "s,@ABI@,$abi,g" -e "s,@FILE@,$file,g" \
    -e "s,@LIBDIR@,$libdir,g" -e "s,@UP_PKGCONFIG@,$(up "$libdir/pkgconfig"),g" \
    -e "s,@UP_CMAKE@,$(up "$libdir/cmake/complete_mesh"),g" "$root/bindings/$1" >"$2"
  chmod 644 "$2"
}
fill pkgconfig/complete_mesh.pc.in "$lib/pkgconfig/complete_mesh.pc"
fill cmake/complete_mesh-config.cmake.in "$lib/cmake/complete_mesh/complete_mesh-config.cmake"
fill cmake/complete_mesh-config-version.cmake.in \
  "$lib/cmake/complete_mesh/complete_mesh-config-version.cmake"

echo "complete-mesh $version (C ABI $abi) installed below $to"
