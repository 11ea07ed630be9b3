# Functions and variables shared by scripts/setup, scripts/run and scripts/test. To be sourced; runs nothing itself.
# shellcheck shell=bash

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build

# Status of a script that could not install or build; slipstick itself uses 0 to 4 (doc/interface.md).
readonly setup_failed=10

# The reason for each package: doc/dependencies.md.
readonly packages=(
  g++ cmake ninja-build ccache libdeal.ii-dev libtrilinos-amesos2-dev libtrilinos-tpetra-dev libmetis-dev
  libsuitesparse-dev libopenblas-dev openmpi-bin libopenmpi-dev libeigen3-dev nlohmann-json3-dev libcli11-dev
  libgtest-dev python3 file
)
# shellcheck disable=SC2034 # used by scripts/setup
readonly render_packages=(python3-vtk9 python3-numpy python3-matplotlib)

say() { printf '%s: %s\n' "${0##*/}" "$*" >&2; }

die() {
  say "$@"
  exit "$setup_failed"
}

usage_error() {
  say "$@"
  exit 2
}

# as_root COMMAND...: runs it as root and says so; asks sudo for the password only here.
as_root() {
  say "as root: $*"
  if [[ $(id -u) -eq 0 ]]; then
    DEBIAN_FRONTEND=noninteractive "$@"
  elif command -v sudo >/dev/null; then
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  else
    die "this needs root and there is no sudo here; run the command above as root, then repeat"
  fi
}

# missing_packages PACKAGE...: those that dpkg does not have installed, one a line.
missing_packages() {
  printf '%s\n' "$@" |
    grep -vxFf <(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "$@" 2>/dev/null | sed -n 's/^installed //p') || true
}

# have_candidates PACKAGE...: true if apt's lists contain all of them.
have_candidates() {
  local known
  known=$(LC_ALL=C apt-cache policy "$@" 2>/dev/null | awk '/^  Candidate:/ && $2 != "(none)"' | wc -l)
  [[ $known -ge $# ]]
}

# install_packages PACKAGE...: installs what is missing; silent and quick if nothing is missing.
install_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  [[ ${#missing[@]} -gt 0 ]] || return 0
  say "missing from this system: ${missing[*]}"
  local install=(apt-get install --yes --quiet --no-install-recommends "${missing[@]}")
  if have_candidates "${missing[@]}" && as_root "${install[@]}"; then
    return 0
  fi
  as_root apt-get update --quiet || die "apt-get update failed (see above): check the network and /etc/apt/sources.list"
  have_candidates "${missing[@]}" ||
    die "this release of Debian does not have all of: ${missing[*]} (Debian 12 and 13 have them; for others see" \
      "doc/platforms.md)"
  as_root "${install[@]}" || die "apt-get could not install: ${missing[*]} (see above)"
}

# The reference BLAS is an order of magnitude slower: where it is selected, select OpenBLAS. Any other choice
# (such as MKL) is left unchanged.
select_openblas() {
  local name value openblas
  command -v update-alternatives >/dev/null || return 0
  while read -r name _ value; do
    [[ $name =~ ^lib(blas|lapack)\.so && $value =~ /(blas|lapack)/lib(blas|lapack)\.so ]] || continue
    openblas=$(update-alternatives --list "$name" | grep -m 1 openblas) || continue
    say "$name is the slow reference library, selecting OpenBLAS"
    as_root update-alternatives --set "$name" "$openblas"
  done < <(update-alternatives --get-selections)
}

# Without apt the libraries must be installed already; CMake's own checks report missing ones.
require_libraries() {
  [[ -f $build/CMakeCache.txt ]] && return 0
  local trial log
  trial=$(mktemp -d)
  log=$trial/log
  if command -v cmake >/dev/null && cmake -S "$root" -B "$trial" >"$log" 2>&1; then
    rm -rf "$trial"
    return 0
  fi
  [[ -s $log ]] && awk '/^CMake Error/ { show = 8 } show-- > 0' "$log" >&2
  rm -rf "$trial"
  say "this is not a Debian system and something that slipstick needs is missing. Install the counterparts of"
  say "  ${packages[*]}"
  die "with your package manager (or run in a container: doc/platforms.md), then repeat"
}

setup() {
  if command -v dpkg-query >/dev/null && command -v apt-get >/dev/null; then
    install_packages "${packages[@]}"
    select_openblas
  else
    require_libraries
  fi
}

# Cores that this process may use: hardware threads of one core count once, as for mpirun; a container's CPU quota
# counts, OMP_NUM_THREADS (which nproc would obey) does not.
n_cores() {
  local cores physical quota period
  cores=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc)
  physical=$(lscpu --parse=Core,Socket 2>/dev/null | grep -v '^#' | sort -u | wc -l) || physical=0
  [[ $physical -gt 0 && $physical -lt $cores ]] && cores=$physical
  if read -r quota period 2>/dev/null </sys/fs/cgroup/cpu.max && [[ $quota != max && $((quota / period)) -lt $cores ]]; then
    cores=$((quota < period ? 1 : quota / period))
  fi
  echo "$cores"
}

# Compilers of deal.II code take up to 3 GB each.
n_jobs() {
  local jobs fit
  jobs=$(n_cores)
  fit=$(awk '/^MemAvailable:/ { print int($2 / 3000000) }' /proc/meminfo 2>/dev/null) || fit=
  [[ -n $fit && $fit -lt $jobs ]] && jobs=$fit
  [[ $jobs -ge 1 ]] || jobs=1
  echo "${SLIPSTICK_JOBS:-$jobs}"
}

# Copies standard input to the file LOG; on a terminal shows the counter "[12/85]" of the build.
progress() {
  local line
  while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ -t 2 && $line =~ ^\[[\ 0-9/%]+\] ]] && printf '\r  %s ' "${BASH_REMATCH[0]}" >&2
  done >"$1"
  [[ -t 2 ]] && printf '\r\033[K' >&2
  return 0
}

# logged SHOW LOG COMMAND...: runs COMMAND with its output in LOG; when it fails, function SHOW prints what matters.
logged() {
  local show=$1 log=$2 status=0 -
  set -o pipefail # here only
  shift 2
  LC_ALL=C "$@" 2>&1 | progress "$log" || status=${PIPESTATUS[0]}
  [[ $status -eq 0 ]] && return 0
  "$show" "$log" >&2 || true
  die "failed: $* (complete log: $log)"
}

cmake_errors() { awk '/^CMake Error/ { show = 12 } show-- > 0' "$1" | head -n 40; }

# The words of compiler, linker and CMake without the command lines; without errors in them (a killed compiler) the end.
build_errors() {
  local errors='(error:|undefined reference|^collect2:)'
  if grep -q '^CMake Error' "$1"; then
    cmake_errors "$1"
  elif grep -vE '^ninja: ' "$1" | grep -qE "$errors"; then
    grep -vE '^\[[0-9]+/[0-9]+\]|^ninja: |^FAILED: ' "$1" | grep -E -A 4 "$errors" | cut -c 1-400 | head -n 40
  else
    tail -n 20 "$1" | cut -c 1-400
  fi
}

# Files compiled at a time: the templates of deal.II and Eigen cost more than the files.
readonly batch_size=16

# build_target TARGET: Release build of TARGET in build/.
build_target() {
  mkdir -p "$build"
  local generator=()
  command -v ninja >/dev/null && generator=(-G Ninja)
  [[ -f $build/CMakeCache.txt ]] && generator=()
  if [[ ! -f $build/build.ninja && ! -f $build/Makefile ]] ||
    ! grep -qs '^CMAKE_BUILD_TYPE:[A-Z]*=Release$' "$build/CMakeCache.txt"; then
    say "configuring in $build"
    logged cmake_errors "$build/configure.log" \
      cmake -S "$root" -B "$build" "${generator[@]}" -D CMAKE_BUILD_TYPE=Release \
      -D CMAKE_UNITY_BUILD=ON -D CMAKE_UNITY_BUILD_BATCH_SIZE="$batch_size"
  fi
  say "building $1 (Release, $(n_jobs) jobs)"
  logged build_errors "$build/build.log" cmake --build "$build" --target "$1" --parallel "$(n_jobs)"
}
