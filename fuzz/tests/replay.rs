//! The corpora and every failure of the past, through their targets, without a fuzzer.

use bulge_fuzz::TARGETS;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

#[test]
fn corpora_and_past_failures() {
    let mut count = 0;
    for target in TARGETS {
        for kind in ["corpus", "failures"] {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(kind).join(target.name);
            let Ok(files) = std::fs::read_dir(&folder) else { continue };
            for file in files.flatten() {
                let path = file.path();
                let bytes = std::fs::read(&path);
                let done = catch_unwind(AssertUnwindSafe(|| bytes.as_deref().map(target.run).is_ok()));
                assert!(matches!(done, Ok(true)), "{}", path.display());
                count += 1;
            }
        }
    }
    assert!(count >= TARGETS.len(), "only {count} inputs were found");
}
