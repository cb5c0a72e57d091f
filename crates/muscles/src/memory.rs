//! The memory that a process can still have, so that work which would not fit is refused before it begins: an
//! allocation that fails ends the process.

use std::fmt;
use std::fs;
use std::path::Path;

/// Bytes that stay for everything else: thread stacks, text, gaps.
const RESERVE: u64 = 16 << 20;
/// Fewer bytes come from the reserve, unchecked.
const LEAST: u64 = 1 << 20;

/// More memory is needed than the process can have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shortage {
    /// Bytes that are needed.
    pub needed: u64,
    /// Bytes that are left.
    pub left: u64,
    /// What limits them.
    pub limit: &'static str,
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { needed, left, limit } = self;
        let [needed, left] = [needed, left].map(|bytes| bytes.div_ceil(1 << 20));
        write!(f, "needs about {needed} MiB more memory, and {left} MiB are left ({limit})")
    }
}

impl std::error::Error for Shortage {}

/// Whether so many bytes can be had.
///
/// On Linux the limits are those of the address space (`ulimit -v`), of the control groups (as of a container
/// or a batch job), and of the machine; other systems aren't asked.
///
/// # Errors
/// [`Shortage`].
pub fn check(needed: u64) -> Result<(), Shortage> {
    if needed < LEAST {
        return Ok(());
    }
    match left(Path::new("/")) {
        Some((left, limit)) if left < needed => Err(Shortage { needed, left, limit }),
        _ => Ok(()),
    }
}

/// The bytes that are left, by the narrowest of the limits that are stated below a root folder.
fn left(root: &Path) -> Option<(u64, &'static str)> {
    let read = |name: &str| fs::read_to_string(root.join(name)).unwrap_or_default();
    let address_space = || {
        let limit = number(&read("proc/self/limits"), "Max address space", 1)?;
        Some(limit.saturating_sub(number(&read("proc/self/status"), "VmSize:", 1 << 10)?))
    };
    let machine = || {
        let text = read("proc/meminfo");
        Some(number(&text, "MemAvailable:", 1 << 10)? + number(&text, "SwapFree:", 1 << 10).unwrap_or(0))
    };
    let limits = [
        (address_space(), "address space, `ulimit -v`"),
        (groups(root, &read("proc/self/cgroup")), "control group"),
        (machine(), "machine"),
    ];
    let left = limits.into_iter().filter_map(|(left, limit)| Some((left?, limit))).min();
    left.map(|(left, limit)| (left.saturating_sub(RESERVE), limit))
}

/// The number behind a name at the beginning of a line.
fn number(text: &str, name: &str, unit: u64) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(unit)
}

/// The bytes left to the control groups of this process: each has those of its parents at most. Cached files
/// count as used, but make room.
fn groups(root: &Path, stated: &str) -> Option<u64> {
    let in_folder = |folder: &Path, [limit, used, cached]: [&str; 3]| {
        let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
        let whole = |name: &str| read(name)?.trim().parse::<u64>().ok();
        let cached = number(&read("memory.stat").unwrap_or_default(), cached, 1).unwrap_or(0);
        Some(whole(limit)?.saturating_sub(whole(used)?.saturating_sub(cached)))
    };
    let of_line = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?.trim_start_matches('/'));
        let (base, names) = match controllers {
            // Version 2 has one tree, version 1 one for each controller.
            "" => ("sys/fs/cgroup", ["memory.max", "memory.current", "inactive_file "]),
            _ if controllers.split(',').any(|name| name == "memory") => (
                "sys/fs/cgroup/memory",
                ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "],
            ),
            _ => return None,
        };
        // A container may see its own group as the root of the tree.
        Path::new(path).ancestors().filter_map(|group| in_folder(&root.join(base).join(group), names)).min()
    };
    stated.lines().filter_map(of_line).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIB: u64 = 1 << 30;

    fn system(name: &str, files: &[(&str, &str)]) -> Option<(u64, &'static str)> {
        let root = std::env::temp_dir().join(format!("bulge-memory-{name}-{}", std::process::id()));
        for (path, text) in files {
            let path = root.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let found = left(&root);
        let _ = fs::remove_dir_all(root);
        found
    }

    #[test]
    fn the_narrowest_limit_counts() {
        let machine =
            ("proc/meminfo", "MemTotal: 9 kB\nMemAvailable:    3145728 kB\nSwapFree:        1048576 kB\n");
        assert_eq!(system("none", &[]), None);
        assert_eq!(system("machine", &[machine]), Some((4 * GIB - RESERVE, "machine")));
        let limits = |stated: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units\n\
                 Max resident set          unlimited            unlimited            bytes\n\
                 Max address space         {stated} unlimited            bytes\n"
            )
        };
        let space = |stated: &str| {
            let limits = limits(stated);
            let files =
                [machine, ("proc/self/limits", &limits), ("proc/self/status", "VmSize:\t 524288 kB\n")];
            system("space", &files)
        };
        assert_eq!(space("unlimited"), Some((4 * GIB - RESERVE, "machine")));
        assert_eq!(space("1073741824"), Some((GIB / 2 - RESERVE, "address space, `ulimit -v`")));
        assert_eq!(space("1024"), Some((0, "address space, `ulimit -v`")));
    }

    #[test]
    fn control_groups_have_what_their_parents_leave() {
        let group = |path: &str, own: &str, parent: &str| {
            let stated = format!("0::{path}\n");
            let files = [
                ("proc/self/cgroup", stated.as_str()),
                ("sys/fs/cgroup/job/step/memory.max", own),
                ("sys/fs/cgroup/job/step/memory.current", "1073741824\n"),
                ("sys/fs/cgroup/job/step/memory.stat", "anon 5\ninactive_file 536870912\n"),
                ("sys/fs/cgroup/job/memory.max", parent),
                ("sys/fs/cgroup/job/memory.current", "1073741824\n"),
            ];
            system("groups", &files).map(|(left, _)| left + RESERVE)
        };
        assert_eq!(group("/job/step", "2147483648\n", "max\n"), Some(2 * GIB - GIB / 2));
        assert_eq!(group("/job/step", "max\n", "2147483648\n"), Some(GIB));
        assert_eq!(group("/job/step", "max\n", "max\n"), None);
        assert_eq!(group("/other", "2147483648\n", "2147483648\n"), None);
        let older = [
            ("proc/self/cgroup", "12:cpu,cpuacct:/x\n11:memory:/job\n"),
            ("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "2147483648\n"),
            ("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "1073741824\n"),
        ];
        assert_eq!(system("older", &older), Some((GIB - RESERVE, "control group")));
    }

    #[test]
    fn what_does_not_fit_is_told() {
        assert_eq!(check(LEAST - 1), Ok(()));
        let shortage = Shortage { needed: 3 * GIB, left: GIB / 2, limit: "machine" };
        assert_eq!(shortage.to_string(), "needs about 3072 MiB more memory, and 512 MiB are left (machine)");
        if cfg!(target_os = "linux") {
            assert_eq!(check(u64::MAX / 2).unwrap_err().needed, u64::MAX / 2);
        }
    }
}
