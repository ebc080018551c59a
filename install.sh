#!/bin/sh
# Make .venv beside this file, with fingertip in it. `sh install.sh all` adds what few need: Parquet, TDMS, bags of ROS,
# clusters and tables of pandas. `sh install.sh test` adds what the tests need. `sh install.sh core` leaves out what only
# STEP, trimesh meshes, plots, samplers and compiled loops need.
# Run again after a change of the dependencies; if there was none it ends in a second. PYTHON=python3.12 sh install.sh
# takes that Python for a new .venv.
set -eu
unset CDPATH
cd "$(dirname "$0")"

say() { echo "install: $1"; }
fail() {
    echo "install: $1" >&2
    exit 1
}

# Each of these levels holds those above it. The sizes are those of an empty .venv.
case "${1-}" in
    core) level=1 extras='' what='the core of fingertip' size='30 MB to fetch, 160 MB in .venv' ;;
    '') level=2 extras='[usual]' what='fingertip' size='0.5 GB to fetch, 1.8 GB in .venv' ;;
    all) level=3 extras='[all]' what='fingertip with every format' size='0.5 GB to fetch, 2.1 GB in .venv' ;;
    test) level=4 extras='[all,test]' what='fingertip and its tests' size='0.6 GB to fetch, 2.5 GB in .venv' ;;
    *) fail "the words it takes are 'core', 'all' and 'test'; not '$1'" ;;
esac

log=$(mktemp)
trap 'rm -f "$log"' EXIT
trap 'exit 1' HUP INT TERM

# What a command prints is shown only if the command fails.
quietly() { "$@" >"$log" 2>&1 </dev/null || { cat "$log" >&2; return 1; }; }

# System packages are installed only by root: a container has nobody to ask, a laptop's owner wants to be asked.
can_install() { [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; }
install_packages() {
    apt-get -q update || echo "apt-get update failed; trying with the lists at hand"
    DEBIAN_FRONTEND=noninteractive apt-get -q -y --no-install-recommends install "$@"
}

# --- .venv ---------------------------------------------------------------------------------------------------------
# Made anew if its Python is gone (an upgrade of the system) or if the folder was moved or copied (scripts in .venv
# name the place where they were made).
usable() {
    .venv/bin/python -m pip --version && grep -qF "$(pwd -P)/.venv/bin/python" .venv/bin/pip
} >/dev/null 2>&1

if ! usable; then
    python=
    for candidate in ${PYTHON-} python3 python3.11 python3.12 python3.13 python3.14; do
        if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            python=$candidate
            break
        fi
    done
    [ -n "$python" ] || fail "Python 3.11 or newer is needed; install it (Debian and Ubuntu: apt-get install python3 \
python3-venv, macOS: brew install python) and run this again."

    # Debian and Ubuntu ship Python without the part that puts pip into a venv.
    if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
        package=$("$python" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
        sentence="$python cannot make a venv; install what is missing (Debian and Ubuntu: apt-get install $package) \
and run this again."
        can_install || fail "$sentence"
        say "installing $package: $python cannot make a venv without it"
        quietly install_packages "$package" || fail "$sentence"
    fi
    say "making .venv with $("$python" --version)"
    quietly "$python" -m venv --clear .venv || fail "$python cannot make a venv."
fi

# --- fingertip -----------------------------------------------------------------------------------------------------
# First the packages that it needs, those that build it among them: the list up to the end of this level. pip compares
# each with the list's hashes, and takes no source archive, whose build would fetch packages that have none.
requirements() { sed "/^# end of ${1:-usual}\$/q" constraints-hashes.txt; }
choose_requirements() {
    target=$(.venv/bin/python -c 'import platform, sysconfig as s; print(s.get_config_var("SOABI"), platform.machine())')
    if grep -qxF "# covers $target" constraints-hashes.txt; then
        options='--require-hashes --only-binary=:all:'
        requirements "$@" >.venv/requirements.txt
    else
        say "constraints-hashes.txt does not cover this Python ($target): packages are installed without comparing hashes"
        options=
        requirements "$@" | sed '/--hash/d; s/ \\$//' >.venv/requirements.txt
    fi
}

# Python compiles what a command imports; all of it beforehand would take 0.13 GB.
#
# Then fingertip, editable: after a git pull the new code is there even if nobody runs this again, and the tests test
# the files one edits. Without an index, pip refuses if pyproject.toml asks for something that the list lacks.
install_all() {
    # shellcheck disable=SC2086 # several options
    quietly .venv/bin/python -m pip install -q --no-compile $options -r .venv/requirements.txt &&
        quietly .venv/bin/python -m pip uninstall -q -y fingertip && # its name to pip until November 2026
        quietly .venv/bin/python -m pip install -q --no-index --no-build-isolation -e ".$extras"
}

# Only a change of these files or of the version needs pip; what pip did last is noted in .venv.
done_with=$({ cat pyproject.toml constraints-hashes.txt; grep '^__version__ = ' src/fingertip/__init__.py; } | cksum)
noted=$(cat .venv/installed 2>/dev/null || true)
noted_level=0
case "$noted" in "$done_with "[1-4]) noted_level=${noted##* } ;; esac
if [ "$noted_level" -ge "$level" ]; then
    say "fingertip is installed in .venv"
else
    say "installing $what$([ -n "$noted" ] || echo ": some $size")"
    choose_requirements "$@"
    install_all || fail "pip failed, see above; run this again when its cause is gone."
    echo "$done_with $level" >.venv/installed
fi
if [ "$level" -eq 1 ]; then
    say "done; try .venv/bin/fingertip --help"
    exit
fi

# --- shared libraries ----------------------------------------------------------------------------------------------
# The wheels of Open CASCADE are built to draw on a screen and bring everything but these. Only STEP needs them.
libraries="libGL.so.1 libX11.so.6 libexpat.so.1"
packages="libgl1 libx11-6 libexpat1"
missing() {
    [ "$(uname -s)" = Linux ] || return 0
    # shellcheck disable=SC2086 # several names
    .venv/bin/python - $libraries <<'EOF'
import ctypes, sys

for name in sys.argv[1:]:
    try:
        ctypes.CDLL(name)
    except OSError:
        print(name)
EOF
}

if [ -n "$(missing)" ] && can_install; then
    say "installing $packages: STEP needs them"
    # shellcheck disable=SC2086 # several packages
    quietly install_packages $packages || true
fi
if [ -n "$(missing)" ]; then
    say "STEP needs $(missing | paste -s -d ' ' -) (Debian and Ubuntu: apt-get install $packages); STL, 3MF and \
everything else work without."
fi
say "done; try .venv/bin/fingertip --help"
