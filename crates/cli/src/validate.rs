//! `bulge validate`: the verification tables.

use bulge_validation::{CHECKS, Check};
use clap::Args;
use serde_json::json;
use std::fmt::Write;

use crate::arguments::{Json, pretty};
use crate::failure::Failure;

/// The verification tables: every check, its error, its tolerance.
#[derive(Debug, Args)]
pub(crate) struct Validate {
    #[command(flatten)]
    json: Json,
}

impl Validate {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let checks: Vec<Check> = CHECKS.iter().map(|check| check()).collect();
        let failed = checks.iter().filter(|check| !check.passed()).count();
        let text = if self.json.wanted { document(&checks)? } else { table(&checks) };
        if failed > 0 {
            return Err(Failure::Checks { failed, all: checks.len(), table: text });
        }
        Ok(text)
    }
}

fn document(checks: &[Check]) -> Result<String, Failure> {
    let rows: Vec<_> = checks
        .iter()
        .map(|c| {
            json!({
                "group": c.group, "name": c.name, "source": c.source, "cases": c.cases,
                "error": c.error, "tolerance": c.tolerance, "why": c.why, "passed": c.passed(),
            })
        })
        .collect();
    pretty(&json!({"schema": "bulge.validation/1", "checks": rows}))
}

fn table(checks: &[Check]) -> String {
    let mut text = String::new();
    let mut group = "";
    let width = checks.iter().map(|c| c.name.chars().count()).max().unwrap_or(0);
    for check in checks {
        if check.group != group {
            group = check.group;
            let _ = writeln!(
                text,
                "\n{group}\n  {:<width$}  {:>6}  {:>8}  {:>9}",
                "check", "cases", "error", "tolerance"
            );
        }
        let verdict = if check.passed() { "" } else { "  FAILED" };
        let _ = writeln!(
            text,
            "  {:<width$}  {:>6}  {:>8.1e}  {:>9.0e}{verdict}",
            check.name, check.cases, check.error, check.tolerance
        );
    }
    let passed = checks.iter().filter(|check| check.passed()).count();
    let _ = writeln!(text, "\n{passed} passed, {} failed", checks.len() - passed);
    text.trim_start().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::holds;

    #[test]
    fn the_document_holds_what_its_schema_names() {
        let check = |error| Check {
            group: "group",
            name: "name",
            source: "source",
            error,
            tolerance: 1e-9,
            cases: 3,
            why: "why",
            worst: String::new(),
        };
        let document = document(&[check(1e-12), check(1.0)]).unwrap();
        let document: serde_json::Value = serde_json::from_str(&document).unwrap();
        assert_eq!([0, 1].map(|i| document["checks"][i]["passed"].as_bool().unwrap()), [true, false]);
        assert_eq!(holds(&document), ("validation".to_owned(), 10));
    }
}
