//! Tables against the closed form that they approximate, and against their own derivatives.

use bulge_fibre::closed_form::{self, ClosedForm};
use bulge_sweep::{Plan, tabulate};
use bulge_table::{Sample, Table};

use crate::check::{Check, Claim, Trouble};

/// The two-parameter table of pleated muscles, from stocky to slender.
const FAMILY: &str = "muscle = \"ppam-2-r16\"
[axes.contraction]
range = \"0 %..limit\"
[axes.slenderness]
range = \"2..100\"
[table]
";
/// Points along each axis: fractions of the limit, and values between the ends.
const POINTS: u32 = 40;
/// Number of points that certify the table. The checks below use further points.
const CERTIFIED: u64 = 4096;

fn table() -> Result<Vec<u8>, Trouble> {
    let plan = Plan::from_toml(FAMILY, "family.toml", None)?;
    let mut wish = plan.table.clone().ok_or("no table is wished")?;
    wish.checks = CERTIFIED;
    Ok(tabulate(&plan, &wish, &|_| ())?.bytes)
}

/// Points of the domain: from a thousandth to nine tenths of the limit, at slendernesses that are not nodes.
fn points(table: &Table<'_>) -> Result<Vec<[f64; 2]>, Trouble> {
    let lookup = table.lookup::<2, 2>()?;
    let mut points = Vec::new();
    for i in 0..POINTS {
        for j in 0..POINTS {
            let [a, b] = [i, j].map(|k| (f64::from(k) + 0.37) / f64::from(POINTS));
            let slenderness = 2.0 * 50.0_f64.powf(b);
            let end = lookup.upper_end([0.0, slenderness]).ok_or("outside")?;
            points.push([(1e-3 + 0.899 * a * a) * end, slenderness]);
        }
    }
    Ok(points)
}

/// A point, its force and volume from the table, and the closed form.
type Compared = ([f64; 2], [Sample<2>; 2], ClosedForm);

/// All points with the compared values.
fn compared() -> Result<Vec<Compared>, Trouble> {
    let bytes = table()?;
    let table = Table::from_bytes(&bytes)?;
    let lookup = table.lookup::<2, 2>()?;
    let one = |point: [f64; 2]| {
        let exact = closed_form::solve(point[0], point[1], 0.0)?;
        Ok((point, lookup.at(point).ok_or("outside")?, exact))
    };
    points(&table)?.into_iter().map(one).collect()
}

/// Looked-up values against the closed form.
pub(crate) fn lookups() -> Check {
    Claim {
        group: "tables",
        name: "force f and volume v of a two-parameter table of 64 KiB against the closed form",
        source: "closed form",
        tolerance: 1e-6,
        why: "what the table is asked to meet",
    }
    .run(|tally| {
        for (point, [force, volume], exact) in compared()? {
            tally.relative(force.value, exact.force.value, || format!("f at {point:?}"));
            tally.relative(volume.value, exact.volume.value, || format!("v at {point:?}"));
        }
        Ok(())
    })
}

/// Gradients against the closed form, and F = -p dV/dl within the table: f = dv/d(eps).
pub(crate) fn gradients() -> Check {
    Claim {
        group: "tables",
        name: "gradients of the same, and f = dv/d(eps) between its two outputs",
        source: "closed form; F = -p dV/dl",
        tolerance: 1e-4,
        why: "what the gradients of the table are asked to meet",
    }
    .run(|tally| {
        for (point, [force, volume], exact) in compared()? {
            for (name, found, exact) in [("f", force, exact.force), ("v", volume, exact.volume)] {
                let width = [point[0].max(0.1), 98.0];
                for (i, by) in [exact.by_contraction, exact.by_slenderness].into_iter().enumerate() {
                    let floor = exact.value.abs() / width[i];
                    tally
                        .scaled(found.gradient[i], by, floor, || format!("d{name} by axis {i} at {point:?}"));
                }
            }
            tally.scaled(volume.gradient[0], force.value, 0.1, || format!("dv/d(eps) at {point:?}"));
        }
        Ok(())
    })
}
