//! Every check of the list as one test: the whole table is printed, and one failed row fails it.

use std::time::Instant;

#[test]
fn every_check_passes() {
    let mut failed = Vec::new();
    let begin = Instant::now();
    for check in bulge_validation::CHECKS {
        let start = Instant::now();
        let check = check();
        println!("{:5.0} ms {check}", start.elapsed().as_secs_f64() * 1e3);
        if !check.passed() {
            failed.push(check.to_string());
        }
    }
    let elapsed = begin.elapsed();
    println!("{} checks in {:.2} s", bulge_validation::CHECKS.len(), elapsed.as_secs_f64());
    assert!(
        failed.is_empty(),
        "{} of {} failed:\n{}",
        failed.len(),
        bulge_validation::CHECKS.len(),
        failed.join("\n")
    );
}
