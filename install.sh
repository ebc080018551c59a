#!/bin/sh
# Make .venv beside this file, with fingertip in it. `sh install.sh all` adds what few need: Parquet, TDMS, bags of ROS,
# clusters and tables of pandas. `sh install.sh test` adds what the tests need. `sh install.sh core` leaves out what only
# STEP, trimesh meshes, plots, samplers and compiled loops need.
# Run again after a change of the dependencies; if there was none it ends in a second. Where uv is installed it does the
# work of pip, in less time. PYTHON=python3.12 sh install.sh takes that Python for a new .venv.
set -eu
unset CDPATH
cd -P "$(dirname "$0")"

say() { echo "install: $1"; }
fail() {
    echo "install: $1" >&2
    exit 1
}

# Each of these levels holds those above it. The sizes are those of an empty .venv.
case "${1-}" in
    core) level=1 list=core extras='' what='the core of fingertip' size='30 MB to fetch, 160 MB in .venv' ;;
    '') level=2 list=usual extras='[usual]' what='fingertip' size='0.5 GB to fetch, 1.8 GB in .venv' ;;
    all) level=3 list=all extras='[all]' what='fingertip with every format' size='0.5 GB to fetch, 2.1 GB in .venv' ;;
    test) level=4 list=test extras='[all,test]' what='fingertip and its tests' size='0.6 GB to fetch, 2.5 GB in .venv' ;;
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
# Unusable if its Python is gone (an upgrade of the system) or if the folder was moved or copied: scripts in .venv name
# the place where they were made, and so does this file of Python's.
usable() { .venv/bin/python -c '' && grep -qF " $PWD/.venv" .venv/pyvenv.cfg; } >/dev/null 2>&1

find_python() {
    for candidate in ${PYTHON-} python3 python3.11 python3.12 python3.13 python3.14; do
        if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            echo "$candidate"
            return
        fi
    done
    fail "Python 3.11 or newer is needed; install it (Debian and Ubuntu: apt-get install python3 python3-venv, \
macOS: brew install python) and run this again."
}

# uv takes pip's words, and needs no pip in .venv.
has_uv() { uv --version; } >/dev/null 2>&1
has_pip() { .venv/bin/python -m pip --version; } >/dev/null 2>&1
pip() {
    if has_uv; then
        quietly uv pip "$@" --python .venv/bin/python
    else
        quietly .venv/bin/python -m pip "$@"
    fi
}

# Debian and Ubuntu ship Python without the part that puts pip into a venv.
need_ensurepip() { # PYTHON
    if "$1" -c 'import ensurepip' 2>/dev/null; then return; fi
    package=$("$1" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
    sentence="$1 cannot put pip into a venv; install what is missing (Debian and Ubuntu: apt-get install $package) \
and run this again."
    can_install || fail "$sentence"
    say "installing $package: $1 cannot put pip into a venv without it"
    quietly install_packages "$package" || fail "$sentence"
}

make_venv() {
    python=$(find_python)
    has_uv || need_ensurepip "$python"
    say "making .venv with $("$python" --version)"
    if [ -L .venv ]; then rm .venv; fi # what it leads to is not of this folder
    quietly "$python" -m venv --clear --without-pip .venv || fail "$python cannot make a venv."
}

add_pip() {
    need_ensurepip .venv/bin/python
    quietly .venv/bin/python -m ensurepip --default-pip || fail "this Python cannot put pip into a venv."
}

# --- fingertip -----------------------------------------------------------------------------------------------------
# First the packages that it needs, those that build it among them. Each is compared with the hashes of the list, and no
# source archive is taken, whose build would fetch packages that have none.
#
# Then fingertip, editable: after a git pull the new code is there even if nobody runs this again, and the tests test
# the files one edits. Without an index, this refuses if pyproject.toml asks for something that the list lacks.
#
# Python compiles what a command imports; all of it beforehand would take 0.13 GB.
install_packages_of_level() {
    pip install -q --no-compile --require-hashes --only-binary :all: -r "requirements/$list.txt" &&
        pip uninstall -q -y fingertip && # its name to pip until November 2026
        pip install -q --no-index --no-build-isolation -e ".$extras"
}

install_all() {
    say "installing $what$([ -n "$noted" ] || echo ": some $size")"
    has_uv || has_pip || add_pip
    install_packages_of_level || fail "$(has_uv && echo uv || echo pip) failed, see above; run this again when its cause is gone."
}

# Only a change of these files or of the version needs an installation. What was installed last is noted in .venv, but
# the program must answer, too: the note does not know what was deleted.
usable || make_venv
done_with=$({ cat pyproject.toml requirements/*.txt; grep '^__version__ = ' src/fingertip/__init__.py; } | cksum)
noted=$(cat .venv/installed 2>/dev/null || true)
noted_level=0
case "$noted" in "$done_with "[1-4]) noted_level=${noted##* } ;; esac
if [ "$noted_level" -ge "$level" ] && version=$(.venv/bin/fingertip --version 2>/dev/null); then
    say "fingertip $version is installed in .venv"
else
    install_all
    if ! .venv/bin/fingertip --version >/dev/null 2>&1; then
        say "fingertip does not answer: files of .venv are missing or damaged"
        make_venv
        install_all
        quietly .venv/bin/fingertip --version || fail "fingertip does not answer, see above: files of this folder are \
damaged; unpack or clone it again."
    fi
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
