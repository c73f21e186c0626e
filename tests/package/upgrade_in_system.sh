#!/usr/bin/env bash
# In the bare system: the configuration through upgrades, then removal and purge.
# shellcheck source=tests/package/checks_in_system.sh
. "$(dirname "$0")/checks_in_system.sh"
packages=$(dirname "$0")
config=/etc/pelorus/pelorus.yaml
sed -i 's,^  path: "".*,  path: /data/my_dive,' $config
check "an upgrade keeps the edited configuration without a question" bash -c "
  dpkg -i $packages/second.deb </dev/null && grep -q /data/my_dive $config && [ -z \"\$(ls $config.dpkg-* 2>/dev/null)\" ]"
check "one that brings a new configuration keeps it too and lays the new one beside it" bash -c "
  dpkg --force-confold -i $packages/third.deb </dev/null &&
  grep -q /data/my_dive $config && grep -q 'Pairs come in here' $config.dpkg-dist"
check "remove takes the programs and keeps the configuration" bash -c "
  dpkg -r pelorus-dev pelorus && [ ! -e /usr/bin/pelorus ] && [ ! -e /usr/lib/systemd/system/pelorusd.service ] && grep -q /data/my_dive $config"
check "installed again, the configuration is the edited one" bash -c "
  dpkg --force-confold -i $packages/third.deb </dev/null && grep -q /data/my_dive $config"
check "purge" dpkg -P pelorus
check "the account stays, for files it may own elsewhere" id pelorus
check "an unedited configuration is replaced by the new one" bash -c "
  dpkg -i $packages/second.deb && dpkg -i $packages/third.deb </dev/null && grep -q 'Pairs come in here' $config && dpkg -P pelorus"
exit $failed
