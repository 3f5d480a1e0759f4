#!/usr/bin/env bash
# Makes the water meshes of a run on a farm with Slurm: an array job whose tasks make a few frames each, and a job that
# depends on it and checks that all frames are there. docs/farm.md describes it.
#
#   demos/tools/mesh_farm.sh [options] DIR [-- options of `oilskin mesh`]
#     --program FILE   the program (default: oilskin, as the shell finds it)
#     --frames A:B     only these frames, both included (default: all)
#     --chunk N        frames per task (default 10)
#     --retries N      how often a task that was killed or lacked memory or disk is started again (default 3)
#     --at-once N      tasks that run at the same time (default: as many as Slurm has place for)
#     --sbatch OPTION  for sbatch, of tasks and check, e.g. --sbatch --partition=render; may be repeated
#     --wait           until the check has ended
# Frames that are complete are skipped: the same command continues what was stopped.
# Exit code, with --wait and of the check: 0 all frames are there, 1 a mesh is not as promised, 2 bad input, 3 frames
# are missing.
set -uo pipefail

fail() { echo "mesh_farm: $1" >&2 && exit 2; }

# A positive integer.
number() { [[ $2 =~ ^[1-9][0-9]{0,5}$ || ($1 == --retries && $2 == 0) ]] || fail "$1 $2: must be a number"; }

read_options() {
  program=oilskin frames='' chunk=10 retries=3 at_once='' wait='' dir='' mesh_options=() sbatch_options=()
  while (($#)); do
    case $1 in
      --wait) wait=--wait ;;
      --) shift && mesh_options=("$@") && break ;;
      --program | --frames | --chunk | --retries | --at-once | --sbatch)
        (($# > 1)) || fail "$1: a value is missing"
        case $1 in
          --program) program=$2 ;;
          --frames) frames=$2 ;;
          --chunk) number "$1" "$2" && chunk=$2 ;;
          --retries) number "$1" "$2" && retries=$2 ;;
          --at-once) number "$1" "$2" && at_once=%$2 ;;
          --sbatch) sbatch_options+=("$2") ;;
        esac
        shift ;;
      -*) fail "$1: this option is not known" ;;
      *) [[ ! $dir ]] || fail "$1: there is a folder already, $dir"
         dir=$1 ;;
    esac
    shift
  done
  [[ $dir ]] || fail "a folder with frames is needed"
}

# The folder of the meshes.
mesh_folder() {
  local out=$dir i
  for ((i = 0; i < ${#mesh_options[@]}; ++i)); do
    case ${mesh_options[i]} in
      --out) out=${mesh_options[i + 1]:-$dir} ;;
      --out=*) out=${mesh_options[i]#--out=} ;;
      --frames | --frames=* | --missing | --overwrite | --threads | --threads=*)
        fail "${mesh_options[i]}: is no option for the farm" ;;
    esac
  done
  echo "$out"
}

# Numbers of the frames that lack a file, one a line.
missing_frames() { "$program" mesh "$dir" --missing ${frames:+--frames "$frames"} "${mesh_options[@]}"; }

# "FIRST:LAST" of each task.
chunks_of() { awk -v n="$1" '{ if (NR % n == 1 || n == 1) first = $1 } NR % n == 0 { print first ":" $1; first = "" }
  { last = $1 } END { if (first != "") print first ":" last }'; }

# What tasks and check need, in a file that they source.
write_plan() {
  local out
  out=$(mesh_folder) || exit 2
  declare -p program dir frames retries mesh_options | sed 's/^declare -[-a]* //' >"$work/plan"
  printf 'out=%q\n' "$out" >>"$work/plan"
}

submit() {
  read_options "$@"
  command -v sbatch >/dev/null || fail "sbatch is not there: this needs Slurm (Debian: slurm-client)"
  program=$(readlink -f "$(command -v "$program")") && [[ -x $program ]] || fail "--program: the program is not there"
  dir=$(readlink -f "$dir") && [[ -d $dir ]] || fail "the folder is not there"
  mesh_folder >/dev/null || exit 2
  local missing limit tasks array check
  missing=$(missing_frames) || exit $?
  [[ $missing ]] || { echo "All frames are there." && exit 0; }
  # Slurm's limit is one more than the largest number of a task.
  limit=$(scontrol show config | awk '$1 == "MaxArraySize" { print $3 }') || exit 3
  tasks=$(wc -l <<<"$missing")
  ((chunk * (limit - 1) >= tasks)) || chunk=$(((tasks + limit - 2) / (limit - 1)))
  mkdir -p "$dir/farm" && work=$(mktemp -d "$dir/farm/$(date +%Y%m%d-%H%M%S)-XXXX") || exit 3
  write_plan
  chunks_of "$chunk" <<<"$missing" >"$work/chunks"
  # Slurm copies what it runs, so the path of this file would be lost; and it may change while jobs wait.
  cp "${BASH_SOURCE[0]}" "$work/mesh_farm.sh" || exit 3
  array=$(sbatch --parsable --job-name=oilskin-mesh --array="0-$(($(wc -l <"$work/chunks") - 1))$at_once" --requeue \
    --signal=B:USR1@60 --open-mode=append --output="$work/task_%a.log" "${sbatch_options[@]}" \
    --wrap "exec bash '$work/mesh_farm.sh' _task '$work'") || exit 3
  echo "Array job $array: $(wc -l <"$work/chunks") tasks for $tasks frames; logs and summary in $work"
  check=$(sbatch --parsable --job-name=oilskin-mesh-check --dependency="afterany:$array" $wait --open-mode=append \
    --output="$work/check.log" "${sbatch_options[@]}" --wrap "exec bash '$work/mesh_farm.sh' _check '$work'")
  local code=$?
  echo "Check: job $check"
  [[ ! $wait ]] || { cat "$work/check.log" && exit $code; }
  ((code == 0)) || exit 3
}

# What a killed program left of frames FIRST:LAST. No other task makes them.
remove_parts() {
  local n
  for ((n = ${1%:*}; n <= ${1#*:}; ++n)); do rm -f "$out/surface_$(printf %04d "$n")".*.part; done
}

# Slurm starts the task again, on any node, and counts in SLURM_RESTART_COUNT.
retry() {
  echo "attempt $attempt ended with $1"
  if ((attempt > retries)); then
    echo "given up"
    echo "3 $attempt" >"$work/task_$SLURM_ARRAY_TASK_ID.exit"
    exit 3
  fi
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID" || exit 3
  sleep 600  # Slurm ends this
}

stop_and_retry() {
  kill -TERM "$child" 2>/dev/null
  wait "$child"
  retry "the time limit"
}

task() {
  work=$1
  source "$work/plan"
  attempt=$((${SLURM_RESTART_COUNT:-0} + 1))
  local chunk code
  chunk=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" "$work/chunks")
  echo "attempt $attempt: frames $chunk on $(hostname)"
  remove_parts "$chunk"
  trap stop_and_retry USR1
  "$program" mesh "$dir" --frames "$chunk" --threads "${SLURM_CPUS_PER_TASK:-1}" "${mesh_options[@]}" &
  child=$!
  wait "$child"
  code=$?
  # Again would end the same where the input is bad or a mesh is not as promised.
  ((code <= 2)) || retry "exit code $code"
  echo "$code $attempt" >"$work/task_$SLURM_ARRAY_TASK_ID.exit"
  exit $code
}

# Numbers as a list of JSON.
json_list() { printf '[%s]' "$(paste -sd, | sed 's/,/, /g')"; }

# Tasks that ended with exit code $1.
tasks_with() { (cd "$work" && grep -lE "^$1 " task_*.exit 2>/dev/null) | sed 's/task_\(.*\)\.exit/\1/' | sort -n; }

check() {
  work=$1
  source "$work/plan"
  local missing code=0 attempts
  missing=$(missing_frames) || code=2
  attempts=$(cat "$work"/task_*.exit 2>/dev/null | awk '{ n += $2 - 1 } END { print n + 0 }')
  if ((code == 0)) && [[ $missing ]]; then code=3; fi
  if ((code == 0)) && [[ $(tasks_with 1) ]]; then code=1; fi
  {
    printf '{\n  "exit_code": %d,\n  "tasks": %d,\n  "retries": %d,\n' "$code" "$(wc -l <"$work/chunks")" "$attempts"
    printf '  "tasks_with_a_failed_check": %s,\n' "$(tasks_with 1 | json_list)"
    printf '  "missing_frames": %s\n}\n' "$(json_list <<<"$missing")"
  } >"$work/summary.json.part" && mv "$work/summary.json.part" "$work/summary.json"
  cat "$work/summary.json"
  exit $code
}

case ${1:-} in
  _task) task "$2" ;;
  _check) check "$2" ;;
  '' | -h | --help) sed -n '2,/^set/{/^#/s/^# \{0,1\}//p}' "$0" >&2 && exit 2 ;;
  *) submit "$@" ;;
esac
