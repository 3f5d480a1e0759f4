# Sourced by demos/run, tests/run and tests/check: Debian packages and quiet builds.

oilskin_build_packages=(cmake ninja-build g++ pkg-config libeigen3-dev libfcl-dev libccd-dev liboctomap-dev libtbb-dev
  libbullet-dev nlohmann-json3-dev libcli11-dev libgtest-dev)
oilskin_test_packages=()
oilskin_check_packages=(clang-format clang-tidy doxygen python3)
oilskin_benchmark_packages=(libbenchmark-dev)
# For `oilskin mesh` and `surface` of scenes: files in glTF and OpenVDB. Without them these formats are refused.
oilskin_format_packages=(libtinygltf-dev libopenvdb-dev)
# For `oilskin view`. Without them the command is refused. xdotool is for its slow test alone.
oilskin_window_packages=(libglfw3-dev libimgui-dev libpng-dev libgl-dev libgl1-mesa-dri)
oilskin_window_test_packages=(xvfb xauth xdotool)
# For the plots of `demos/run study` and `demos/run validate`.
oilskin_plot_packages=(python3-matplotlib)
# For the slow test tests/farm alone.
oilskin_farm_packages=(slurmctld slurmd slurm-client slurm-wlm-basic-plugins munge python3)
# For `demos/run page`: the compiler for WebAssembly, and dpkg-source for the sources of Bullet and FCL.
oilskin_page_packages=(emscripten dpkg-dev python3)
# For the slow test tests/web alone: a browser, and the socket to drive it through.
oilskin_browser_packages=(chromium python3-websocket)
# xvfb-run needs xauth, and a renderer to draw with.
oilskin_picture_packages=(libvtk9-dev xvfb xauth libgl1-mesa-dri)

# Installs those of the named packages that are missing; says so first.
oilskin_install() {
  local missing=() package sudo=()
  command -v dpkg-query >/dev/null || {
    echo "This is no Debian: the packages cannot be looked up, going on with what is there." >&2
    return 0
  }
  for package in "$@"; do
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  echo "Installing missing packages: ${missing[*]}" >&2
  ((EUID == 0)) || sudo=(sudo)
  "${sudo[@]}" apt-get update -qq >&2 &&
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
}

# oilskin_build ROOT PRESET [TARGET…]: configures where needed and builds on all cores. The output goes to
# build/PRESET.log and is shown only when something fails.
oilskin_build() {
  local root=$1 preset=$2 log
  shift 2
  log=$root/build/$preset.log
  mkdir -p "$root/build"
  echo "Building ($preset), log in $log ..." >&2
  if ! (cd "$root" && cmake --preset "$preset" && cmake --build --preset "$preset" ${1:+--target "$@"}) >"$log" 2>&1; then
    tail -n 60 "$log" >&2
    echo "The build failed; the whole log is in $log" >&2
    return 1
  fi
}

# oilskin_build_with_vtk ROOT: the program that draws and stores frames, ROOT/build/release/demos/oilskin. For slow tests: the
# builds of tests have no VTK. 77 where VTK cannot be installed.
oilskin_build_with_vtk() {
  ((EUID == 0)) || command -v sudo >/dev/null || return 77
  oilskin_install "${oilskin_build_packages[@]}" "${oilskin_picture_packages[@]}" || return 77
  oilskin_build "$1" release oilskin-f32
}
