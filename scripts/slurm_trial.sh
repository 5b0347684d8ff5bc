#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The two jobs of docs/many-machines.md on a Slurm of this one machine, which is started here and ended before the script returns:
# an array of traces, one of them signalled and put back into the queue, and one job of lucerna-mpi, likewise. Their files must be
# those of one process, to the byte. Usage: scripts/slurm_trial.sh LUCERNA LUCERNA_MPI MPIEXEC
# Exit code 0: they are; 1: they are not; 77: Slurm and munge are not installed (apt-get install slurmctld slurmd munge), or the
# user is not root. RAYS (default 4e7) must keep one processor busy for some seconds, so that a signal comes before the end.
set -u
[ $# -eq 3 ] || { echo "usage: $0 LUCERNA LUCERNA_MPI MPIEXEC" >&2; exit 2; }
for program in munged slurmctld slurmd sbatch srun scontrol; do
  [ -n "$(PATH=$PATH:/usr/sbin command -v "$program")" ] || { echo "SKIPPED: $program is not installed"; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "SKIPPED: slurmd starts jobs as root only"; exit 77; }
export PATH=$PATH:/usr/sbin
lucerna=$(realpath "$1") lucerna_mpi=$(realpath "$2") mpiexec=$3
rays=$(printf '%.0f' "${RAYS:-4e7}")
dir=$(mktemp -d /tmp/lucerna_slurm_XXXXXX)
chmod 755 "$dir"
host=$(hostname -s)
daemons=""

# Whatever happens, nothing is left: jobs first, then the daemons, newest first.
finish() {
  code=$?
  trap - EXIT INT TERM
  [ -z "$daemons" ] || timeout 20 scancel --user=root --quiet 2>/dev/null
  sleep 1
  for pid in $daemons; do
    kill "$pid" 2>/dev/null
    for _ in $(seq 50); do kill -0 "$pid" 2>/dev/null || break; sleep 0.1; done
    kill -KILL "$pid" 2>/dev/null
  done
  [ "$code" -eq 0 ] || tail -n 20 "$dir"/*.log "$dir"/run/*.out >&2 2>/dev/null
  rm -rf "$dir"
  exit "$code"
}
trap finish EXIT
trap 'exit 1' INT TERM

fail() { echo "FAILED: $*"; exit 1; }

start() { # LOG COMMAND...: a daemon in the foreground
  local log=$1
  shift
  "$@" >"$dir/$log" 2>&1 &
  daemons="$! $daemons"
}

wait_until() { # SECONDS WHAT COMMAND...
  local seconds=$1 what=$2
  shift 2
  for _ in $(seq $((seconds * 5))); do
    "$@" >/dev/null 2>&1 && return 0
    sleep 0.2
  done
  fail "$what: not within $seconds s"
}

start_slurm() {
  mkdir -p "$dir/state" "$dir/spool" "$dir/run"
  head -c 1024 /dev/urandom >"$dir/munge.key"
  chmod 400 "$dir/munge.key"
  # munged asks for folders that nobody else may write into, all the way up: /tmp is not one.
  start munged.log munged --foreground --force --key-file="$dir/munge.key" --socket="$dir/munge.socket" \
    --pid-file="$dir/munged.pid" --log-file="$dir/munged-own.log" --seed-file="$dir/munge.seed"
  wait_until 20 "munged" test -S "$dir/munge.socket"
  port=$((20000 + $$ % 20000))
  # Credentials that expire soon: a job that is put back into the queue starts only once they have.
  cat >"$dir/slurm.conf" <<END
ClusterName=trial
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$dir/munge.socket,cred_expire=5
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=2
ReturnToService=2
JobRequeue=1
MinJobAge=3600
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
  export SLURM_CONF=$dir/slurm.conf
  start slurmctld.log slurmctld -D
  wait_until 30 "slurmctld" scontrol ping
  start slurmd.log slurmd -D -f "$SLURM_CONF"
  wait_until 60 "an idle node" sh -c "sinfo -h -o %T | grep -q '^idle'"
}

ended() { # an error of squeue is no end
  local left
  left=$(squeue -h -j "$1" 2>/dev/null) && [ -z "$left" ]
}
restarts() { scontrol show job "$1" 2>/dev/null | grep -o 'Restarts=[0-9]*' | sort | tail -n 1; }
# scancel tries again while a job is put back into the queue: its signal may come more than once.
restarted() {  # JOB
  case $(restarts "$1") in
    Restarts=[1-9]*) ;;
    *) fail "job $1: $(restarts "$1"), a restart expected (more RAYS?)" ;;
  esac
}

same() { # A B NAMES...
  local a=$1 b=$2
  shift 2
  for name in "$@"; do cmp "$a/$name" "$b/$name" || fail "$name is not that of one process"; done
}

array() {
  local parts=4
  cat >array.sh <<END
#!/bin/sh
#SBATCH --array=0-$((parts - 1))
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=array-%a.out
each=$((rays / parts))
first=\$((SLURM_ARRAY_TASK_ID * each))
srun "$lucerna" trace lamp.toml -o part-\$SLURM_ARRAY_TASK_ID --rays \$first:\$((first + each)) --threads 1 --resume
code=\$?
[ \$code -ne 3 ] || scontrol requeue "\${SLURM_ARRAY_JOB_ID}_\$SLURM_ARRAY_TASK_ID"
exit \$code
END
  local id
  id=$(sbatch --parsable array.sh) || fail "sbatch array.sh"
  wait_until 60 "task 1 of the array" sh -c "squeue -h --steps -o %i | grep -q '^${id}_1\.0'"
  sleep 0.5
  scancel --signal=TERM "${id}_1" || fail "scancel"
  wait_until 300 "the end of the array" ended "$id"
  restarted "${id}_1"
  "$lucerna" merge part-* -o merged --quiet || fail "lucerna merge"
  same one merged trace.sums far-field.ldt far-field.ies floor.csv
  echo "array of $parts tasks, one put back into the queue: the files of one process"
}

requeue() {
  local start="srun --mpi=pmix"
  srun --mpi=list 2>&1 | grep -q pmix || start="$mpiexec --allow-run-as-root --quiet"
  cat >requeue.sh <<END
#!/bin/sh
#SBATCH --ntasks=2
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=requeue.out
$start "$lucerna_mpi" trace lamp.toml -o result --rays $rays --threads 1 --chunk 65536 --checkpoint 0.2 --resume
code=\$?
[ \$code -ne 3 ] || scontrol requeue "\$SLURM_JOB_ID"
exit \$code
END
  local id
  id=$(sbatch --parsable requeue.sh) || fail "sbatch requeue.sh"
  wait_until 60 "a checkpoint" sh -c "ls result/parts/*.part"
  scancel --signal=USR1 "$id" || fail "scancel"
  wait_until 300 "the end of the job" ended "$id"
  restarted "$id"
  grep -q "are there already" requeue.out || fail "nothing was gone on with"
  same one result trace.sums far-field.ldt far-field.ies floor.csv project.toml
  echo "lucerna-mpi on two ranks, put back into the queue ($start): the files of one process"
}

start_slurm
cd "$dir/run" || exit 1
cat >lamp.toml <<'END'
[[source]]
kind = "led"
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15
diameter_mm = 60
hole_diameter_mm = 6
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
[[detector]]
kind = "far-field"
[[detector]]
kind = "plane"
name = "floor"
position_mm = [0, 0, -1000]
normal = "+z"
size_mm = [2000, 2000]
END
"$lucerna" trace lamp.toml -o one --rays "$rays" --quiet || fail "lucerna trace"
array
requeue
