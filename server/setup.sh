# shellcheck shell=bash disable=SC2034,SC2154  # sourced: some names are set here and used there, or the other way round
# What server/run and tests/run share: the packages each needs, and how they are installed and built.
# Sourced by bash from the repository's root, with `script` set to the name to show. Says little: what apt, npm
# and cmake print goes to build/setup-*.log and is shown only when they fail.

build_packages=(g++ cmake ninja-build pkg-config python3-glad libegl1 libgl1-mesa-dri libwebsockets-dev
  nlohmann-json3-dev libstb-dev libglm-dev libeigen3-dev libcli11-dev libdeflate-dev libnats-dev)
test_packages=(catch2 zlib1g-dev prometheus nats-server glslang-tools)

say() { echo "$script: $*"; }
die() { echo "$script: error: $*" >&2; exit 1; }

# quietly LOG WHAT COMMAND...: runs the command, its output into build/setup-LOG.log; on failure shows the end of it.
quietly() {
  local log=build/setup-$1.log what=$2
  shift 2
  mkdir -p build
  "$@" >"$log" 2>&1 && return
  tail -n 30 "$log" >&2
  die "$what failed; the whole output is in $log"
}

installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

# Node is taken from wherever it is on the PATH (18 or newer), else from the distribution.
node_packages() {
  local major
  major=$(node --version 2>/dev/null | sed 's/^v//; s/\..*//') || true
  [ "${major:-0}" -ge 18 ] || echo nodejs
  command -v npm >/dev/null || echo npm
}

as_root() {
  if [ "$(id -u)" = 0 ]; then
    env DEBIAN_FRONTEND=noninteractive "$@"
  else
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  fi
}

# Known package lists may be missing or old: only then are they fetched again.
apt_install() {
  local install=(apt-get install -y --no-install-recommends -o DPkg::Lock::Timeout=120 "$@")
  as_root "${install[@]}" || { as_root apt-get update && as_root "${install[@]}"; }
}

# install_packages PACKAGE...: those not installed yet. CLOTHLAB_INSTALL=no leaves that to the user.
install_packages() {
  local missing=() package
  [ "${CLOTHLAB_INSTALL:-yes}" != no ] || return 0
  command -v dpkg-query >/dev/null || unknown_system "$@"
  for package in "$@"; do installed "$package" || missing+=("$package"); done
  [ ${#missing[@]} -gt 0 ] || return 0
  known_system || unknown_system "${missing[@]}"
  [ "$(id -u)" = 0 ] || command -v sudo >/dev/null ||
    die "these packages are missing, and installing them needs root or sudo: ${missing[*]}"
  say "installing ${missing[*]}"
  quietly apt "apt-get install" apt_install "${missing[@]}"
}

system_id() { (. /etc/os-release 2>/dev/null && echo "${ID:-unknown} ${VERSION_ID:-}"); }

known_system() {
  case $(system_id) in
    "debian 12" | "debian 13" | "ubuntu 24.04") ;;
    *) return 1 ;;
  esac
}

unknown_system() {
  die "this script installs packages on Debian 12, Debian 13 and Ubuntu 24.04, and this is $(system_id).
Install what Debian calls $*
and run CLOTHLAB_INSTALL=no $script"
}

# build_program PRESET CMAKE_OPTION... -- TARGET...: configures where that was not done yet, and builds.
build_program() {
  local preset=$1 options=() tree
  shift
  while [ "$1" != -- ]; do options+=("$1"); shift; done
  shift
  tree=build/$preset
  # A tree that was copied here from another folder is configured afresh.
  if ! { [ -f "$tree/build.ninja" ] && grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" "$tree/CMakeCache.txt"; }; then
    if command -v ccache >/dev/null; then
      options+=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    fi
    say "building $tree (a few minutes the first time)"
    quietly cmake "cmake" cmake --preset "$preset" --fresh "${options[@]}"
  fi
  quietly build "the build" cmake --build "$tree" -j "$(nproc)" --target "$@"
}

# npm_install FOLDER: `npm ci` where package-lock.json is not the one that was installed last.
npm_install() {
  local stamp=$1/node_modules/.installed-from
  cmp -s "$1/package-lock.json" "$stamp" && return
  say "installing the npm packages of $1/"
  quietly npm "npm ci in $1/" npm --prefix "$1" ci --no-audit --no-fund
  cp "$1/package-lock.json" "$stamp"
}

# The page, when any of its sources is not what it was built from.
build_page() {
  local stamp=build/page.stamp sources
  npm_install web
  sources=$(find web -path web/node_modules -prune -o -path web/dist -prune -o -path web/pictures -prune -o -type f -print0 |
    LC_ALL=C sort -z | xargs -0 sha256sum)
  [ -f web/dist/index.html ] && [ "$sources" = "$(cat "$stamp" 2>/dev/null)" ] && return
  say "building the page"
  quietly page "the build of web/" npm --prefix web run build
  echo "$sources" >"$stamp"
}
