#!/usr/bin/env bash
# A real Slurm on this machine runs a small sweep; a task is killed half-way. Status 77: there is no Slurm, or no right to start one.
# usage: slurm_test.sh PROGRAM
set -uo pipefail

readonly program=$1
skip() {
  printf 'skipped: %s\n' "$*"
  exit 77
}
for tool in munged munge slurmctld slurmd sbatch squeue scontrol; do
  command -v "$tool" >/dev/null || skip "$tool is not installed"
done
[[ $EUID -eq 0 ]] || skip "starting Slurm's daemons takes root"

folder=$(mktemp -d /tmp/pellucid-slurm-XXXXXX)
host=$(hostname -s)
pids=()
stop() {
  local pid
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null; done
  sleep 1
  for pid in "${pids[@]}"; do kill -9 "$pid" 2>/dev/null; done
  rm -rf -- "$folder"
}
trap stop EXIT
mkdir -p "$folder"/{state,spool,munge,work}
chmod 755 "$folder"
chmod 700 "$folder/munge"

head -c 1024 /dev/urandom >"$folder/munge/key"
chmod 400 "$folder/munge/key"
munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
  --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" &
pids+=($!)

cat >"$folder/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmdPort=26818
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,bf_interval=1
MinJobAge=300
ReturnToService=2
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
CONF
export SLURM_CONF=$folder/slurm.conf
sleep 1
slurmctld -D >"$folder/slurmctld.out" 2>&1 &
pids+=($!)
slurmd -D >"$folder/slurmd.out" 2>&1 &
pids+=($!)
for _ in $(seq 60); do
  [[ $(sinfo --noheader --format=%t 2>/dev/null) == idle ]] && break
  sleep 0.5
done
[[ $(sinfo --noheader --format=%t 2>/dev/null) == idle ]] || {
  tail -n 5 "$folder"/slurm*.out "$folder"/slurm*.log
  skip "Slurm does not start here"
}

fail() {
  printf 'FAILED: %s\n' "$*"
  tail -n 20 "$folder"/work/out/logs/*.log
  exit 1
}

cat >"$folder/work/fog.toml" <<'SCENE'
title = "A small box of fog"
ambient = 0.5
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
SCENE
cat >"$folder/work/s.toml" <<'SPEC'
name = "slurm"
metrics = ["rmse"]
[timing]
min_samples = 300
max_samples = 300
max_seconds = 5
[reference]
tolerance = 1e-2
[[run]]
name = "timed"
techniques = ["volume_slices"]
scenes = ["fog.toml"]
sizes = ["32x24"]
[run.axes]
slices = { from = 4, to = 15, steps = 12 }
[[run]]
name = "untimed"
techniques = ["volume_slices"]
scenes = ["fog.toml"]
sizes = ["32x24"]
timing = { enabled = false }
[run.axes]
slices = { from = 4, to = 9, steps = 6 }
SPEC
cd "$folder/work" || exit 1
export PELLUCID_KEEP_S=1
"$program" sweep slurm s.toml -o out --program "$program" --shards 3 --at-once 2 --partition main || fail "not submitted"
timing=$(awk '$1 == "timing" {print $2}' out/jobs)

# A timing task is killed as soon as one runs, with its batch script and all: it must go on after a requeue. One more is requeued
# when all have ended and the merge is about to start: that must wait for it.
merge=$(awk '$1 == "merge" {print $2}' out/jobs)
scontrol hold "$merge"
killed=no
late=no
for _ in $(seq 600); do
  task=$(squeue --noheader --array --jobs="$timing" --states=RUNNING --format=%i 2>/dev/null | head -n 1)
  if [[ -n $task && $killed == no ]]; then
    sleep 1
    scontrol requeue "$task" && killed=$task
  fi
  # Slurm lets a requeued task wait for two minutes.
  for task in $killed $late; do [[ $task == no ]] || scontrol update JobId="$task" StartTime=now 2>/dev/null; done
  if [[ $late == no && $(find out/shards -name 'timing-*.done' | wc -l) -eq 3 && -z $(squeue --noheader --jobs="$timing" --format=%i 2>/dev/null) ]]; then
    scontrol requeuehold "${timing}_3" && late=${timing}_3
    scontrol release "$merge"
    sleep 3  # the merge starts and finds the task in the queue, or Slurm holds it back itself
    scontrol release "$late"
  fi
  [[ -s out/results.csv ]] && break
  sleep 0.3
done
"$program" sweep status out
[[ -s out/results.csv ]] || fail "there are no results"
[[ $killed != no ]] || fail "no task was caught running"
[[ $late != no ]] || fail "no task was requeued at its end"
rows=$(tail -n +2 out/results.csv | wc -l)
[[ $rows -eq 18 ]] || fail "$rows rows instead of 18 (task $killed was requeued)"
grep -q ',ok,' out/results.csv || fail "no row is ok"
[[ $(grep -c ',failed,' out/results.csv) -eq 0 ]] || fail "rows have failed"
[[ $(find out/references -name '*.exr' | wc -l) -eq 1 ]] || fail "the reference was not traced once"
[[ $(find out/shards -name '*.done' | wc -l) -eq 6 ]] || fail "not all tasks say that they are done"
echo "18 rows; task $killed was killed half-way and requeued, task $late at its end"
