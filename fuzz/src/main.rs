//! The fuzzer: `bulge-fuzz FOLDER ...` as libFuzzer takes it, with the target in `BULGE_FUZZ_TARGET`.

#![no_main]

use bulge_fuzz::{TARGETS, Target, target};
use libfuzzer_sys::fuzz_target;
use std::sync::OnceLock;

fn wanted() -> &'static Target {
    static WANTED: OnceLock<&'static Target> = OnceLock::new();
    WANTED.get_or_init(|| {
        // libFuzzer's hook ends the program at any panic. Panics of libraries that Bulge catches are no failure; all
        // others reach the end of a run, where libFuzzer ends the program too.
        drop(std::panic::take_hook());
        let name = std::env::var("BULGE_FUZZ_TARGET").unwrap_or_default();
        target(&name).unwrap_or_else(|| {
            let names: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
            eprintln!("there is no target `{name}`: set BULGE_FUZZ_TARGET to one of {}", names.join(", "));
            std::process::exit(2);
        })
    })
}

fuzz_target!(|bytes: &[u8]| (wanted().run)(bytes));
