#!/bin/bash
# From nothing to a map: builds, simulates a corridor, maps it and holds the map against the truth.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin="$root/build/bin"

usage() {
  cat << 'END'
Usage: scripts/demo.sh [--real]

Without arguments: simulates a rig with three scanners in a corridor, maps the recording,
compares the result with the truth, draws a floor plan and writes a report. Everything lands in out/demo/.

  --real   map a recording of a real robot instead, into out/demo_real/
  --help   this text
END
}

real=false
case "${1:-}" in
  "") ;;
  --real) real=true ;;
  --help) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac

# What README and guide call next; the tests would take as long again.
"$root/scripts/build.sh" plumbline_check plumbline_evaluate plumbline_export plumbline_map \
  plumbline_plan plumbline_report plumbline_simulate

if $real; then
  out="$root/out/demo_real"
  mkdir -p "$out"
  "$bin/plumbline_map" \
    --recording="$root/test/data/robot_three_scanners.bag" \
    --rig="$root/configs/rigs/robot_three_scanners.yaml" \
    --output="$out" \
    --report
  "$root/scripts/figures/floor_plan.py" "$out" --output "$out/floor_plan.png"
  echo
  echo "Map:        $out/map.ply"
  echo "Floor plan: $out/floor_plan.png"
  echo "Report:     $out/report.html"
  exit 0
fi

out="$root/out/demo"
mkdir -p "$out"
experiment="$root/configs/experiments/corridor.yaml"
echo "== Simulating the corridor"
"$bin/plumbline_simulate" --experiment="$experiment" --seed=1 --output="$out/simulation"
echo "== Mapping it"
"$bin/plumbline_map" \
  --recording="$out/simulation/recording.bag" \
  --rig="$out/simulation/rig.yaml" \
  --config="$experiment" \
  --output="$out/result"
echo "== Comparing with the truth"
"$bin/plumbline_evaluate" \
  --result="$out/result" \
  --truth="$out/simulation" \
  --output="$out/evaluation.json" > "$out/evaluation.txt"
"$root/scripts/figures/floor_plan.py" "$out/result" \
  --truth "$out/simulation" \
  --evaluation "$out/evaluation.json" \
  --output "$out/floor_plan.png"

echo "== Drawing the floor plan"
"$bin/plumbline_plan" "$out/result"
echo "== Writing the report"
"$bin/plumbline_report" \
  --result="$out/result" \
  --evaluation="$out/evaluation.json" \
  --title="Demo: the corridor" \
  --output="$out/report.html"

/usr/bin/python3 - "$out/evaluation.json" "$out/result/summary.json" << 'END'
import json
import sys

evaluation, summary = (json.load(open(path, encoding="utf-8")) for path in sys.argv[1:])
trajectory, planes = evaluation["trajectory"], evaluation["planes"]


def row(name, position_m, rotation_deg):
    print(f"  {name:<34}{1000 * position_m:10.2f} mm {rotation_deg:10.4f} deg")


print(f"\n{summary['scans']} scans, {summary['points']:,} points, "
      f"mapped at {summary['real_time_factor']:.1f} times real time\n")
print(f"  {'Errors (root mean square)':<34}{'position':>13} {'angle':>14}")
for kind in ("unaligned", "aligned"):
    errors = trajectory[kind]
    row(f"trajectory, {kind}", errors["position_m"]["rmse"], errors["rotation_deg"]["rmse"])
row("planes", planes["distance_m"]["rmse"], planes["angle_deg"]["rmse"])
row("planes, largest", planes["distance_m"]["max"], planes["angle_deg"]["max"])
print(f"  {'residuals':<34}{1000 * evaluation['residual_rms_m']:10.2f} mm")
print(f"  planes: {planes['matched']} matched, {planes['wrong']} wrong, "
      f"{planes['doubled']} doubled, {planes['missed']} missed\n")
END
echo "All figures: $out/evaluation.txt"
echo "Map:         $out/result/map.ply"
echo "Floor plan:  $out/result/floor_plan.svg, walls against the truth in $out/floor_plan.png"
echo "Report:      $out/report.html (open it in a browser)"
