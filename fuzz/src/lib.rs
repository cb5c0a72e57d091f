//! What is fuzzed: each target takes any bytes, and panics if something is wrong with what Bulge makes of them.
//!
//! - `readers`: files of measurements, muscles, effects, formulas, sweeps, protocols, joints, membrane cases, meshes, tables,
//! - `sessions`: requests to the workbench over HTTP,
//! - `equilibria`: random muscles against the invariants of [`bulge_validation::domain::equilibria`],
//! - `diagnoses`: random data sets against those of [`bulge_validation::decisions`].
//!
//! `fuzz/run` builds the fuzzer and runs it; `cargo test` replays the corpora and every failure of the past.

mod readers;
#[cfg(feature = "sessions")]
mod sessions;

/// A target: its name, which is also that of its corpus, and what it does with any bytes.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// The name.
    pub name: &'static str,
    /// Panics if what comes of the bytes is wrong.
    pub run: fn(&[u8]),
}

/// All targets.
pub const TARGETS: &[Target] = &[
    Target { name: "measurements", run: readers::measurements },
    Target { name: "sheets", run: readers::sheets },
    Target { name: "parquet", run: readers::parquet },
    Target { name: "muscles", run: readers::muscles },
    Target { name: "effects", run: readers::effects },
    Target { name: "formulas", run: readers::formulas },
    #[cfg(feature = "sweeps")]
    Target { name: "sweeps", run: readers::sweeps },
    #[cfg(feature = "decisions")]
    Target { name: "protocols", run: readers::protocols },
    #[cfg(feature = "sweeps")]
    Target { name: "joints", run: readers::joints },
    #[cfg(feature = "meshes")]
    Target { name: "cases", run: readers::cases },
    #[cfg(feature = "meshes")]
    Target { name: "meshes", run: readers::meshes },
    Target { name: "tables", run: readers::tables },
    Target { name: "units", run: readers::units },
    #[cfg(feature = "sessions")]
    Target { name: "sessions", run: sessions::requests },
    #[cfg(feature = "decisions")]
    Target { name: "equilibria", run: equilibria },
    #[cfg(feature = "decisions")]
    Target { name: "diagnoses", run: diagnoses },
];

/// The target of that name.
#[must_use]
pub fn target(name: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|target| target.name == name)
}

#[cfg(feature = "decisions")]
fn equilibria(bytes: &[u8]) {
    if let Err(broken) = bulge_validation::domain::equilibria(bytes) {
        assert!(broken.0.is_empty(), "{}", broken.0);
    }
}

#[cfg(feature = "decisions")]
fn diagnoses(bytes: &[u8]) {
    if let Err(broken) = bulge_validation::decisions::decision(bytes) {
        assert!(broken.0.is_empty(), "{}", broken.0);
    }
}
