#!/usr/bin/env bash
# CPU seconds of the fill alone, this library against CGAL's triangulate_refine_and_fair_hole, on
# broken samples. Prints a table in Markdown; docs/speed.md has one.
#
#   bash benches/cgal/compare.sh            median of 5 runs
#   RUNS=11 bash benches/cgal/compare.sh    of 11
#   bash benches/cgal/compare.sh A.ply B.ply   your own meshes instead of the samples
#
# Needs, on Debian: apt-get install g++ libcgal-dev libeigen3-dev
set -euo pipefail
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
work=$target/cgal-compare
runs=${RUNS:-5}
mkdir -p "$work"

cargo build --release --quiet --manifest-path "$root/Cargo.toml" --target-dir "$target"
ours=$target/release/complete-mesh
theirs=$work/cgal_fill
if [ ! "$theirs" -nt "$here/fill.cpp" ]; then
  g++ -std=c++17 -O3 -DNDEBUG -DCGAL_EIGEN3_ENABLED -I/usr/include/eigen3 \
    "$here/fill.cpp" -o "$theirs" -lgmp -lmpfr
fi

# Holes with one loop each, so that both fill the same thing: CGAL caps every loop on its own.
# Model, break, edges along the longest side.
cases="column ragged 200
column ragged 400
vessel disc 200
vessel disc 400
relief ragged 200
leg disc 200
sphere disc 200
column crack 400
torus several 200"

inputs=()
if [ $# -gt 0 ]; then
  inputs=("$@")
else
  while read -r model break resolution; do
    file=$work/$model-$break-$resolution.ply
    "$ours" sample "$model" -o "$file" --break "$break" --resolution "$resolution" --quiet
    inputs+=("$file")
  done <<<"$cases"
fi

number() { sed -n "s/^  \"$1\": \([0-9.e-]*\),*$/\1/p" "$2"; }
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

echo "| mesh | vertices | rim edges | new vertices: ours | CGAL | CPU s: ours | CGAL | ratio |"
echo "|---|---|---|---|---|---|---|---|"
for input in "${inputs[@]}"; do
  name=$(basename "$input" .ply)
  : >"$work/ours.txt"
  : >"$work/theirs.txt"
  # In turn, so that a disturbance of the machine meets both.
  for _ in $(seq "$runs"); do
    if ! "$ours" fill "$input" -o "$work/out.ply" --method smooth --report "$work/report.json" --quiet; then
      echo "| $name | not filled by this library |"
      continue 2
    fi
    number fill_cpu_seconds "$work/report.json" >>"$work/ours.txt"
    "$theirs" "$input" >"$work/line.txt" || echo "CGAL failed on $name" >&2
    cut -d' ' -f1 "$work/line.txt" >>"$work/theirs.txt"
  done
  rim=$(sed -n 's/^ *"edges": \([0-9]*\),*$/\1/p' "$work/report.json" | awk '{ s += $1 } END { print s }')
  vertices=$("$ours" holes "$input" --json | sed -n 's/.*"event":"done".*"vertices":\([0-9]*\).*/\1/p')
  awk -v name="$name" -v vertices="$vertices" -v rim="$rim" \
    -v new="$(number new_vertices "$work/report.json")" -v cgal_new="$(cut -d' ' -f5 "$work/line.txt")" \
    -v a="$(median <"$work/ours.txt")" -v b="$(median <"$work/theirs.txt")" 'BEGIN {
      printf "| %s | %d | %d | %d | %d | %.4f | %.4f | %.2f |\n", name, vertices, rim, new, cgal_new, a, b, a / b
    }'
done | tee "$work/table.txt"

# A mesh that was not filled is in the table but not in the mean.
awk -F'|' 'NF > 4 { sum += log($7 / $8); n += 1 } END {
  if (n) printf "\ngeometric mean of ours / CGAL over %d of %d meshes: %.2f\n", n, NR, exp(sum / n)
}' "$work/table.txt"
