#!/bin/sh
# The README's two commands on bare systems: minimal roots of Debian, made by debootstrap, without Python, make or OpenGL.
#
#   sh .ci/fresh.sh [12 | 13] [root | user]      both versions and both users unless named
#
# In each root the checkout (its committed state) is set up, the tunnel is played to its report, and a few tests of what
# depends on the system are run. It needs root, and a package mirror. The exit status is 69 where that cannot be had, 1
# where something failed. The log of a failure is printed.
set -eu

cd "$(dirname "$0")/.."
place=$(mktemp -d "${TMPDIR:-/tmp}/mimics-fresh.XXXXXX")
trap 'rm -rf "$place"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

say() { printf 'fresh: %s\n' "$*" >&2; }

# Tests that depend on the system's Python, Mesa and sound libraries.
tests='tests/unit/test_signal_sources.py tests/unit/test_system_packages.py tests/golden/test_pictures.py'

suite_of() {
    case $1 in 12) echo bookworm ;; 13) echo trixie ;; esac
}

# A root without the processes of this system: own mounts and process numbers, which end with the command.
inside() { # root, command ...
    root=$1
    shift
    # shellcheck disable=SC2016
    unshare --mount --pid --fork --kill-child sh -c '
        mount --rbind /dev "$1/dev" && mount -t proc proc "$1/proc" && mount -t tmpfs tmpfs "$1/dev/shm" || exit 69
        root=$1
        shift
        exec chroot "$root" env -i LANG=C.UTF-8 ${PIP_CERT:+PIP_CERT=/etc/network.crt} \
            PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"
    ' sh "$root" "$@" </dev/null
}

# What a network of its own needs: the names of its hosts, and the certificate that pip is to trust.
give_network() { # root
    cp /etc/resolv.conf "$1/etc/resolv.conf"
    [ -z "${PIP_CERT:-}" ] || cp "$PIP_CERT" "$1/etc/network.crt"
}

make_root() { # version, root
    debootstrap --variant=minbase "$(suite_of "$1")" "$2" >"$place/log" 2>&1 || {
        tail -n 5 "$place/log" >&2
        say "debootstrap could not make a root of Debian $1"
        exit 69
    }
    give_network "$2"
    chroot "$2" useradd --create-home person
    mkdir "$2/srv/mimics"
    git archive HEAD | tar -x -C "$2/srv/mimics"
}

as_person() { # root, command
    inside "$1" su --login --whitelist-environment=PIP_CERT person -c "cd /srv/mimics && $2"
}

as_root() { # root, command
    inside "$1" HOME=/root sh -c "cd /srv/mimics && $2"
}

# An ordinary user without sudo is given one line to type; an administrator types it, as often as one is given.
with_line() { # root, command of the user
    for _ in 1 2 3; do
        as_person "$1" "$2" >"$place/log" 2>&1 && return 0
        line=$(sed -n 's/^sudo \(apt-get .*\)/\1/p' "$place/log" | sed 's/&& sudo /\&\& /g' | tail -n 1)
        [ -n "$line" ] || return 1
        as_root "$1" "$line" >"$place/apt.log" 2>&1 || { cat "$place/apt.log" >>"$place/log"; return 1; }
    done
    return 1
}

by_root() { as_root "$@" >"$place/log" 2>&1; }

try() { # version, user
    root=$place/root
    case $2 in root) does=by_root ;; user) does=with_line ;; esac
    make_root "$1" "$root"
    [ "$2" = root ] || chroot "$root" chown -R person /srv/mimics
    begun=$(date +%s)
    for command in "sh .ci/dev.sh run --headless --seconds 5 --json" "sh .ci/dev.sh test -q $tests"; do
        say "Debian $1, as $2: $command"
        "$does" "$root" "$command" || {
            tail -n 40 "$place/log" >&2
            say "FAILED on Debian $1, as $2: $command"
            return 1
        }
        tail -n 1 "$place/log" | cut -c 1-150
    done
    say "Debian $1, as $2: passed in $(($(date +%s) - begun)) s"
    rm -rf "$root"
}

[ "$(id -u)" -eq 0 ] || { say "making a root needs root"; exit 69; }
for tool in debootstrap unshare git; do
    command -v $tool >/dev/null || { say "$tool is missing"; exit 69; }
done

versions='12 13'
users='root user'
for word in "$@"; do
    case $word in
        12 | 13) versions=$word ;;
        root | user) users=$word ;;
        *) say "sh .ci/fresh.sh [12 | 13] [root | user]"; exit 2 ;;
    esac
done
for version in $versions; do
    for user in $users; do try "$version" "$user" || exit 1; done
done
