//! A program without std and without an allocator that looks up the force of a pleated muscle. Its exit code
//! is 0 if the force is right.
//!
//! ```text
//! cargo build --release --manifest-path crates/table/bare/Cargo.toml --target-dir target/bare
//! target/bare/release/bulge-table-bare; echo $?     0: right, 1: another force, 2: no lookup
//! crates/table/bare/check.sh                        builds, runs, searches the program for std and alloc, and tries microcontrollers
//! ```
//!
//! The C runtime calls `main`, so the program runs on a PC. On a microcontroller the start-up code would call
//! `main`, and nothing else would change. The table is part of the program, in flash on a microcontroller.
#![no_std]
#![no_main]

use core::panic::PanicInfo;

use bulge_table::Table;

// Links the C runtime, whose start-up code calls `main`: without std nothing else links it.
// SAFETY: nothing is declared, so nothing can be declared wrongly.
#[expect(unsafe_code, reason = "proof above")]
#[link(name = "c")]
unsafe extern "C" {}

static TABLE: &[u8] = include_bytes!("../../examples/data/ppam.table");

/// sin(2 pi/n) n/(2 pi) of n = 40 fibres.
const FIBRES: f64 = 0.995_892_735_243_561_5;
/// Pressure \[Pa\].
const PRESSURE: f64 = 1e5;
/// Length \[m\].
const LENGTH: f64 = 0.11;

/// The force in N of a muscle of 110 mm with a radius of 16 mm at 1 bar and 20 %.
fn force() -> Option<f64> {
    let lookup = Table::from_bytes(TABLE).ok()?.lookup::<2, 2>().ok()?;
    // Hides the point from the optimiser: the lookup must not happen at compile time.
    let [force, _volume] = lookup.at(core::hint::black_box([0.2, 110.0 / 16.0]))?;
    Some(PRESSURE * LENGTH * LENGTH * FIBRES * force.value)
}

/// 0 if the force is 544.0 N.
// SAFETY: `no_mangle` is unsafe because two functions of one name may clash in the linker, or because a foreign caller may expect another type.
// `main` is the one entry that the C standard reserves for the program: no library may define it, std would but isn't linked (`no_main`), and no
// other crate of this program has one. The C runtime calls it as `int main(int, char **, char **)`; with the C calling convention a function
// may ignore its arguments, and `i32` is C's `int` on every target that has such a runtime. It neither unwinds (panic = "abort") nor
// touches any state.
#[expect(unsafe_code, reason = "proof above")]
#[unsafe(no_mangle)]
pub extern "C" fn main() -> i32 {
    match force() {
        Some(force) if (543.95..544.05).contains(&force) => 0,
        Some(_) => 1,
        None => 2,
    }
}

/// No output exists for a message: the program loops here until `check.sh` ends it.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
