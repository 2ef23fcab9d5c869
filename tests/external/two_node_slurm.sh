#!/bin/sh
# A Slurm of two nodes on this machine, from Debian's packages; the smoke pipeline on it; one node killed
# half-way; the same bytes as a local run.
#
#   apt-get install -y --no-install-recommends slurm-wlm munge     (once, as root)
#   tests/external/two_node_slurm.sh PROGRAM [FOLDER]               (as root)
#
# PROGRAM is the built `maveric`; FOLDER takes everything that is written (default: a new one in /tmp).
set -eu
program=$(realpath "$1")
here=$(cd "$(dirname "$0")/../.." && pwd)
work=$(realpath "${2:-$(mktemp -d /tmp/two-node-slurm.XXXXXX)}")
mkdir -p "$work/etc" "$work/state" "$work/spool" "$work/log"
host=$(hostname -s)
say() { echo "$(date +%T) $*"; }

stop_node() { kill -9 "$(cat "$work/slurmd-$1.pid")" 2>/dev/null || true; }
finish() {
  for node in n1 n2; do stop_node "$node"; done
  kill "$(cat "$work/slurmctld.pid" 2>/dev/null)" 2>/dev/null || true
  [ -n "${munge:-}" ] && kill "$(cat /run/munge/munged.pid)" 2>/dev/null || true
}
trap finish EXIT

# munge: the key that lets the daemons believe each other
if ! munge -n >/dev/null 2>&1; then
  mkdir -p /run/munge /var/log/munge
  chown munge: /run/munge /var/log/munge /etc/munge /var/lib/munge
  su -s /bin/sh munge -c munged
  munge=ours
fi

cat >"$work/etc/slurm.conf" <<CONF
ClusterName=two
SlurmctldHost=$host
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SlurmdTimeout=10
SlurmctldTimeout=10
InactiveLimit=0
SchedulerParameters=sched_interval=2,batch_sched_delay=0,defer
SlurmctldPort=17000
SlurmctldPidFile=$work/slurmctld.pid
SlurmctldLogFile=$work/log/slurmctld.log
StateSaveLocation=$work/state
SlurmdPidFile=$work/slurmd-%n.pid
SlurmdLogFile=$work/log/slurmd-%n.log
SlurmdSpoolDir=$work/spool/%n
SlurmdParameters=config_overrides
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[17001-17002] CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$work/etc/slurm.conf"
mkdir -p "$work/spool/n1" "$work/spool/n2"
slurmctld -c
slurmd -N n1
slurmd -N n2
for _ in $(seq 60); do
  [ "$(sinfo -h -N -t idle -o %n | wc -l)" = 2 ] && break
  sleep 0.5
done
sinfo -N -l

copy() { mkdir -p "$1/pipelines"; cp -r "$here/study_data" "$1/"; cp "$here"/pipelines/*.toml "$1/pipelines/"; }
rm -rf "$work/local" "$work/cluster"
copy "$work/local"
copy "$work/cluster"

say "the local run"
(cd "$work/local" && "$program" run pipelines/smoke.toml -j 2 2>"$work/log/local.txt" >/dev/null)

say "the run on two nodes"
cd "$work/cluster"
"$program" run pipelines/smoke.toml --executor slurm >"$work/log/cluster.out" 2>"$work/log/cluster.txt" &
run=$!
# Half-way: in the middle of the longest stage its node dies, with all that runs on it.
for _ in $(seq 1200); do
  node=$(squeue -h -t R -n smoke.simulate -o %N 2>/dev/null | head -n 1)
  [ -n "$node" ] && break
  sleep 0.1
done
sleep 1.5
say "killing node $node while it runs: $(squeue -h -t R -w "$node" -o %j)"
squeue
job=$(squeue -h -t R -w "$node" -o %A | head -n 1)
kill_tree() {
  for child in $(ps -o pid= --ppid "$1"); do kill_tree "$child"; done
  kill -9 "$1" 2>/dev/null || true
}
stop_node "$node"
steps=$(pgrep -f "^slurmstepd: \[$job" || true)
say "with its steps: ${steps:-none}"
for step in $steps; do kill_tree "$step"; done
(sleep 20; say "node $node comes back"; slurmd -N "$node") &
status=0
wait "$run" || status=$?
cat "$work/log/cluster.txt"
say "the run ended with status $status"
cd "$work"
diff -r local/study_data/generated/smoke cluster/study_data/generated/smoke
diff -r local/reports/smoke cluster/reports/smoke
files=$(find cluster/study_data/generated/smoke cluster/reports/smoke -type f | wc -l)
say "$files files, the same bytes as the local run"
for run in local cluster; do grep -v -E '^(seconds|peak_memory)' "$run/pipelines/smoke.lock" >"$run.lock.plain"; done
diff local.lock.plain cluster.lock.plain && say "and the same ledger, times aside"
grep -i -E "requeue|node_fail|not responding|set to down" log/slurmctld.log | head -n 12 || true
exit "$status"
