# Sourced by the scripts beside it. Installs the packages that are missing, where it may; where it may
# not, says which to ask for. Needs nothing but Debian.

root=$(cd -P "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# missing_packages FILE ...: of those that the files list, one a line
missing_packages() {
  local package
  while read -r package; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || echo "$package"
  done < <(cat "$@")
}

# prepare [FILE ...]: packages.txt unless told
prepare() {
  local missing
  missing=$(missing_packages "${@:-$root/tools/packages.txt}")
  [ -z "$missing" ] && return
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if sudo -n true 2>/dev/null; then
      as_root=(sudo -n)
    else
      echo "These packages are missing, and this account may not install them. Ask for:" >&2
      echo "  apt-get install --no-install-recommends $(echo $missing)" >&2
      exit 1
    fi
  fi
  echo "Installing: $(echo $missing)" >&2
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
  # shellcheck disable=SC2086 -- one argument a package
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends $missing >/dev/null
}

# build PRESET [TARGET ...]
build() {
  local preset=$1
  shift
  (cd "$root" && cmake --preset "$preset" >"/tmp/sulcus-configure.$$" 2>&1) || {
    cat "/tmp/sulcus-configure.$$" >&2
    rm -f "/tmp/sulcus-configure.$$"
    return 1
  }
  rm -f "/tmp/sulcus-configure.$$"
  # Asked first, since it says "no work to do" before what is asked for.
  (cd "$root" && cmake --build --preset "$preset" ${1:+--target "$@"} -- -n) |
    grep -q '^ninja: no work to do' && return
  (cd "$root" && cmake --build --preset "$preset" ${1:+--target "$@"})
}
