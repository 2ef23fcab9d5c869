//! How much memory this machine has for stages.

use std::fs;

/// Memory of this machine, or of the control group in which this process is, in MiB; `None`
/// where the system does not tell.
pub(crate) fn of_this_machine() -> Option<u64> {
    let machine = fs::read_to_string("/proc/meminfo").ok();
    let machine = machine.as_deref().and_then(total).map(|kib| kib / 1024);
    let group = fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let group = group.and_then(|text| text.trim().parse::<u64>().ok());
    machine.into_iter().chain(group.map(|bytes| bytes >> 20)).min()
}

/// `MemTotal` in KiB.
fn total(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|l| l.strip_prefix("MemTotal:"))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_total_is_read_in_kibibytes() {
        let text = "MemFree:   12 kB\nMemTotal:       16384000 kB\nSwapTotal: 0 kB\n";
        assert_eq!(total(text), Some(16_384_000));
        assert_eq!(total("MemTotal: many"), None);
        #[cfg(target_os = "linux")]
        assert!(of_this_machine().is_some_and(|mib| mib > 64));
    }
}
