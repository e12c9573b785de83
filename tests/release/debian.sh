#!/usr/bin/env bash
# Both commands of the set-up in a bare Debian: `debian.sh SUITE [FOLDER]`, SUITE bookworm or trixie. Makes the root with debootstrap in
# FOLDER (a temporary one without it, which is removed at the end), copies the committed tree into it, and runs `./bootstrap test`
# and `./bootstrap run` there, as a newcomer would. Half an hour to an hour, 5 GB. Status 0 passed, 1 failed, 77 cannot tell.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

readonly mirror="${PELLUCID_DEBIAN_MIRROR:-http://deb.debian.org/debian}"

skip() {
  printf 'skipped: %s\n' "$*"
  exit 77
}

suite="${1:-}"
if [[ $# -gt 2 || ($suite != bookworm && $suite != trixie) ]]; then
  printf 'usage: %s bookworm|trixie [FOLDER]\n' "$0" >&2
  exit 2
fi
[[ $EUID -eq 0 ]] || skip "takes root, for chroot and mount"
for tool in debootstrap chroot mount git; do
  command -v "$tool" >/dev/null || skip "$tool is not installed"
done

if [[ $# -eq 2 ]]; then
  root="$2"
  mkdir -p "$root"
  made=no
else
  root="$(mktemp -d)"
  made=yes
fi
root="$(realpath "$root")"

# shellcheck disable=SC2317  # called by the trap
clean_up() {
  local mounted
  for mounted in proc dev; do
    if mountpoint -q "$root/$mounted"; then umount -l "$root/$mounted"; fi
  done
  # With something still mounted inside, a removal would reach out of the root.
  if [[ $made == yes ]] && ! grep -q " $root/" /proc/mounts; then rm -rf --one-file-system -- "$root"; fi
}
trap clean_up EXIT

if [[ ! -x $root/usr/bin/apt-get ]]; then
  debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$root.log" 2>&1 || {
    tail -n 5 "$root.log"
    skip "debootstrap cannot make a root of $suite from $mirror"
  }
  rm -f "$root.log"
fi
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc" || skip "cannot mount /proc in the root"
mountpoint -q "$root/dev" || mount --rbind /dev "$root/dev" || skip "cannot mount /dev in the root"
mount --make-rslave "$root/dev"
cp /etc/resolv.conf "$root/etc/resolv.conf"

rm -rf "$root/root/pellucid"
mkdir -p "$root/root/pellucid"
git archive HEAD | tar -x -C "$root/root/pellucid"
# Assets that are here already need not be fetched again.
if [[ -d assets ]]; then cp -rL assets "$root/root/pellucid/assets"; fi

status=0
for verb in test run; do
  if chroot "$root" env -i HOME=/root LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb \
    bash -c "cd /root/pellucid && ./bootstrap $verb" </dev/null; then
    printf '%s: ./bootstrap %s passes\n' "$suite" "$verb"
  else
    printf '%s: ./bootstrap %s FAILS\n' "$suite" "$verb"
    status=1
  fi
done
exit "$status"
