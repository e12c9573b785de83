#!/usr/bin/env bash
# A store is read by pandas in the two lines that the documentation shows. Status 77: there is no pandas.
# usage: pandas_test.sh PROGRAM
set -euo pipefail

readonly program=$1
python=
for candidate in /usr/bin/python3 python3; do
  if "$candidate" -c 'import pandas, numpy' 2>/dev/null; then
    python=$candidate
    break
  fi
done
if [[ -z $python ]]; then
  echo "skipped: python3 has no pandas (Debian package python3-pandas)"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
cat >fog.toml <<'SCENE'
title = "A small box of fog"
[views.front]
eye = [0, 0, 4]
target = [0, 0, 0]
fov_y_deg = 45
[volume]
kind = "constant"
voxels = 8
center = [0, 0, 0]
size = 2
extinction = 1
[parameters]
density = { default = 1, range = [0, 1000], mode = "scale", doc = "extinction", drives = ["volume.extinction"] }
SCENE
cat >s.toml <<'SPEC'
name = "s"
metrics = ["rmse"]
[timing]
min_samples = 5
max_samples = 5
[reference]
tolerance = 1e-2
[[run]]
name = "r"
techniques = ["volume_slices"]
scenes = ["fog.toml"]
sizes = ["16x12"]
[run.axes]
scene.density = { from = 0.7, to = 1.0, steps = 4 }
SPEC
"$program" sweep run s.toml --store hulls.db --quiet
"$python" - <<'PYTHON'
import sqlite3, pandas, numpy
rows = pandas.read_sql("SELECT * FROM results", sqlite3.connect("hulls.db"))
assert len(rows) == 4, rows
assert list(rows["scene.density"]) == [0.7, 0.8, 0.9, 1.0], rows["scene.density"]
assert rows["frame_ms_median"].dtype == numpy.float64 and (rows["frame_ms_median"] > 0).all()
assert rows["slices"].dtype == numpy.int64 and rows["technique"][0] == "volume_slices"
columns = pandas.read_sql("SELECT * FROM columns", sqlite3.connect("hulls.db"), index_col="name")
assert columns.loc["frame_ms_median", "unit"] == "ms", columns
assert columns.loc["slices", "kind"] == "parameter" and columns.loc["slices", "description"]
(blob,) = sqlite3.connect("hulls.db").execute("SELECT frame_ms FROM points LIMIT 1").fetchone()
samples = numpy.frombuffer(blob, dtype="<f8")
assert len(samples) == 5 and (samples > 0).all(), samples
PYTHON
"$program" results hulls.db --where 'scene.density>=0.9' --columns scene.density,frame_ms_samples --samples --format jsonl >rows.jsonl
"$python" - <<'PYTHON'
import json
rows = [json.loads(line) for line in open("rows.jsonl")]
assert [row["scene.density"] for row in rows] == [0.9, 1.0], rows
assert all(list(row) == ["scene.density", "frame_ms_samples"] and len(row["frame_ms_samples"]) == 5 for row in rows)
PYTHON
