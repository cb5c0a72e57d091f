//! Faults of a disk, for tests from outside: with `BULGE_FAIL_WRITE=3` the third change of files that a process
//! makes fails as on a full disk, with `BULGE_FAIL_WRITE=3..` all from the third on. A change is one call that
//! creates, writes, forces to the disk, renames, or removes. Optimised builds have no faults.

use std::fs::File;
use std::io::{self, Write};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// The variable of the environment that states the fault.
const VARIABLE: &str = "BULGE_FAIL_WRITE";

/// Fails if the next change is to fail.
pub(super) fn check() -> io::Result<()> {
    if cfg!(debug_assertions) && is_due() { Err(io::ErrorKind::StorageFull.into()) } else { Ok(()) }
}

/// Writes bytes. If that is to fail, half of them are written, as a disk does that gets full.
pub(super) fn write(file: &mut File, bytes: &[u8]) -> io::Result<()> {
    let fault = check();
    file.write_all(if fault.is_ok() { bytes } else { &bytes[..bytes.len() / 2] })?;
    fault
}

/// Counts a change, and tells whether it is one of those that fail.
fn is_due() -> bool {
    static FIRST: LazyLock<Option<(u64, bool)>> = LazyLock::new(|| {
        let stated = std::env::var(VARIABLE).ok()?;
        let first = stated.strip_suffix("..");
        Some((first.unwrap_or(&stated).parse().ok()?, first.is_some()))
    });
    static COUNT: AtomicU64 = AtomicU64::new(1);
    FIRST.is_some_and(|(first, and_all_after)| {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        count == first || and_all_after && count > first
    })
}
