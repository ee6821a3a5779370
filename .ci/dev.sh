#!/bin/sh
# The targets of the Makefile, for any machine with a POSIX shell:
#
#   sh .ci/dev.sh run [arguments of mimics run]      install what is missing, then run the wavy tunnel
#   sh .ci/dev.sh setup | test | test-long | nightly | planted | check | bench | docs | package | fresh | clean | pins
#
# It is never interactive. Python packages are installed into .venv, pinned and verified by hash: those of requirements.txt to
# run, those of requirements-test.txt besides to test. System packages are installed by apt if this user is root or may use sudo without a password; otherwise the command is printed.
# All its own messages go to stderr, so that `run --json` leaves one object on stdout.
#   PYTHON=/path/to/python3     interpreter for .venv
#   MIMICS_SKIP_SYSTEM=1        continue without missing system packages
set -eu

cd "$(dirname "$0")/.."
root=$(pwd -P)
venv=$root/.venv
vpython=$venv/bin/python
log=$root/.setup.log
needs=mimics_app/app/installation/system_packages.py
oldest='(3, 11)'
newest='(3, 14)'

# Settings of other tools (ROS, a user-wide pip.conf) must not affect this environment. Without byte code on
# disk every start would compile six hundred modules again: half a second of processor time.
unset PYTHONPATH PYTHONHOME PYTHONDONTWRITEBYTECODE
export PIP_USER=0 PIP_NO_INPUT=1 PIP_DISABLE_PIP_VERSION_CHECK=1 UV_COMPILE_BYTECODE=1 UV_SYSTEM_CERTS=1 UV_NATIVE_TLS=1

say() { printf 'mimics: %s\n' "$*" >&2; }
have() { command -v "$1" >/dev/null 2>&1; }
have_uv() { uv --version >/dev/null 2>&1; }

# --- system packages ---------------------------------------------------------------------------------------------

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo -n "$@"; fi
}

may_install() {
    have apt-get || return 1
    [ "$(id -u)" -eq 0 ] || { have sudo && sudo -n true 2>/dev/null; }
}

apt() { # fd 9 is the lock: a daemon that a package starts must not inherit it
    as_root env DEBIAN_FRONTEND=noninteractive NEEDRESTART_SUSPEND=1 apt-get -o DPkg::Lock::Timeout=120 "$@" \
        </dev/null >>"$log" 2>&1 9>&-
}

apt_updated=no
apt_install() { # --no-remove: a desktop's sound server may conflict with a package and must stay
    say "installing by apt: $* (log: .setup.log)"
    apt install -y --no-install-recommends --no-remove "$@" && return 0
    if [ $apt_updated = no ]; then
        apt_updated=yes
        apt update || :
        apt install -y --no-install-recommends --no-remove "$@" && return 0
    fi
    return 1
}

# Optional packages are requested once in the life of a .venv.
apt_install_once() {
    asked=$venv/.$1-asked
    [ ! -e "$asked" ] && [ -w "$venv" ] && may_install || return 0
    wanted=$("$vpython" $needs "$1")
    # shellcheck disable=SC2086
    [ -z "$wanted" ] || apt_install $wanted || say "not to be had here: $wanted (not needed)"
    touch "$asked"
}

line_to_type() {
    if have apt-get; then
        update=
        ls /var/lib/apt/lists/*_Packages* >/dev/null 2>&1 || update='sudo apt-get update && '
        say "type this one line, then the same command again:"
        printf '%ssudo apt-get install -y %s\n' "$update" "$*" >&2
    else
        say "missing here; install these packages (Debian names) by your package manager: $*"
    fi
}

# All required packages, for use without a Python that could determine the missing ones.
all_packages() {
    tr '\n' ' ' <$needs | sed 's/SystemNeed(/\n/g' | grep -v 'optional"' | sed -n 's/^ *"\([a-z0-9.-]*\)", *".*/\1/p' |
        tr '\n' ' '
}

system_packages() {
    [ "$(uname)" = Linux ] && [ -z "${MIMICS_SKIP_SYSTEM:-}" ] || return 0
    missing=$("$vpython" $needs "$@")
    apt_install_once optional
    case " $* " in *" test "*) apt_install_once test-optional ;; esac
    [ -n "$missing" ] || return 0
    # shellcheck disable=SC2086
    if may_install && apt_install $missing; then missing=$("$vpython" $needs "$@"); fi
    [ -n "$missing" ] || return 0
    line_to_type "$missing"
    say "(or MIMICS_SKIP_SYSTEM=1 to continue without)"
    exit 69
}

# Peers from PyPI (pyproject.toml, dependency group "peers"); unavailable ones are not measured.
peers_of_pypi() {
    peers=$("$vpython" -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["dependency-groups"]["peers"])')
    # shellcheck disable=SC2086
    "$vpython" -m pip install --quiet --disable-pip-version-check --only-binary :all: $peers ||
        say "rivals of PyPI ($peers) cannot be installed: what is missing is not measured"
}

# Wheel and sdist, the same bytes whenever and wherever they are built, and the bill of materials (CycloneDX) of what
# running installs, with versions and hashes from requirements.txt.
package() {
    SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null || printf 1580601600)
    export SOURCE_DATE_EPOCH
    rm -rf dist build/sbom
    "$vpython" -m hatchling build -t sdist -t wheel -d dist
    writer=$("$vpython" -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["dependency-groups"]["sbom"])')
    "$vpython" -m venv build/sbom
    # shellcheck disable=SC2086
    build/sbom/bin/pip install --quiet --disable-pip-version-check --only-binary :all: $writer >&2 ||
        { say "$writer cannot be installed: dist has no bill of materials"; exit 69; }
    build/sbom/bin/cyclonedx-py requirements requirements.txt --pyproject pyproject.toml --output-reproducible \
        --output-file dist/sbom.json
    (cd dist && sha256sum -- *)
}

# The pages as a website (the extra "docs"). Links between them are relative to the checkout, so it is mirrored.
docs() {
    builder=$("$vpython" -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]["docs"])')
    # shellcheck disable=SC2086
    "$vpython" -m pip install --quiet --disable-pip-version-check --only-binary :all: $builder >&2 ||
        { say "$builder cannot be installed; the pages can be read as they are, in docs/"; exit 69; }
    rm -rf build/pages build/site
    mkdir -p build/pages/assets
    for page in README.md CONTRIBUTING.md SECURITY.md CHANGELOG.md LICENSE CITATION.cff docs; do ln -s "$root/$page" build/pages/; done
    ln -s "$root/assets/pictures" build/pages/assets/
    ln -s "$root/.ci/docs.css" build/pages/
    "$vpython" .ci/reference.py build/pages/reference
    NO_MKDOCS_2_WARNING=1 "$venv/bin/mkdocs" build --quiet --config-file .ci/mkdocs.yml "$@"
    printf '%s\n' "$root/build/site/index.html"
}

# --- Python ------------------------------------------------------------------------------------------------------

suits() { # supported by the pinned wheels, and built with ctypes and ssl
    "$1" -c "import sys, ctypes, ssl; sys.exit(not $oldest <= sys.version_info[:2] <= $newest)" >/dev/null 2>&1
}

find_python() {
    for python in ${PYTHON:+"$PYTHON"} python3 python3.14 python3.13 python3.12 python3.11 /usr/bin/python3; do
        if suits "$python"; then return 0; fi
    done
    python=
    return 1
}

ensure_python() {
    find_python && return 0
    have_uv && return 0 # uv brings an interpreter of its own
    if may_install; then
        apt_install python3 python3-venv && find_python && return 0
        apt_install python3.11 python3.11-venv && find_python && return 0
    fi
    say "Python 3.11 to 3.14 is needed"
    line_to_type "python3 python3-venv $(all_packages)"
    exit 69
}

ensure_venv_module() {
    "$python" -c 'import ensurepip, venv' 2>/dev/null && return 0
    version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    if may_install; then
        if apt_install "python$version-venv" || apt_install python3-venv; then
            "$python" -c 'import ensurepip, venv' 2>/dev/null && return 0
        fi
    fi
    say "$python cannot make virtual environments"
    # shellcheck disable=SC2086
    line_to_type "python$version-venv $("$python" $needs $kinds)"
    exit 69
}

# PyOpenAL is a source package: the pinned setuptools must be installed before it.
build_requirements() {
    awk '/^setuptools==/ { take = 1 } take { print } take && !/\\$/ { exit }' requirements.txt >"$venv/build-requirements.txt"
    printf '%s\n' "$venv/build-requirements.txt"
}

# The files of pins that a command needs: what runs, and what tests need besides.
pins_of() {
    case " $1 " in
        *" test "*) printf 'requirements.txt requirements-test.txt\n' ;;
        *) printf 'requirements.txt\n' ;;
    esac
}

install_into_venv() { # the command of an installer: uv pip install ..., or python -m pip install ...
    "$@" --require-hashes -r "$(build_requirements)" || return 1
    for pins in $(pins_of "$kinds"); do set -- "$@" -r "$pins"; done
    "$@" --require-hashes --no-build-isolation || return 1
}

with_uv() {
    have_uv || return 1
    [ -x "$vpython" ] || uv venv --quiet --seed --python "${python:-$(uv_range)}" "$venv" || return 1
    install_into_venv uv pip install --python "$vpython" &&
        uv pip install --python "$vpython" --no-deps --no-build-isolation -e .
}

uv_range() { printf '>=3.11,<3.15'; }

with_pip() {
    if ! "$vpython" -m pip --version >/dev/null 2>&1; then
        ensure_venv_module
        rm -rf "$venv"
        "$python" -m venv "$venv" || return 1
    fi
    trust_system_certificates
    install_into_venv "$vpython" -m pip install &&
        "$vpython" -m pip install --no-deps --no-build-isolation -e .
}

# A hospital's network may present a certificate that the system trusts and pip's own list does not.
trust_system_certificates() {
    certificates=/etc/ssl/certs/ca-certificates.crt
    [ -z "${PIP_CERT:-}" ] && [ -r $certificates ] || return 0
    "$vpython" -m pip config get global.cert >/dev/null 2>&1 || export PIP_CERT=$certificates
}

# Includes the folder's path: scripts and the editable install of a moved folder point to the old place.
identity() {
    printf '%s ' "$venv"
    "$vpython" -c 'import platform, sys; print(sys.implementation.cache_tag, platform.machine())' 2>/dev/null
}

content() { # of the kinds
    # shellcheck disable=SC2046
    cat pyproject.toml $(pins_of "$1") | { sha256sum 2>/dev/null || shasum -a 256; }
}

# One mark for what runs and one for what tests need besides: changed pins of the tests leave `make run` as it is.
mark_of() {
    case " $1 " in *" test "*) printf '%s\n' "$venv/.mimics-test-ready" ;; *) printf '%s\n' "$venv/.mimics-ready" ;; esac
}

ready() { # for the kinds
    mark=$(mark_of "$1")
    [ -x "$vpython" ] && [ -f "$mark" ] && [ "$(cat "$mark")" = "$(identity && content "$1")" ]
}

same_place() {
    for mark in "$venv/.mimics-ready" "$venv/.mimics-test-ready"; do
        [ -x "$vpython" ] && [ -f "$mark" ] && [ "$(head -n 1 "$mark")" = "$(identity)" ] && return 0
    done
    return 1
}

build() {
    size=180
    case " $kinds " in *" test "*) size=290 ;; esac
    say "setting up .venv (about $size MB to download the first time)"
    same_place || rm -rf "$venv"
    ensure_python
    if ! with_uv; then
        ! have_uv || say "uv failed; trying venv and pip"
        [ -n "$python" ] || { say "Python 3.11 to 3.14 is needed"; exit 69; }
        with_pip || { say "the packages could not be installed; check the network. The reason is printed above."; exit 69; }
    fi
    for each in run "$kinds"; do
        mark=$(mark_of "$each")
        { identity && content "$each"; } >"$mark.new"
        mv "$mark.new" "$mark"
    done
    say "ready"
}

lock() {
    if ! { [ -w "$root" ] && { [ ! -e .venv.lock ] || [ -w .venv.lock ]; }; }; then
        say "this folder or its .venv.lock is not writable for $(id -un): $root"
        exit 73
    fi
    exec 9>.venv.lock
    have flock || return 0
    flock -n 9 && return 0
    say "another set-up is running here; waiting for it"
    flock 9
}

prepare() { # the kinds of system packages this command needs: run, test
    kinds=$*
    if ! ready "$kinds"; then
        lock
        ready "$kinds" || build 1>&2
        exec 9>&-
    fi
    system_packages "$@"
}

# A file of tests stays in one process: its fixtures are made once. Three processes on two processors, because one of them
# usually waits for a window, a robot or a second of sound. Files are in the order of tests/conftest.py, the longest first.
# Skipped tests are listed with their reason.
pytest_beside() { "$vpython" -m pytest --numprocesses=3 --dist=loadfile --no-loadscope-reorder -rfEs "$@"; }

# --- pins --------------------------------------------------------------------------------------------------------

compile_pins() { # file of pins, options: the newest versions that suit every Python of the README
    uv pip compile --quiet --universal --python-version 3.11 --fork-strategy fewest --group build --upgrade \
        --generate-hashes --no-header --no-annotate --no-emit-index-url --no-emit-find-links \
        "$@" pyproject.toml >/dev/null
}

# Pins of one file, without those of another: a package stands in one of them only.
without() {
    awk 'FNR == 1 { file++ } /^[A-Za-z0-9]/ { split($1, name, "=="); taken = name[1] }
        file == 1 { of_other[taken] = 1; next } !(taken in of_other)' "$2" "$1"
}

# PyOpenAL exists as source only, and needs no compiler.
every_python_has_wheels() {
    for version in 3.11 3.12 3.13 3.14; do
        uv pip install --quiet --dry-run --target build/wheels-of-pins --python-version $version --only-binary :all: \
            --no-binary pyopenal --require-hashes -r requirements.txt -r requirements-test.txt || return 1
    done
}

pins() {
    for name in requirements requirements-test; do sed -n '/^#/p' $name.txt >$name.head; done
    compile_pins --output-file requirements.new
    compile_pins --group test --constraint requirements.new --output-file requirements-test.all
    without requirements-test.all requirements.new >requirements-test.new
    for name in requirements requirements-test; do cat $name.head $name.new >$name.txt; done
    rm requirements.head requirements.new requirements-test.head requirements-test.new requirements-test.all
    every_python_has_wheels || { say "a pin has no wheel for one of the Pythons that the README promises"; exit 65; }
}

# --- commands ----------------------------------------------------------------------------------------------------

# mypy works on one processor, so it begins before everything else, in the background.
check() {
    failed=
    types=$(mktemp)
    "$venv/bin/mypy" >"$types" 2>&1 &
    mypy=$!
    trap 'kill "$mypy" 2>/dev/null || :; rm -f "$types"' EXIT
    trap 'exit 130' INT
    step() {
        name=$1
        shift
        printf -- '--- %s\n' "$name"
        "$@" || failed="$failed $name"
    }
    step ruff "$venv/bin/ruff" check .
    step format "$venv/bin/ruff" format --check .
    step imports "$venv/bin/lint-imports"
    step tests pytest_beside --numprocesses=2 -q -m "not slow and not seconds and not hardware and not gpu" tests/unit tests/architecture tests/properties
    step mypy verdict_on_types
    [ -z "$failed" ] || { say "red:$failed"; exit 1; }
    say "all green"
}

verdict_on_types() {
    right=0
    wait "$mypy" || right=$?
    cat "$types"
    return $right
}

word=${1:-}
[ $# -eq 0 ] || shift
case $word in
    setup)
        prepare run
        [ ! -f mimics_app/app/commands/warmup.py ] || exec "$venv/bin/mimics" warmup "$@"
        ;;
    run)
        prepare run
        exec "$venv/bin/mimics" run scenes/wavy_tunnel.json "$@"
        ;;
    test)
        prepare run test
        pytest_beside -m "not slow and not hardware and not gpu" "$@"
        ;;
    test-long)
        prepare run test
        pytest_beside --hypothesis-profile=random "$@"
        ;;
    planted) # a line of the product changed at a time: the named test has to turn red
        prepare run test
        exec "$vpython" -m tests.planted "$@"
        ;;
    nightly) # property tests only, many new examples of each; failing ones are kept in tests/properties/found
        prepare run test
        # shellcheck disable=SC2046
        pytest_beside --hypothesis-profile=nightly -m "not hardware and not gpu" "$@" \
            $(grep -l --recursive --include='test_*.py' '^from hypothesis import' tests)
        ;;
    check)
        prepare run test
        check
        ;;
    bench)
        prepare run
        peers_of_pypi
        exec "$venv/bin/mimics" bench all "$@"
        ;;
    docs)
        prepare run
        docs "$@"
        ;;
    package)
        prepare run
        package
        ;;
    clean) # never runs/: that is data
        lock
        rm -rf "$venv" build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache .setup.log
        find . -name runs -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +
        ;;
    fresh)
        exec sh .ci/fresh.sh "$@"
        ;;
    pins)
        have_uv || { say "pins need uv"; exit 69; }
        pins
        ;;
    *)
        say "sh .ci/dev.sh setup | run | test | test-long | nightly | planted | check | bench | docs | fresh | clean | pins"
        exit 2
        ;;
esac
